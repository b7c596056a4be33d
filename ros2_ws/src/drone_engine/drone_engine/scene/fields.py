"""Types of the values in a scene file: numbers with their ranges, names and poses."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Vector = tuple[float, float, float]
Unit = Annotated[float, Field(ge=0.0, le=1.0)]
Color = tuple[Unit, Unit, Unit]  # red, green, blue
Rate = Annotated[float, Field(ge=0.01, le=10_000.0)]  # Hz
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=100)]
Extension = Annotated[  # built-in name, entry point, or dotted path of a user's module
    str, Field(pattern=r"^[a-z][a-z0-9_]*(\.[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Topic = Annotated[str, Field(pattern=r"^/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*$", max_length=200)]
Mass = Annotated[float, Field(ge=1e-6, le=1e9)]  # kg
Place = Annotated[float, Field(ge=-1e7, le=1e7)]  # m; float64 resolves 1e-8 m or better in this range
Pose = tuple[Place, Place, Place, float, float, float]  # x, y, z in m; roll, pitch, yaw in rad
ORIGIN: Pose = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
FOUND = "found"  # marks fields that loading fills in; a scene must not set them


class Strict(BaseModel):
    """Base of all parts of a scene: refuses unknown keys, strings for numbers and non-finite numbers; immutable."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
