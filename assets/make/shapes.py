"""Primitive shapes as triangle soups. Metres, z up, x forward; texture coordinates in metres as well.

A model is a list of parts. Triangles turn counter-clockwise seen from outside.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drone_engine.math.poses import matrix_from_rpy

Array = NDArray[np.float64]

SMALLEST_AREA = 1e-9  # m^2; what poles and pointed ends leave behind is dropped


@dataclass(frozen=True)
class Part:
    """Triangles of one material: corners (n, 3, 3) and uv (n, 3, 2) in m; edges sharper than `crease` rad stay."""

    corners: Array
    uv: Array
    material: str
    crease: float = 0.7

    def moved(
        self, to: ArrayLike = (0, 0, 0), roll: float = 0, pitch: float = 0, yaw: float = 0, scale: ArrayLike = (1, 1, 1)
    ) -> "Part":
        """Scaled, turned about x, y, z in this order, and shifted. A mirrored part keeps its outside outside."""
        factors = np.broadcast_to(np.asarray(scale, float), (3,))
        corners = self.corners * factors @ matrix_from_rpy(roll, pitch, yaw).T + np.asarray(to, float)
        uv = self.uv
        if np.prod(factors) < 0:
            corners, uv = corners[:, ::-1], uv[:, ::-1]
        return replace(self, corners=corners, uv=uv)

    def boxed(self) -> "Part":
        """With texture coordinates projected along the axis that each triangle faces most."""
        facing = np.abs(_areas(self.corners)).argmax(axis=1)
        axes = np.array([[1, 2], [0, 2], [0, 1]])[facing]
        return replace(self, uv=np.take_along_axis(self.corners, axes[:, None, :].repeat(3, axis=1), axis=2))

    def grained(self) -> "Part":
        """With texture coordinates for wood: u runs along its longest side, v around it without a break."""
        long, b, c = np.argsort(-np.ptp(self.corners.reshape(-1, 3), axis=0), kind="stable")
        areas = _areas(self.corners)
        ends = np.abs(areas[:, long]) > 0.5 * np.linalg.norm(areas, axis=1)
        x, y, z = (self.corners[..., axis] for axis in (long, b, c))
        around, end = np.stack([x, z - y], axis=-1), np.stack([y, z], axis=-1)
        return replace(self, uv=np.where(ends[:, None, None], end, around))


Model = list[Part]


def moved(
    model: Sequence[Part],
    to: ArrayLike = (0, 0, 0),
    roll: float = 0,
    pitch: float = 0,
    yaw: float = 0,
    scale: ArrayLike = (1, 1, 1),
) -> Model:
    """Every part of a model, moved alike."""
    return [part.moved(to, roll, pitch, yaw, scale) for part in model]


def bounds(model: Sequence[Part]) -> tuple[Array, Array]:
    """The lowest and the highest corner of the box around a model."""
    points = np.concatenate([part.corners.reshape(-1, 3) for part in model])
    return points.min(axis=0), points.max(axis=0)


def centred(model: Sequence[Part]) -> Model:
    """Shifted so that the origin is the middle of the box around it."""
    low, high = bounds(model)
    return moved(model, to=-(low + high) / 2)


def surface(
    points: ArrayLike,
    material: str,
    closed: bool = False,
    caps: tuple[bool, bool] = (False, False),
    crease: float = 0.7,
    along: str = "v",
    uv: ArrayLike | None = None,
) -> Part:
    """A sheet through rows of points (rows, columns, 3); the columns turn counter-clockwise about the rows' way.

    `closed` joins the last column to the first, `caps` close the first and the last row with fans.
    `along` tells which texture coordinate runs along the rows' way; `uv`, (rows, columns, 2), gives both instead.
    """
    rows = np.asarray(points, float)
    if closed:
        rows = np.concatenate([rows, rows[:, :1]], axis=1)
    around = _lengths(rows.swapaxes(0, 1)).max(axis=1)
    if uv is None:
        uv = np.stack(np.broadcast_arrays(around[None, :], _lengths(rows).mean(axis=1)[:, None]), axis=-1)
    grid = np.dstack([rows, np.asarray(uv, float)])
    a, b, c, d = grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]
    soup = np.stack([a, b, c, a, c, d], axis=2).reshape(-1, 3, 5)
    fans = [_fan(row) for row, wanted in ((rows[0, ::-1], caps[0]), (rows[-1], caps[1])) if wanted]
    soup = np.concatenate([soup, *fans])
    soup = soup[np.linalg.norm(_areas(soup[..., :3]), axis=1) > SMALLEST_AREA]
    return Part(soup[..., :3], soup[..., 4:2:-1] if along == "u" else soup[..., 3:], material, crease)


def lathe(
    profile: ArrayLike,
    material: str,
    segments: int = 16,
    crease: float = 0.85,
    caps: tuple[bool, bool] = (False, False),
) -> Part:
    """A profile of (radius, z), turned about z; an outline that goes up has its outside outside."""
    radius, z = np.asarray(profile, float).T
    return surface(
        np.dstack([radius[:, None, None] * circle(segments), np.repeat(z[:, None], segments, axis=1)]),
        material,
        closed=True,
        crease=crease,
        caps=caps,
    )


def tube(
    path: ArrayLike,
    radius: ArrayLike,
    material: str,
    segments: int = 8,
    crease: float = 1.1,
    caps: tuple[bool, bool] = (True, True),
    along: str = "v",
) -> Part:
    """A round rod along a path (n, 3); radius is one for all, one a point, or two half-axes a point (n, 2)."""
    points = np.asarray(path, float)
    ways = np.gradient(points, axis=0)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    side = np.cross([0, 0, 1], ways[0])
    side = np.array([0.0, 1.0, 0.0]) if np.linalg.norm(side) < 1e-6 else side
    half = np.asarray(radius, float)
    half = np.broadcast_to(half[:, None] if half.ndim == 1 else half, (len(points), 2))
    rows = []
    for point, way, (across, up) in zip(points, ways, half, strict=True):
        side = side - way * (side @ way)
        side /= np.linalg.norm(side)
        ring = circle(segments)
        rows.append(point + ring[:, :1] * across * side + ring[:, 1:] * up * np.cross(way, side))
    return surface(rows, material, closed=True, crease=crease, caps=caps, along=along)


def loft(
    sections: ArrayLike,
    material: str,
    segments: int = 16,
    power: float = 2.5,
    crease: float = 0.9,
    caps: tuple[bool, bool] = (True, True),
    along: str = "u",
) -> Part:
    """A body along x through superellipses: sections of (x, z of the middle, half-width y, half-height z)."""
    ring = circle(segments)
    ring = np.sign(ring) * np.abs(ring) ** (2 / power)
    rows = [
        np.column_stack([np.full(segments, x), ring[:, 0] * width, middle + ring[:, 1] * height])
        for x, middle, width, height in np.asarray(sections, float)
    ]
    return surface(rows, material, closed=True, crease=crease, caps=caps, along=along)


def ball(size: ArrayLike, centre: ArrayLike, material: str, segments: int = 12, rings: int = 8) -> Part:
    """An ellipsoid with the given half-axes."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    part = lathe(np.column_stack([np.cos(angle), np.sin(angle)]), material, segments, crease=1.5)
    return part.moved(centre, scale=size)


