"""Parts of models as the graphics device wants them: tangents, bounding spheres, textures."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from drone_render.view import Array
from drone_sim.mesh import MeshError, Model, Part


def tangents(part: Part) -> npt.NDArray[np.float32]:
    """Unit tangents (n, 4): where u grows along the surface; the last number is the side of the bitangent.

    After Lengyel, Computing Tangent Space Basis Vectors for an Arbitrary Mesh.
    """
    corners, uv = part.vertices[part.faces].astype(np.float64), part.uv[part.faces].astype(np.float64)
    edges, spans = corners[:, 1:] - corners[:, :1], uv[:, 1:] - uv[:, :1]
    area = spans[:, 0, 0] * spans[:, 1, 1] - spans[:, 1, 0] * spans[:, 0, 1]
    share = np.where(np.abs(area) > 1e-12, 1 / np.where(area == 0, 1, area), 0.0)[:, None]
    along_u = (edges[:, 0] * spans[:, 1, 1, None] - edges[:, 1] * spans[:, 0, 1, None]) * share
    along_v = (edges[:, 1] * spans[:, 0, 0, None] - edges[:, 0] * spans[:, 1, 0, None]) * share
    u, v = np.zeros((2, len(part.vertices), 3))
    for corner in range(3):
        np.add.at(u, part.faces[:, corner], along_u)
        np.add.at(v, part.faces[:, corner], along_v)
    normals = part.normals.astype(np.float64)
    u -= normals * np.einsum("ni,ni->n", normals, u)[:, None]
    length = np.linalg.norm(u, axis=1, keepdims=True)
    any_other = np.cross(normals, np.where(np.abs(normals[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    u = np.where(length > 1e-9, u / np.maximum(length, 1e-9), any_other)
    side = np.where(np.einsum("ni,ni->n", np.cross(normals, u), v) < 0, -1.0, 1.0)
    return np.hstack([u, side[:, None]]).astype(np.float32)


def coarse(part: Part, cell: float) -> Part:
    """The part with all vertices of a cube of `cell` m made one; faces that vanish are left out.

    After Rossignac and Borrel, Multi-resolution 3D approximations. Faces that look different ways stay apart.
    """
    cells = np.floor(part.vertices / cell).astype(np.int64)
    facing = np.argmax(np.abs(part.normals), axis=1)
    side = 2 * facing + (part.normals[np.arange(len(facing)), facing] < 0)
    places, at = _merged(cells, part.vertices)
    _, corner = np.unique(np.column_stack([at, side]), axis=0, return_inverse=True)
    corner = corner.reshape(-1)
    first = np.zeros(corner.max(initial=-1) + 1, np.int64)
    first[corner] = np.arange(len(corner))
    faces = corner[part.faces]
    spots = at[part.faces]
    kept = (spots[:, 0] != spots[:, 1]) & (spots[:, 1] != spots[:, 2]) & (spots[:, 2] != spots[:, 0])
    return replace(
        part, vertices=places[at[first]].astype(np.float32), normals=part.normals[first], uv=part.uv[first],
        faces=np.unique(faces[kept], axis=0).astype(np.int32).reshape(-1, 3),
    )  # fmt: skip


def _merged(keys: npt.NDArray[np.int64], values: npt.NDArray[np.float32]) -> tuple[Array, npt.NDArray[np.intp]]:
    """The means of the rows that have equal keys, and which mean each row belongs to."""
    _, group, counts = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    group = group.reshape(-1)
    sums = np.zeros((len(counts), values.shape[1]))
    np.add.at(sums, group, values)
    return sums / counts[:, None], group


def sphere(model: Model) -> tuple[Array, float]:
    """Centre (3,) and radius of a sphere around a model: about the middle of its box, as tight as that allows."""
    centre = (model.low + model.high) / 2
    radius = max(float(np.linalg.norm(part.vertices - centre, axis=1).max()) for part in model.parts)
    return centre, radius


def pixels(path: Path) -> tuple[tuple[int, int], bytes]:
    """Size and RGBA bytes of an image file, the bottom row first, as OpenGL counts. Raises MeshError."""
    try:
        with Image.open(path) as image:
            upright = image.convert("RGBA").transpose(Image.Transpose.FLIP_TOP_BOTTOM)
            return upright.size, upright.tobytes()
    except OSError as error:
        raise MeshError(f"{path}: not readable as an image: {error}") from None
