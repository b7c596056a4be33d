"""Families of box pairs near touch, for which floating-point tests are often wrong.

A family makes n pairs from a seeded generator, as six arrays in the order of the box kernels: center_a, axes_a, half_a,
center_b, axes_b, half_b, shapes (n, 3), (n, 3, 3) with one axis per row, (n, 3), twice. At least half of each family
is within a few roundings of touching.
"""

from collections.abc import Callable
from itertools import permutations, product

import numpy as np
from numpy.random import Generator

from drone_engine.arrays import Floats

Pairs = tuple[Floats, Floats, Floats, Floats, Floats, Floats]

QUARTERS = np.array([np.eye(3)[list(order)] * signs for order in permutations(range(3))
                     for signs in product((1.0, -1.0), repeat=3)])  # rotations by quarter turns, mirrored ones included
FAR = 1e6  # m


def near_contact(rng: Generator, n: int) -> Pairs:
    """Randomly rotated boxes: half of the pairs up to 20 % from touching, the others a few roundings."""
    axes_a, axes_b = rotations(rng, n), rotations(rng, n)
    half_a, half_b = rng.uniform(0.1, 1.0, (2, n, 3))
    return placed(rng, rng.uniform(-50, 50, (n, 3)), axes_a, half_a, axes_b, half_b)


def parallel(rng: Generator, n: int) -> Pairs:
    """Boxes rotated by multiples of 90 degrees against each other, faces nearly coplanar: +-1 ulp on each number."""
    straight = rng.random((n, 1, 1)) < 0.5
    axes_a = np.where(straight, QUARTERS[rng.integers(0, 48, n)], rotations(rng, n))
    axes_b = QUARTERS[rng.integers(0, 48, n)] @ axes_a
    half_a, half_b = rng.integers(1, 9, (2, n, 3)) * rng.choice([0.125, 0.1], (n, 1))
    reach = half_a + np.einsum("nij,nj->ni", np.abs(np.einsum("nik,njk->nij", axes_a, axes_b)), half_b)
    share = np.where(rng.random((n, 3)) < 0.5, rng.choice([-1.0, 1.0], (n, 3)), rng.uniform(-1, 1, (n, 3)))
    center_a = rng.integers(-8, 9, (n, 3)).astype(np.float64) * 0.25
    center_b = center_a + np.einsum("ni,nij->nj", share * reach, axes_a)
    return nudged(rng, center_a, axes_a, half_a, center_b, axes_b, half_b)


def touching(rng: Generator, n: int) -> Pairs:
    """A corner, or a point of an edge or face, of a exactly on one of b; half of the pairs 1 ulp nearer or farther.

    Axes are orthogonal integer vectors and points are binary fractions, so no operation here rounds.
    """
    axes_a, axes_b = whole_rotations(rng, n), whole_rotations(rng, n)
    half_a, half_b = rng.integers(1, 9, (2, n, 3)) / 8.0
    center_a = rng.integers(-8, 9, (n, 3)) / 4.0
    normal = np.choose(rng.integers(0, 3, n)[:, None], [
        axes_a[np.arange(n), rng.integers(0, 3, n)], axes_b[np.arange(n), rng.integers(0, 3, n)],
        np.cross(axes_a[np.arange(n), rng.integers(0, 3, n)], axes_b[np.arange(n), rng.integers(0, 3, n)])])
    on_a, on_b = _farthest(rng, axes_a, half_a, normal), _farthest(rng, axes_b, half_b, -normal)
    center_b = center_a + on_a - on_b
    moved = np.nextafter(center_b, center_b + rng.choice([-1.0, 1.0], (n, 3)) * np.sign(normal))
    return center_a, axes_a, half_a, np.where(rng.random((n, 1)) < 0.5, moved, center_b), axes_b, half_b


def thin(rng: Generator, n: int) -> Pairs:
    """Plates, rods and points in random, quarter-turn and integer orientations, touching or nearly."""
    center_a, axes_a, half_a, center_b, axes_b, half_b = mixed(rng, n, near_contact, parallel, touching)
    for half in (half_a, half_b):
        half[rng.random((n, 3)) < 0.4] = 0.0
        half[rng.random((n, 3)) < 0.02] *= -0.0
    random = placed(rng, center_a, axes_a, half_a, axes_b, half_b)
    again = rng.random(n) < 0.5
    return center_a, axes_a, half_a, np.where(again[:, None], random[3], center_b), axes_b, half_b


def ratios(rng: Generator, n: int) -> Pairs:
    """Edges from 1e-6 to 1e6 m within one box and between the two."""
    axes_a, axes_b = rotations(rng, n), rotations(rng, n)
    straight = rng.random((n, 1, 1)) < 0.3
    axes_b = np.where(straight, QUARTERS[rng.integers(0, 48, n)] @ axes_a, axes_b)
    half_a, half_b = 10.0 ** rng.uniform(-6, 6, (2, n, 3))
    return placed(rng, rng.uniform(-1, 1, (n, 3)), axes_a, half_a, axes_b, half_b)


def moved(rng: Generator, n: int) -> Pairs:
    """Pairs of the other families, moved by 1e6 m."""
    center_a, axes_a, half_a, center_b, axes_b, half_b = mixed(rng, n, near_contact, parallel, touching, thin)
    direction = FAR * directions(rng, n)
    return center_a + direction, axes_a, half_a, center_b + direction, axes_b, half_b


