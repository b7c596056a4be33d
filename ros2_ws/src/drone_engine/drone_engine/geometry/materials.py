"""Materials from MTL files. Bad lines, missing libraries and unreadable textures are warnings in the log."""

import logging
from dataclasses import dataclass, replace
from pathlib import Path

from drone_engine.geometry.obj import Obj
from drone_engine.images import image_flaw

log = logging.getLogger(__name__)

Color = tuple[float, float, float]  # red, green, blue from 0 to 1
COLORS = {"Kd": "color", "Ks": "specular", "Ke": "emission"}  # fields of Material by keys of MTL
MAPS = {"map_Kd": "color_map", "norm": "normal_map", "map_Bump": "normal_map", "map_bump": "normal_map"}


@dataclass(frozen=True)
class Material:
    """Appearance of a surface: Kd, Ks, Ns, Ke, map_Kd and norm (or map_Bump) of the MTL."""

    name: str = ""
    color: Color = (0.8, 0.8, 0.8)
    specular: Color = (0.0, 0.0, 0.0)
    shininess: float = 32.0  # exponent of the Blinn-Phong highlight
    emission: Color = (0.0, 0.0, 0.0)
    color_map: Path | None = None
    normal_map: Path | None = None  # tangent space, OpenGL convention: green points up


class _TextureError(Exception):
    """A texture that cannot be used, in one line."""


def read_materials(obj: Obj) -> dict[str, Material]:
    """All materials of the libraries that an OBJ names, by name. A library that cannot be read is left out."""
    found: dict[str, Material] = {}
    for name in obj.libraries:
        try:
            found |= _read_library(obj.path.parent / name)
        except OSError as error:
            log.warning("%s: %s: %s; drawn without its materials", obj.path, name, error.strerror)
    return found


def _read_library(path: Path) -> dict[str, Material]:
    """The materials of an MTL file, by name. Raises OSError."""
    found: dict[str, Material] = {}
    name = ""
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
        key, *values = line.split("#")[0].split() or [""]
        try:
            if key == "newmtl":
                name = " ".join(values)
                found[name] = Material(name)
            elif key and name:
                found[name] = _with(found[name], key, values, path.parent)
        except (ValueError, IndexError):
            log.warning("%s: line %d: expected '%s' as MTL defines it, got '%s'; left out", path, number, key,
                        line.strip())
        except _TextureError as error:
            log.warning("%s: line %d: %s; drawn without", path, number, error)
    return found


def _with(material: Material, key: str, values: list[str], folder: Path) -> Material:
    """The material with one more line of its MTL; unknown keys change nothing."""
    if key in COLORS:
        red, green, blue = (float(value) for value in values)
        return replace(material, **{COLORS[key]: (red, green, blue)})  # type: ignore[arg-type]
    if key == "Ns":
        return replace(material, shininess=float(values[0]))
    if key in MAPS:
        texture = (folder / values[-1]).resolve()
        if not texture.is_file():
            raise _TextureError(f"no texture '{values[-1]}'")
        if flaw := image_flaw(texture):
            raise _TextureError(f"texture '{values[-1]}' is not readable: {flaw}")
        return replace(material, **{MAPS[key]: texture})  # type: ignore[arg-type]
    return material
