"""Pairs of spheres: whether they touch, exactly, and where. Spheres are solid and closed: touching is a hit."""

import math

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.arrays import Booleans, Floats
from drone_engine.collision.exact_arithmetic import add_product, sign, zeros
from drone_engine.kernel import allocating, kernel

ROUNDING = 2.0**-49  # 16 roundings, twice those of the squares compared
SMALL, LARGE = 1e-280, 1e300  # m2; beyond these, rounding errors are not relative any more


@kernel
def spheres_touch(ax, ay, az, ra, bx, by, bz, rb, acc):
    """Whether two spheres with centers a, b and radii ra, rb touch: |b - a|^2 <= (ra + rb)^2, exactly.

    acc: an accumulator that holds 0, as it does again afterwards.
    """
    dx, dy, dz, reach = bx - ax, by - ay, bz - az, ra + rb
    square, limit = dx * dx + dy * dy + dz * dz, reach * reach
    total = square + limit
    if SMALL < total < LARGE:
        if square - limit > ROUNDING * total:
            return False
        if square - limit < -ROUNDING * total:
            return True
    for a, b in ((ax, bx), (ay, by), (az, bz)):
        add_product(acc, 1, a, a, 1.0, 1.0)
        add_product(acc, 1, b, b, 1.0, 1.0)
        add_product(acc, -1, a, b, 2.0, 1.0)
    add_product(acc, -1, ra, ra, 1.0, 1.0)
    add_product(acc, -1, rb, rb, 1.0, 1.0)
    add_product(acc, -1, ra, rb, 2.0, 1.0)
    return sign(acc) <= 0


@kernel
def between(ax, ay, az, ra, bx, by, bz, rb):
    """Unit normal from sphere a to b, the point midway between the surfaces, and the separation, m: seven numbers.

    The normal of concentric spheres is z. Otherwise, swapping a and b reverses the normal and changes nothing else.
    """
    dx, dy, dz = bx - ax, by - ay, bz - az
    most = max(abs(dx), abs(dy), abs(dz))
    if most == 0.0:
        return 0.0, 0.0, 1.0, ax, ay, az + 0.5 * (ra - rb), -(ra + rb)
    dx, dy, dz = dx / most, dy / most, dz / most  # so that no square underflows or overflows
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    nx, ny, nz = dx / length, dy / length, dz / length
    half = 0.5 * (ra - rb)
    return (nx, ny, nz, 0.5 * (ax + bx) + half * nx, 0.5 * (ay + by) + half * ny, 0.5 * (az + bz) + half * nz,
            most * length - (ra + rb))


@kernel
def contact(position, half, a, b, margin, normal, point, separation, feature):
    """Writes the contact of the bounding spheres of boxes a and b, if they are at most `margin` m apart; returns its
    number of points, 0 or 1.

    position, half: (n, 3) centers and half extents; out: normal (3,), point (8, 3), separation (8,), feature (8,).
    """
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
def _is_valid(x, y, z, radius):
    """Whether a center and a radius are finite, and the radius is not negative."""
    return math.isfinite(x) & math.isfinite(y) & math.isfinite(z) & (radius >= 0.0) & (radius < np.inf)


@allocating
def _intersects(center_a, radius_a, center_b, radius_b, hit):
    """Writes whether the spheres of each pair touch to hit (n,); returns the first invalid pair, or -1."""
    acc = zeros()
    for k in range(len(hit)):
        ax, ay, az, bx, by, bz = (center_a[k, 0], center_a[k, 1], center_a[k, 2],
                                  center_b[k, 0], center_b[k, 1], center_b[k, 2])
        ra, rb = radius_a[k], radius_b[k]
        if not _is_valid(ax, ay, az, ra) or not _is_valid(bx, by, bz, rb):
            return k
        hit[k] = spheres_touch(ax, ay, az, ra, bx, by, bz, rb, acc)
    return -1


@kernel
def _contacts(center_a, radius_a, center_b, radius_b, normal, point, separation):
    """Writes `between` of each of n pairs to normal (n, 3), point (n, 3) and separation (n,)."""
    for k in range(len(separation)):
        nx, ny, nz, x, y, z, s = between(center_a[k, 0], center_a[k, 1], center_a[k, 2], radius_a[k],
                                         center_b[k, 0], center_b[k, 1], center_b[k, 2], radius_b[k])
        normal[k, 0], normal[k, 1], normal[k, 2] = nx, ny, nz
        point[k, 0], point[k, 1], point[k, 2] = x, y, z
        separation[k] = s


def intersects(center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike, radius_b: ArrayLike) -> Booleans:
    """Whether spheres a and b of each of n pairs touch: (n,). Centers (n, 3), radii (n,), float64, m.

    The answer is exact for the numbers as stored. Raises ValueError for other shapes, for numbers that are not finite
    and for negative radii.
    """
    return _touching(_checked_pairs(center_a, radius_a, center_b, radius_b))


def contacts(center_a: ArrayLike, radius_a: ArrayLike, center_b: ArrayLike,
             radius_b: ArrayLike) -> tuple[Booleans, Floats, Floats, Floats]:
    """Whether each of n pairs touches (n,), exactly, and for all pairs, touching or not: unit normals from a to b
    (n, 3), points midway between the surfaces (n, 3), separations (n,), m. Arguments and errors as for `intersects`."""
    spheres = _checked_pairs(center_a, radius_a, center_b, radius_b)
    hit, n = _touching(spheres), len(spheres[0])
    normal, point, separation = np.empty((n, 3)), np.empty((n, 3)), np.empty(n)
    _contacts(*spheres, normal, point, separation)
    return hit, normal, point, separation


SpherePairs = tuple[Floats, Floats, Floats, Floats]
NAMES = ("center_a", "radius_a", "center_b", "radius_b")


def _checked_pairs(*arrays: ArrayLike) -> SpherePairs:
    """The arguments as contiguous float64 arrays; raises ValueError for other shapes."""
    pairs = [np.ascontiguousarray(array, np.float64) for array in arrays]
    n = len(pairs[0]) if pairs[0].ndim else 0
    for name, array in zip(NAMES, pairs, strict=True):
        expected = (n, 3) if name.startswith("center") else (n,)
        if array.shape != expected:
            raise ValueError(f"{name}: expected an array of shape {expected}, got {array.shape}")
    return pairs[0], pairs[1], pairs[2], pairs[3]


def _touching(spheres: SpherePairs) -> Booleans:
    """Whether each pair touches (n,); raises ValueError for an invalid sphere."""
    hit = np.empty(len(spheres[0]), np.bool_)
    bad = _intersects(*spheres, hit)
    if bad >= 0:
        for name, array in zip(NAMES, spheres, strict=True):
            if not np.isfinite(array[bad]).all():
                raise ValueError(f"{name}[{bad}]: expected finite numbers, got {array[bad].tolist()}")
            if name.startswith("radius") and array[bad] < 0.0:
                raise ValueError(f"{name}[{bad}]: expected a radius that is not negative, got {array[bad]}")
    return hit
