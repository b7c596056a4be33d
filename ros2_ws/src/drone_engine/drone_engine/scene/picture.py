"""Schema of the picture of a scene: lights, cameras, sky and water."""

from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, PositiveFloat, model_validator

from drone_engine.scene.fields import ORIGIN, Color, Extension, Name, Pose, Strict, Unit


class Light(Strict):
    """A point light that lights everything but its own parent: in all directions, or in a beam along its x axis."""

    parent: Name | None = None
    pose: Pose = ORIGIN
    colour: Color = (1.0, 1.0, 1.0)
    intensity: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0
    # m at which half of the intensity is left; None: distance does not weaken it
    reach: Annotated[float, Field(ge=1e-3, le=1e6)] | None = None
    beam: Annotated[float, Field(gt=0.0, le=1.5708)] | None = None  # rad, half the angle of the cone


class Orbit(Strict):
    """A circular path around the parent, or around the pose if there is none, looking at its center."""

    radius: PositiveFloat
    height: float
    period: PositiveFloat  # s


class Camera(Strict):
    """A pinhole camera. Its topics begin with its name; its optical frame is <name>_optical."""

    parent: Name | None = None
    pose: Pose = ORIGIN
    size: tuple[int, int] = (640, 480)  # pixels
    fov: Annotated[float, Field(gt=0.05, lt=3.0)] = 1.2  # rad, horizontal
    near: PositiveFloat = 0.05  # m
    far: PositiveFloat = 1000.0  # m
    level: bool = False  # follows the parent's position and heading, not its tilt
    look_at: Name | None = None  # an object that it keeps in view
    orbit: Orbit | None = None

    @model_validator(mode="after")
    def _drawable(self) -> Self:
        if not all(16 <= side <= 4096 for side in self.size):
            raise ValueError("'size': expected two numbers of pixels from 16 to 4096")
        if self.near >= self.far:
            raise ValueError("'near': expected less than 'far'")
        return self


class Sky(Strict):
    """Three domes behind everything: colors from the horizon up, stars, and drifting clouds.

    They are centered on an object, such as the drone that cameras follow, and stay level. Textures are names in the
    file, and paths of files once the scene is loaded.
    """

    parent: Name | None = None  # None: centered on each camera
    radius: PositiveFloat = 600.0  # m
    horizon: Color = (0.76, 0.86, 0.94)
    zenith: Color = (0.22, 0.45, 0.78)
    colours: Path | None = None  # a texture instead of both: night to day from left to right, zenith on top
    stars: Path | None = None  # a texture; stars appear as daylight fades
    clouds: Path | None = None  # a texture; its alpha is the cloud cover
    drift: tuple[float, float] = (0.004, 0.001)  # texture coordinates per s


class Water(Strict):
    """Appearance of objects with 'shading: water'."""

    deep: Color = (0.02, 0.16, 0.24)
    shallow: Color = (0.10, 0.45, 0.48)
    wave_height: Unit = 0.15  # of the wavelength
    wave_speed: float = 1.0


class Render(Strict):
    """Lighting and optional features; features that are not named are in no shader."""

    ambient: Color = (0.30, 0.34, 0.40)
    daylight: Unit = 1.0  # 1 is day, 0 night; dims the parallel light, the ambient light and the sky
    sky: Sky | None = None
    water: Water | None = None
    normal_mapping: dict[str, None] | None = None
    specular: dict[str, None] | None = None
    antialiasing: dict[str, None] | None = None  # smooths edges
    # Render passes of the user; the renderer imports them and validates their parameters.
    passes: dict[Extension, dict[str, Any]] = Field(default_factory=dict)

    def features(self) -> list[str]:
        """Names of the optional features that the scene uses."""
        names = ("sky", "water", "normal_mapping", "specular", "antialiasing")
        return [name for name in names if getattr(self, name) is not None]
