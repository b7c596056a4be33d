"""Parts of models as the graphics device wants them: tangents, bounding spheres, textures."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

from drone_engine.geometry.mesh import MeshError, Part
from drone_render.view import Array

STEEPEST = 4.0  # slope that a normal may have where two maps are packed into one
LOSS = 1.5  # of 255; how far colours may be off, in the mean, where two maps are packed into one


@dataclass(frozen=True)
class PackedMap:
    """A colour map and a normal map in one: RGBA bytes of the pixels, and what brings colours and normals back.

    colour = ramp[0] + ramp[1] * r + ramp[2] * g; the normal's x / z and y / z are steepness * (2 * (b, a) - 1), as
    slopes mix rightly in mip maps, and need no root.
    """

    size: tuple[int, int]
    data: bytes
    ramp: npt.NDArray[np.float32]
    steepness: float


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


def bounds(vertices: npt.NDArray[np.float32]) -> tuple[Array, Array, float]:
    """The box around vertices (n, 3), its middle (3,) and half its edges (3,), and the radius of a sphere about it."""
    points = vertices.astype(np.float64)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    return middle, (high - low) / 2, float(np.linalg.norm(points - middle, axis=1).max())


def pixels(path: Path) -> tuple[tuple[int, int], bytes]:
    """Size and RGBA bytes of an image file, the bottom row first, as OpenGL counts. Raises MeshError."""
    try:
        with Image.open(path) as image:
            upright = image.convert("RGBA").transpose(Image.Transpose.FLIP_TOP_BOTTOM)
            return upright.size, upright.tobytes()
    except OSError as error:
        raise MeshError(f"{path}: not readable as an image: {error}") from None


def pack(colour_map: Path, normal_map: Path) -> PackedMap | None:
    """Both maps in one, or None where the sizes differ or the colours need more than two numbers. Raises MeshError.

    Most materials vary little in hue, so that the two main axes of their colours hold all that is seen.
    """
    (size, colours), (other, normals) = (_bytes(path) for path in (colour_map, normal_map))
    if size != other:
        return None
    some = colours[::17, :3].astype(np.float32)
    middle = some.mean(axis=0)
    some -= middle
    axes = np.linalg.eigh(some.T @ some)[1][:, 1:].astype(np.float32)
    axes *= np.where(axes.sum(axis=0) < 0, -1, 1)  # or rounding down would brighten some, darken others
    if float(np.abs(some - some @ axes @ axes.T).mean()) > LOSS:
        return None
    # Rows of all pixels from here on, which are much faster to reduce than columns.
    data = np.empty((4, len(colours)), np.uint8)
    along = axes.T @ colours[:, :3].T.astype(np.float32) - (middle @ axes)[:, None]
    low, span = along.min(axis=1), np.maximum(np.ptp(along, axis=1), 1.0)
    data[:2] = (along - low[:, None]) * (255 / span)[:, None] + 0.5
    x, y, z = normals[:, :3].T.astype(np.float32) / 127.5 - 1
    slopes = np.array([x, y]) / np.maximum(z, 1 / STEEPEST)
    steepness = max(float(np.abs(slopes).max()), 1e-3)
    data[2:] = slopes * (127.5 / steepness) + 128.0
    ramp = np.vstack([middle + axes @ low, axes.T * span[:, None]]) / 255
    return PackedMap(size, data.T.tobytes(), ramp.astype(np.float32), steepness)


def _bytes(path: Path) -> tuple[tuple[int, int], npt.NDArray[np.uint8]]:
    size, data = pixels(path)
    return size, np.frombuffer(data, np.uint8).reshape(-1, 4)