def skewed(rng: Generator, n: int) -> Pairs:
    """Axes that deviate from orthonormal, by the last digit up to visibly; some coplanar."""
    center_a, axes_a, half_a, _, axes_b, half_b = near_contact(rng, n)
    for axes in (axes_a, axes_b):
        axes += rng.normal(size=(n, 3, 3)) * 10.0 ** rng.uniform(-17, -1, (n, 1, 1))
        axes *= np.where(rng.random((n, 1, 1)) < 0.1, 10.0 ** rng.uniform(-3, 3, (n, 3, 1)), 1.0)
    flat = rng.random(n) < 0.1  # all six axes and the offset in the plane z = tilt x
    for array in (axes_a, axes_b, half_a, half_b, center_a):
        array[flat] = np.round(3 * array[flat])
    half_a, half_b = np.abs(half_a), np.abs(half_b)
    tilt = rng.integers(-1, 2, n).astype(np.float64)
    for axes in (axes_a, axes_b):
        axes[flat, :, 2] = tilt[flat, None] * axes[flat, :, 0]
    pairs = placed(rng, center_a, axes_a, half_a, axes_b, half_b)
    offset = np.round(rng.normal(size=(n, 3)) * (half_a + half_b).max(1, keepdims=True) * 1.5)
    offset[:, 2] = tilt * offset[:, 0]
    pairs[3][flat] = (center_a + offset)[flat]
    return pairs


def exponents(rng: Generator, n: int) -> Pairs:
    """Pairs of the other families, scaled so that products of their numbers underflow or overflow."""
    center_a, axes_a, half_a, center_b, axes_b, half_b = mixed(rng, n, near_contact, parallel, touching, thin, skewed)
    meter = 2.0 ** rng.choice([-1074, -1070, -1022, -600, -300, 0, 300, 600, 1000, 1015], (n, 1))
    length = 2.0 ** np.where(np.abs(np.log2(meter)) < 700, rng.choice([-300, -20, 0, 20, 300], (n, 1)), 0.0)[..., None]
    size = meter / length[..., 0]
    return center_a * meter, axes_a * length, half_a * size, center_b * meter, axes_b * length, half_b * size


FAMILIES: dict[str, Callable[[Generator, int], Pairs]] = {
    "near_contact": near_contact, "parallel": parallel, "touching": touching, "thin": thin, "ratios": ratios,
    "moved": moved, "skewed": skewed, "exponents": exponents,
}


def rotations(rng: Generator, n: int) -> Floats:
    """Random rotation matrices (n, 3, 3), each entry rounded once."""
    x, y, z, w = np.moveaxis(directions(rng, n, 4), -1, 0)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                     2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1).reshape(n, 3, 3)


def whole_rotations(rng: Generator, n: int) -> Floats:
    """Orthogonal axes of equal length with integer components, from small integer quaternions."""
    x, y, z, w = rng.integers(-2, 3, (4, n)).astype(np.float64)
    w += (x == 0) & (y == 0) & (z == 0) & (w == 0)
    s = x * x + y * y + z * z + w * w
    return np.stack([s - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                     2 * (x * y + z * w), s - 2 * (x * x + z * z), 2 * (y * z - x * w),
                     2 * (x * z - y * w), 2 * (y * z + x * w), s - 2 * (x * x + y * y)], -1).reshape(n, 3, 3)


def directions(rng: Generator, n: int, dimensions: int = 3) -> Floats:
    """Random unit vectors (n, dimensions)."""
    vectors = rng.normal(size=(n, dimensions))
    unit: Floats = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return unit


def placed(rng: Generator, center_a: Floats, axes_a: Floats, half_a: Floats, axes_b: Floats, half_b: Floats) -> Pairs:
    """Places b in a random direction from a, at the distance of touch or up to 20 % nearer or farther."""
    n = len(center_a)
    direction = directions(rng, n)
    axes, half = np.concatenate([axes_a, axes_b], 1), np.concatenate([half_a, half_b], 1)
    i, j = np.triu_indices(6, 1)
    normals = np.cross(axes[:, i], axes[:, j])
    reach = np.einsum("nik,nk->ni", np.abs(np.einsum("nic,nkc->nik", normals, axes)), half)
    along = np.abs(np.einsum("nic,nc->ni", normals, direction))
    with np.errstate(all="ignore"):
        distance = np.nanmin(np.where(along > 1e-12, reach / along, np.inf), axis=1, keepdims=True)
    distance[~np.isfinite(distance)] = 1.0
    nearly = 1 + 2.0**-52 * rng.integers(-4, 5, (n, 1))
    distance *= np.where(rng.random((n, 1)) < 0.5, rng.uniform(0.8, 1.2, (n, 1)), nearly)
    return center_a, axes_a, half_a, center_a + direction * distance, axes_b, half_b


def nudged(rng: Generator, *arrays: Floats) -> Pairs:
    """Each number moved by -1, 0 or 1 ulp; 0 becomes the smallest subnormal number of either sign."""
    return tuple(np.nextafter(x, x + rng.integers(-1, 2, x.shape)) for x in arrays)  # type: ignore[return-value]


def mixed(rng: Generator, n: int, *families: Callable[[Generator, int], Pairs]) -> Pairs:
    """About n / k pairs of each of the k families."""
    parts = [family(rng, len(range(i, n, len(families)))) for i, family in enumerate(families)]
    return tuple(np.concatenate(arrays) for arrays in zip(*parts, strict=True))  # type: ignore[return-value]


def _farthest(rng: Generator, axes: Floats, half: Floats, direction: Floats) -> Floats:
    """A farthest point of the box at the origin along `direction`: a corner, or a point of such an edge or face."""
    side = np.sign(np.einsum("nij,nj->ni", axes, direction))
    anywhere = rng.integers(-8, 9, side.shape) / 8.0
    point: Floats = np.einsum("ni,nij->nj", np.where(side == 0, anywhere, side) * half, axes)
    return point
