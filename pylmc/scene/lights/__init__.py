"""Lights that are no surfaces: a file each, and a line here."""

from .directional import DirectionalLight as DirectionalLight
from .light import Light as Light
from .point import PointLight as PointLight
from .spot import SpotLight as SpotLight
