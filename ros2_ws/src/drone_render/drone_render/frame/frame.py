"""The constants of one picture that all of its passes share."""

from dataclasses import dataclass

import numpy as np

from drone_engine.arrays import Floats


@dataclass(frozen=True)
class Sun:
    """The light with parallel rays."""

    position: Floats  # (3,) m; rays are parallel to the line from here to the camera
    color: Floats  # (3,) color times intensity


@dataclass(frozen=True)
class Frame:
    """One picture: the camera at one instant, and where the objects are. World frame, SI units."""

    camera_name: str
    size: tuple[int, int]  # width, height in pixels
    near: float  # m, distance of the near plane
    time: float  # s of simulated time
    world: Floats  # (n, 4, 4) matrices of all objects in the world, in the scene's order
    camera: Floats  # (4, 4) from the camera's frame (x ahead, z up) to the world
    view: Floats  # (4, 4) from the world to the eye frame of OpenGL
    projection: Floats  # (4, 4) from the eye frame to clip space
    view_projection: Floats  # (4, 4) projection @ view
    half_tangents: tuple[float, float]  # tangents of half the angles of view, horizontal and vertical
    pixel_angle: float  # rad, angle of view of a pixel
    sun: Sun | None

    @property
    def eye(self) -> Floats:
        """Position (3,) of the camera."""
        return self.camera[:3, 3]

    def sun_uniforms(self) -> dict[str, Floats]:
        """Uniforms of the sun for this camera: its direction and color; empty without a sun."""
        if self.sun is None:
            return {}
        to_sun = self.sun.position - self.eye
        return {"sun_direction": to_sun / np.linalg.norm(to_sun), "sun_color": self.sun.color}
