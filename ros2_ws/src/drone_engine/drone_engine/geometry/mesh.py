"""Models: OBJ + MTL files as plain arrays, for the physics and for the picture alike."""

import io
import logging
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from drone_engine.assets import image_flaw, read_once

if TYPE_CHECKING:
    import trimesh

log = logging.getLogger(__name__)

Floats = npt.NDArray[np.float32]
Colour = tuple[float, float, float]


class MeshError(ValueError):
    """What is wrong with a model, in one line: the file and what was expected."""


@dataclass(frozen=True)
class Material:
    """How a surface looks: the MTL's Kd, Ks, Ns, Ke, map_Kd and norm (or map_Bump). Colours from 0 to 1."""

    name: str = ""
    colour: Colour = (0.8, 0.8, 0.8)
    specular: Colour = (0.0, 0.0, 0.0)
    shininess: float = 32.0  # exponent of Blinn's highlight
    emission: Colour = (0.0, 0.0, 0.0)
    colour_map: Path | None = None
    normal_map: Path | None = None  # tangent space, OpenGL's way: green points up


@dataclass(frozen=True)
class Part:
    """The triangles of a model that share a material: vertices (n, 3) in m, unit normals (n, 3), uv (n, 2)
    with v up, faces (m, 3) int32, counter-clockwise seen from outside."""

    vertices: Floats
    normals: Floats
    uv: Floats
    faces: npt.NDArray[np.int32]
    material: Material


@dataclass(frozen=True)
class Model:
    """A whole model: its parts, and the corners of the box around them, each (3,) float64."""

    path: Path
    parts: tuple[Part, ...]
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]


@read_once
def bounds(path: Path) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Corners (low, high) of the axis-aligned box around a model's vertices, each (3,) float64, in m.

    Reads nothing but the vertices. Raises MeshError.
    """
    vertices = read_vertices(path)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    low.flags.writeable = high.flags.writeable = False
    return low, high


def read_vertices(path: Path) -> npt.NDArray[np.float64]:
    """The vertices (v, 3) as they stand in the file, m. Raises MeshError."""
    rows = [line.split()[1:4] for line in _text(path).splitlines() if line.startswith("v ")]
    try:
        vertices = np.array(rows, dtype=np.float64)
    except ValueError:
        raise MeshError(f"{path}: a vertex is not three numbers") from None
    _check_vertices(path, vertices)
    return vertices


def read_faces(path: Path) -> npt.NDArray[np.int64]:
    """Triangles (f, 3) of the vertices as they stand in the file; polygons are fans. What is no number is left out."""
    faces, known = [], 0
    for line in _text(path).splitlines():
        if line.startswith("f "):
            corners = [word.split("/")[0] for word in line.split()[1:]]
            if all(corner.removeprefix("-").isdigit() for corner in corners):
                # Numbers from 1, or backwards from the last vertex so far.
                first, *rest = (int(corner) + (known if corner[0] == "-" else -1) for corner in corners)
                faces += [(first, *pair) for pair in pairwise(rest)]
        known += line.startswith("v ")
    return np.array(faces, np.int64).reshape(-1, 3)


def load(path: Path) -> Model:
    """Reads a model with its materials.

    Raises MeshError for what has no faces or no finite shape. An MTL or a texture that is missing or not readable is
    a warning, and the model comes without it: it is worth seeing, and its shape is what counts for the physics.
    """
    text = _text(path)
    materials = _materials(path, text)
    has_normals = "\nvn " in text
    parts = [_part(path, mesh, has_normals, materials) for mesh in _meshes(path, text)]
    low, high = bounds(path)
    return Model(path, tuple(parts), low, high)


@read_once
def surface(path: Path) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """A model's shape alone: vertices (v, 3) float64 in m, each place once, and triangles (f, 3), counter-clockwise
    seen from outside. Raises MeshError."""
    meshes = _meshes(path, _text(path))
    corners = np.concatenate([np.asarray(mesh.vertices, np.float64)[mesh.faces].reshape(-1, 3) for mesh in meshes])
    _check_vertices(path, corners)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.int64)
    vertices.flags.writeable = faces.flags.writeable = False
    return vertices, faces


def prepare() -> None:
    """Imports what reading models takes: half a second that one may have to spare before the first."""
    import trimesh  # noqa: F401


def _meshes(path: Path, text: str) -> "list[trimesh.Trimesh]":
    """The triangles of each material, as trimesh reads them."""
    import trimesh  # takes longer to import than all the rest, and the physics often needs `bounds` alone

    try:
        loaded = trimesh.load_scene(io.StringIO(text), "obj", resolver=_Names(text), process=False)
    except Exception as error:  # the loader has no exception of its own
        raise MeshError(f"{path}: not readable as OBJ: {str(error).splitlines()[0]}") from None
    meshes = [mesh for mesh in loaded.geometry.values() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    if not meshes:
        raise MeshError(f"{path}: has no faces")
    return meshes


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise MeshError(f"{path}: {error.strerror}") from None


def _check_vertices(path: Path, vertices: npt.NDArray[np.float64]) -> None:
    if vertices.ndim != 2 or vertices.shape[1:] != (3,):
        raise MeshError(f"{path}: has no vertices of three numbers")
    if not np.isfinite(vertices).all():
        raise MeshError(f"{path}: vertex {int(np.argmin(np.isfinite(vertices).all(axis=1))) + 1} is not finite")


def _part(path: Path, mesh: "trimesh.Trimesh", has_normals: bool, materials: dict[str, Material]) -> Part:
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    _check_vertices(path, vertices)
    uv = getattr(mesh.visual, "uv", None)
    if uv is None or len(uv) != len(vertices):
        uv = np.zeros((len(vertices), 2))
    name = getattr(getattr(mesh.visual, "material", None), "name", None) or ""
    normals = mesh.vertex_normals if has_normals else _smooth_normals(vertices, np.asarray(mesh.faces))
    return Part(
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(normals, dtype=np.float32),
        np.ascontiguousarray(uv, dtype=np.float32),
        np.ascontiguousarray(mesh.faces, dtype=np.int32),
        materials.get(name, Material(name)),
    )


class _Names(dict[str, str]):
    """Gives trimesh an MTL with the names of the materials and nothing else: it knows no normal maps, would open
    all pictures, and refuses what lies behind a link, as installed assets do."""

    def __init__(self, text: str) -> None:
        lines = text.splitlines()
        names = {line[7:].strip() for line in lines if line.startswith("usemtl ")}
        stub = "\n".join(f"newmtl {name}" for name in sorted(names))
        super().__init__({line[7:].strip(): stub for line in lines if line.startswith("mtllib ")})


def _smooth_normals(vertices: npt.NDArray[np.float64], faces: npt.NDArray[np.integer]) -> npt.NDArray[np.float64]:
    """Unit normals of the vertices, each the mean of its faces' by their areas. trimesh would ask for SciPy here."""
    first, second, third = (vertices[faces[:, corner]] for corner in range(3))
    sums = np.zeros_like(vertices)
    for corner in range(3):
        np.add.at(sums, faces[:, corner], np.cross(second - first, third - first))
    length = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(length > 0, sums / np.where(length > 0, length, 1.0), [0.0, 0.0, 1.0])


