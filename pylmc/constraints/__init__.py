"""Which constraints a scene has, and how they combine into the preconditioner."""
