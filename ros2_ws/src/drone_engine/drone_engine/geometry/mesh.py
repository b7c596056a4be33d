"""Models as plain arrays, for physics and rendering: OBJ + MTL files, read by trimesh."""

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from drone_engine.arrays import Float32s, Floats, Int32s, Integers
from drone_engine.file_cache import read_once
from drone_engine.geometry.materials import Material, read_materials
from drone_engine.geometry.normals import vertex_normals
from drone_engine.geometry.obj import MeshError, Obj, check_vertices

if TYPE_CHECKING:
    import trimesh

__all__ = ["Material", "MeshError", "Model", "Part", "bounds", "load", "prepare", "surface"]


@dataclass(frozen=True)
class Part:
    """The triangles of a model that share a material."""

    vertices: Float32s  # (n, 3) m
    normals: Float32s  # (n, 3) unit
    uv: Float32s  # (n, 2) texture coordinates, v up
    faces: Int32s  # (m, 3) indices into vertices, counter-clockwise seen from outside
    material: Material


@dataclass(frozen=True)
class Model:
    """A whole model, and the lowest and highest corner of the box around its vertices, (3,) each, in m."""

    path: Path
    parts: tuple[Part, ...]
    low: Floats
    high: Floats


@read_once
def bounds(path: Path) -> tuple[Floats, Floats]:
    """Lowest and highest corner of the axis-aligned box around a model's vertices, (3,) each, in m.

    Parses only the vertices. Raises MeshError.
    """
    low, high = Obj.read(path).bounds
    low.flags.writeable = high.flags.writeable = False
    return low, high


def load(path: Path) -> Model:
    """Reads a model with its materials.

    Raises MeshError for a model without faces or with infinite vertices. An MTL or a texture that is missing or
    unreadable is a warning, and the model comes without it: its shape is still good for physics.
    """
    obj = Obj.read(path)
    materials = read_materials(obj)
    parts = [_part(obj, mesh, materials) for mesh in _meshes(obj)]
    low, high = obj.bounds
    return Model(path, tuple(parts), low, high)


@read_once
def surface(path: Path) -> tuple[Floats, Integers]:
    """The shape of a model: distinct vertices (v, 3) in m, and triangles (f, 3), counter-clockwise seen from outside.

    Raises MeshError.
    """
    meshes = _meshes(Obj.read(path))
    corners = np.concatenate([np.asarray(mesh.vertices, np.float64)[mesh.faces].reshape(-1, 3) for mesh in meshes])
    check_vertices(path, corners)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    faces = index.reshape(-1, 3).astype(np.int64)
    vertices.flags.writeable = faces.flags.writeable = False
    return vertices, faces


def prepare() -> None:
    """Imports trimesh ahead of the first model, which takes half a second."""
    import trimesh  # noqa: F401


def _meshes(obj: Obj) -> "list[trimesh.Trimesh]":
    """The triangles of each material, as trimesh reads them."""
    import trimesh  # slower to import than all the rest, and physics often needs `bounds` alone

    try:
        loaded = trimesh.load_scene(io.StringIO(obj.text), "obj", resolver=_MaterialStub(obj), process=False)
    except Exception as error:  # the loader has no exception of its own
        raise MeshError(f"{obj.path}: not readable as OBJ: {str(error).splitlines()[0]}") from None
    meshes = [mesh for mesh in loaded.geometry.values() if isinstance(mesh, trimesh.Trimesh) and len(mesh.faces)]
    if not meshes:
        raise MeshError(f"{obj.path}: has no faces")
    return meshes


def _part(obj: Obj, mesh: "trimesh.Trimesh", materials: dict[str, Material]) -> Part:
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    check_vertices(obj.path, vertices)
    uv = getattr(mesh.visual, "uv", None)
    if uv is None or len(uv) != len(vertices):
        uv = np.zeros((len(vertices), 2))
    name = getattr(getattr(mesh.visual, "material", None), "name", None) or ""
    normals = mesh.vertex_normals if obj.has_normals else vertex_normals(vertices, np.asarray(mesh.faces))
    return Part(
        np.ascontiguousarray(vertices, dtype=np.float32),
        np.ascontiguousarray(normals, dtype=np.float32),
        np.ascontiguousarray(uv, dtype=np.float32),
        np.ascontiguousarray(mesh.faces, dtype=np.int32),
        materials.get(name, Material(name)),
    )


class _MaterialStub(dict[str, str]):
    """Gives trimesh, for each MTL, one with nothing but names: trimesh groups faces by them. It ignores normal maps,
    would open all textures, and refuses files behind links, as installed assets are; materials.py reads the rest."""

    def __init__(self, obj: Obj) -> None:
        stub = "\n".join(f"newmtl {name}" for name in sorted(obj.materials))
        super().__init__(dict.fromkeys(obj.libraries, stub))
