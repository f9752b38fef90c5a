"""The scene as a person describes it: camera, shapes with materials, lights, holes.

Every material and light that its folder names is offered here, and by ``pylmc`` itself.
"""

from .camera import Camera
from .lights import *  # noqa: F403
from .lights import Light
from .materials import *  # noqa: F403
from .materials import Material
from .portal import Portal
from .scene import Scene
from .shape import Shape
from .texture import Texture

OFFERED = (Camera, Portal, Scene, Shape, Texture, Light, *Light.kinds, Material, *Material.kinds)
NAMES = sorted(kind.__name__ for kind in OFFERED)  # what pylmc offers of the scene
__all__ = [*NAMES]
