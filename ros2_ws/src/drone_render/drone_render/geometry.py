"""Parts of models as the graphics device wants them: tangents, bounding spheres, textures."""

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
