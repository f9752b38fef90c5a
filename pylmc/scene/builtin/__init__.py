"""The built-in scenes: each module's ``build(...)`` returns a Scene, its docstring says what the scene stresses."""
