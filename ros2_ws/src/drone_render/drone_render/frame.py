"""What all that is drawn in one picture has in common."""

from dataclasses import dataclass

import numpy as np

from drone_render.view import Array


@dataclass(frozen=True)
class Sun:
    """The light whose rays are parallel: where it is, and its colour times its intensity."""

    position: Array
    colour: Array


@dataclass(frozen=True)
class Frame:
    """What all draws of a picture share."""

    time: float  # s
    camera: Array  # (4, 4), from the camera's frame to the world
    view_projection: Array  # (4, 4)
    half: tuple[float, float]  # tangents of half the angles of view, across and down
    pixel: float  # angle of a pixel, rad
    sun: Sun | None

    @property
    def eye(self) -> Array:
        """Position of the camera, (3,)."""
        return self.camera[:3, 3]

    def sun_uniforms(self) -> dict[str, Array]:
        """Direction and colour of the sun as this camera sees it."""
        if self.sun is None:
            return {}
        way = self.sun.position - self.eye
        return {"sun_direction": way / np.linalg.norm(way), "sun_colour": self.sun.colour}
