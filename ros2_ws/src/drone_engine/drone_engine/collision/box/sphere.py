"""Spheres: whether two touch, exactly, and where. Closed balls: touching is a hit."""

import math

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision import exact_arithmetic as exact
from drone_engine.kernel import kernel

ROUNDING = 2.0**-49  # 16 roundings, twice those of the squares compared
SMALL, LARGE = 1e-280, 1e300  # m2; beyond them rounding is no longer relative


@kernel
def touch(ax, ay, az, ra, bx, by, bz, rb, acc):
    """Whether two balls have a point in common: |b - a|^2 <= (ra + rb)^2, exactly. acc: an accumulator, scratch."""
    dx, dy, dz, reach = bx - ax, by - ay, bz - az, ra + rb
    square, limit = dx * dx + dy * dy + dz * dz, reach * reach
    total = square + limit
    if SMALL < total < LARGE:
        if square - limit > ROUNDING * total:
            return False
        if square - limit < -ROUNDING * total:
            return True
    for a, b in ((ax, bx), (ay, by), (az, bz)):
        exact.add(acc, 1, a, a, 1.0, 1.0)
        exact.add(acc, 1, b, b, 1.0, 1.0)
        exact.add(acc, -1, a, b, 2.0, 1.0)
    exact.add(acc, -1, ra, ra, 1.0, 1.0)
    exact.add(acc, -1, rb, rb, 1.0, 1.0)
    exact.add(acc, -1, ra, rb, 2.0, 1.0)
    return exact.sign(acc) <= 0


@kernel
def between(ax, ay, az, ra, bx, by, bz, rb):
    """Unit normal from ball a to b, the point midway between the surfaces, and the separation, m: seven numbers.

    Of one centre, the normal is z. Swapping a and b turns the normal otherwise, no more.
    """
    dx, dy, dz = bx - ax, by - ay, bz - az
    most = max(abs(dx), abs(dy), abs(dz))
    if most == 0.0:
        return 0.0, 0.0, 1.0, ax, ay, az + 0.5 * (ra - rb), -(ra + rb)
    dx, dy, dz = dx / most, dy / most, dz / most  # so that no square is 0 or infinite
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    nx, ny, nz = dx / length, dy / length, dz / length
    half = 0.5 * (ra - rb)
    return (nx, ny, nz, 0.5 * (ax + bx) + half * nx, 0.5 * (ay + by) + half * ny, 0.5 * (az + bz) + half * nz,
            most * length - (ra + rb))


@kernel
def contact(position, half, a, b, margin, normal, point, separation, feature):
    """The contact of the bounding spheres of boxes a and b, up to `margin` m apart; returns its points, 0 or 1."""
    ra = math.sqrt(half[a, 0] ** 2 + half[a, 1] ** 2 + half[a, 2] ** 2)
    rb = math.sqrt(half[b, 0] ** 2 + half[b, 1] ** 2 + half[b, 2] ** 2)
    nx, ny, nz, x, y, z, s = between(position[a, 0], position[a, 1], position[a, 2], ra,
                                     position[b, 0], position[b, 1], position[b, 2], rb)
    if s > margin:
        return 0
    normal[0], normal[1], normal[2] = nx, ny, nz
    point[0, 0], point[0, 1], point[0, 2] = x, y, z
    separation[0], feature[0] = s, 0
    return 1


@kernel
def _exists(x, y, z, radius):
    return math.isfinite(x) & math.isfinite(y) & math.isfinite(z) & (radius >= 0.0) & (radius < np.inf)


@kernel
def _intersects(center_a, radius_a, center_b, radius_b, hit):
    """Writes the answers; returns the first pair with a number that no sphere has, or -1."""
    acc = exact.zeros()
    for k in range(len(hit)):
        ax, ay, az, bx, by, bz = (center_a[k, 0], center_a[k, 1], center_a[k, 2],
                                  center_b[k, 0], center_b[k, 1], center_b[k, 2])
        ra, rb = radius_a[k], radius_b[k]
        if not _exists(ax, ay, az, ra) or not _exists(bx, by, bz, rb):
            return k
        hit[k] = touch(ax, ay, az, ra, bx, by, bz, rb, acc)
    return -1


@kernel
def _contacts(center_a, radius_a, center_b, radius_b, normal, point, separation):
    for k in range(len(separation)):
        nx, ny, nz, x, y, z, s = between(center_a[k, 0], center_a[k, 1], center_a[k, 2], radius_a[k],
                                         center_b[k, 0], center_b[k, 1], center_b[k, 2], radius_b[k])
        normal[k, 0], normal[k, 1], normal[k, 2] = nx, ny, nz
        point[k, 0], point[k, 1], point[k, 2] = x, y, z
        separation[k] = s


def intersects(center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike, radius_b: ArrayLike) -> Booleans:
    """Whether spheres a and b of each pair touch: (n,). Shapes (n, 3) and (n,), float64, m. Exact for the numbers as
    stored. ValueError for other shapes, numbers that are not finite and negative radii."""
    return _answers(_pairs(center_a, radius_a, center_b, radius_b))


def contacts(center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike,
             radius_b: ArrayLike) -> tuple[Booleans, Floats, Floats, Floats]:
    """Whether each pair touches (n,), exactly, and for all pairs, touching or not: unit normals from a to b (n, 3),
    points midway between the surfaces (n, 3), separations (n,), m. Arguments and errors as for `intersects`."""
    spheres = _pairs(center_a, radius_a, center_b, radius_b)
    hit, n = _answers(spheres), len(spheres[0])
    normal, point, separation = np.empty((n, 3)), np.empty((n, 3)), np.empty(n)
    _contacts(*spheres, normal, point, separation)
    return hit, normal, point, separation


Spheres = tuple[Floats, Floats, Floats, Floats]
NAMES = ("center_a", "radius_a", "center_b", "radius_b")


def _pairs(*arrays: ArrayLike) -> Spheres:
    """The arguments as contiguous float64 arrays of the right shapes."""
    pairs = [np.ascontiguousarray(array, np.float64) for array in arrays]
    n = len(pairs[0]) if pairs[0].ndim else 0
    for name, array in zip(NAMES, pairs, strict=True):
        expected = (n, 3) if name.startswith("center") else (n,)
        if array.shape != expected:
            raise ValueError(f"{name}: expected an array of shape {expected}, got {array.shape}")
    return pairs[0], pairs[1], pairs[2], pairs[3]


def _answers(spheres: Spheres) -> Booleans:
    hit = np.empty(len(spheres[0]), np.bool_)
    bad = _intersects(*spheres, hit)
    if bad >= 0:
        for name, array in zip(NAMES, spheres, strict=True):
            if not np.isfinite(array[bad]).all():
                raise ValueError(f"{name}[{bad}]: expected finite numbers, got {array[bad].tolist()}")
            if name.startswith("radius") and array[bad] < 0.0:
                raise ValueError(f"{name}[{bad}]: expected a radius that is not negative, got {array[bad]}")
    return hit