def _materials(path: Path, text: str) -> dict[str, Material]:
    """All materials that an OBJ names. trimesh knows neither normal maps nor missing files, so they are read here."""
    found: dict[str, Material] = {}
    for line in text.splitlines():
        if line.startswith("mtllib "):
            library = path.parent / line.split(maxsplit=1)[1].strip()
            try:
                found |= _library(library)
            except OSError as error:
                log.warning("%s: %s: %s; drawn without its materials", path, library.name, error.strerror)
    return found


class _TextureError(Exception):
    """What is wrong with a texture that an MTL names."""


def _library(path: Path) -> dict[str, Material]:
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
            log.warning("%s: line %d: '%s' is not as MTL has it; left out", path, number, line.strip())
        except _TextureError as error:
            log.warning("%s: line %d: %s; drawn without", path, number, error)
    return found


def _with(material: Material, key: str, values: list[str], folder: Path) -> Material:
    """The material with one more line of its MTL."""
    colours = {"Kd": "colour", "Ks": "specular", "Ke": "emission"}
    maps = {"map_Kd": "colour_map", "norm": "normal_map", "map_Bump": "normal_map", "map_bump": "normal_map"}
    if key in colours:
        red, green, blue = (float(value) for value in values)
        return replace(material, **{colours[key]: (red, green, blue)})  # type: ignore[arg-type]
    if key == "Ns":
        return replace(material, shininess=float(values[0]))
    if key in maps:
        texture = (folder / values[-1]).resolve()
        if not texture.is_file():
            raise _TextureError(f"no texture '{values[-1]}'")
        if flaw := image_flaw(texture):
            raise _TextureError(f"texture '{values[-1]}' is not readable: {flaw}")
        return replace(material, **{maps[key]: texture})  # type: ignore[arg-type]
    return material
