"""What a scene says about its picture: lights, cameras, sky and water."""

from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, PositiveFloat, model_validator

from drone_engine.scene.fields import ORIGIN, Colour, Name, Pose, Strict, Unit


class Light(Strict):
    """A point light. It shines on everything but its own parent: all around, or along its x axis as a beam."""

    parent: Name | None = None
    pose: Pose = ORIGIN
    colour: Colour = (1.0, 1.0, 1.0)
    intensity: Annotated[float, Field(gt=0.0, le=1e6)] = 1.0
    # m at which half of it is left; without it, distance does not weaken it
    reach: Annotated[float, Field(ge=1e-3, le=1e6)] | None = None
    beam: Annotated[float, Field(gt=0.0, le=1.5708)] | None = None  # rad from its x axis to where it ends


class Orbit(Strict):
    """A circle around the parent, or around the pose where there is none, looking at its centre."""

    radius: PositiveFloat
    height: float
    period: PositiveFloat  # s


class Camera(Strict):
    """A pinhole camera. Its picture is <name>'s; its optical frame is <name>_optical."""

    parent: Name | None = None
    pose: Pose = ORIGIN
    size: tuple[int, int] = (640, 480)  # pixels
    fov: Annotated[float, Field(gt=0.05, lt=3.0)] = 1.2  # rad, horizontal
    near: PositiveFloat = 0.05  # m
    far: PositiveFloat = 1000.0  # m
    level: bool = False  # takes the parent's position and heading only, not its tilt
    look_at: Name | None = None  # turns towards this object
    orbit: Orbit | None = None

    @model_validator(mode="after")
    def _drawable(self) -> Self:
        if not all(16 <= side <= 4096 for side in self.size):
            raise ValueError("'size' needs two numbers of pixels from 16 to 4096")
        if self.near >= self.far:
            raise ValueError("'near' must be less than 'far'")
        return self


class Sky(Strict):
    """Three domes, seen where nothing stands: colours from the horizon up, stars, and clouds that drift.

    They hang on an object, such as the drone that cameras follow, and go where it goes, but stay level.
    Textures are what the file calls them; once the scene is loaded they are their files.
    """

    parent: Name | None = None  # without it they hang on each camera
    radius: PositiveFloat = 600.0  # m
    horizon: Colour = (0.76, 0.86, 0.94)
    zenith: Colour = (0.22, 0.45, 0.78)
    colours: Path | None = None  # a texture instead of the two: night to day from left to right, the zenith on top
    stars: Path | None = None  # a texture; they come out as daylight goes
    clouds: Path | None = None  # a texture; its alpha is the cover
    drift: tuple[float, float] = (0.004, 0.001)  # of the clouds' texture per s


class Water(Strict):
    """How objects with 'shading: water' look."""

    deep: Colour = (0.02, 0.16, 0.24)
    shallow: Colour = (0.10, 0.45, 0.48)
    wave_height: Unit = 0.15  # of the wave's length
    wave_speed: float = 1.0


class Render(Strict):
    """What the picture is made of; what is not named is not in any shader."""

    ambient: Colour = (0.30, 0.34, 0.40)
    daylight: Unit = 1.0  # 1 is day, 0 night; dims the parallel light, the ambient one and the sky
    sky: Sky | None = None
    water: Water | None = None
    normal_mapping: dict[str, None] | None = None
    specular: dict[str, None] | None = None
    antialiasing: dict[str, None] | None = None  # smooths the steps where two surfaces meet

    def features(self) -> list[str]:
        """Names of what the scene calls for."""
        names = ("sky", "water", "normal_mapping", "specular", "antialiasing")
        return [name for name in names if getattr(self, name) is not None]