def box(size: ArrayLike, centre: ArrayLike, material: str, bevel: float = 0.0, taper: float = 1.0) -> Part:
    """A cuboid, its edges cut off by `bevel`; `taper` scales its top."""
    x, y, z = np.asarray(size, float) / 2
    b = bevel
    corner = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]], float)
    if b:
        wide = np.repeat(corner, 2, axis=0) * [x, y] - np.repeat(corner, 2, axis=0) * np.tile(
            [[0, b], [b, 0], [b, 0], [0, b]], (2, 1)
        )
        flat = np.repeat(corner * [x - b, y - b], 2, axis=0)
        rings, heights = [flat, wide, wide, flat], [-z, b - z, z - b, z]
    else:
        rings, heights = [corner * [x, y]] * 2, [-z, z]
    rows = [
        np.column_stack([ring * (taper if height > 0 else 1), np.full(len(ring), height)])
        for ring, height in zip(rings, heights, strict=True)
    ]
    return surface(rows, material, closed=True, caps=(True, True), crease=0.3).boxed().moved(centre)


def prism(outline: ArrayLike, thickness: float, material: str, crease: float = 0.3) -> Part:
    """An outline (n, 2), counter-clockwise in the x-y plane, raised by `thickness`; its middle must see all of it."""
    flat = np.asarray(outline, float)
    rows = [np.column_stack([flat, np.full(len(flat), z)]) for z in (0.0, thickness)]
    return surface(rows, material, closed=True, caps=(True, True), crease=crease).boxed()


def circle(segments: int) -> Array:
    """Points of the unit circle, (segments, 2), counter-clockwise from +x."""
    angle = np.arange(segments) * (2 * np.pi / segments)
    return np.column_stack([np.cos(angle), np.sin(angle)])


def normals(part: Part) -> Array:
    """Unit normals (n, 3, 3): at each corner the mean over the triangles there that bend less than the crease."""
    areas = _areas(part.corners)
    unit = areas / np.linalg.norm(areas, axis=1, keepdims=True)
    keys = np.round(part.corners.reshape(-1, 3), 5) + 0.0
    _, group = np.unique(keys, axis=0, return_inverse=True)
    order = np.argsort(group.ravel(), kind="stable")
    result = np.empty((len(order), 3))
    for corners in np.split(order, np.cumsum(np.bincount(group.ravel()))[:-1]):
        faces = corners // 3
        near = unit[faces] @ unit[faces].T > np.cos(part.crease)
        result[corners] = near @ areas[faces]
    return np.asarray(result / np.linalg.norm(result, axis=1, keepdims=True)).reshape(-1, 3, 3)


def _areas(corners: Array) -> Array:
    """Normals of triangles, twice their area long."""
    return np.asarray(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))


def _lengths(rows: Array) -> Array:
    """How far it is from the first row to each, along each column."""
    steps = np.linalg.norm(np.diff(rows, axis=0), axis=-1)
    return np.concatenate([np.zeros((1, rows.shape[1])), np.cumsum(steps, axis=0)])


def _fan(ring: Array) -> Array:
    """Triangles from the middle of a closed ring to its edges, (n, 3, 5), with plane texture coordinates."""
    ring = ring[:-1] if np.allclose(ring[0], ring[-1]) else ring
    spread = np.ptp(ring, axis=0)
    keep = np.sort(np.argsort(spread, kind="stable")[1:])
    ring = np.column_stack([ring, ring[:, keep]])
    middle = np.broadcast_to(ring.mean(axis=0), ring.shape)
    return np.stack([middle, ring, np.roll(ring, -1, axis=0)], axis=1)
