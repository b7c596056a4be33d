"""Families of triangle pairs near touch, for which floating-point tests are often wrong.

A family makes n pairs from a seeded generator: two arrays of corners (n, 3, 3), one corner per row.
"""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from drone_engine.arrays import Floats, Integers

Pairs = tuple[Floats, Floats]

FAR = np.array([1e6, -1e6, 1e6])  # m


def near_contact(rng: Generator, n: int) -> Pairs:
    """Two random triangles, with a point or a corner of one near a point of the other."""
    a, b = rng.normal(size=(2, n, 3, 3))
    at_a, at_b = _weights(rng, n) @ a, np.where(rng.random((n, 1, 1)) < 0.6, b[:, :1], _weights(rng, n) @ b)
    return a, b + (at_a - at_b) + rng.normal(size=(n, 1, 3)) * rng.choice([1e-9, 1e-3, 0.3], (n, 1, 1))


def touching(rng: Generator, n: int) -> Pairs:
    """A rounded point of a on an edge, a corner or the interior of b, then up to 2 ulp on each number."""
    a, b = near_contact(rng, n)
    pick = rng.integers(0, 3, n)
    weights = np.where(rng.random((n, 3)) < 0.4, 0.0, rng.random((n, 3))) + 1e-300
    weights /= weights.sum(axis=1, keepdims=True)
    b += (np.einsum("ni,nij->nj", weights, a) - b[np.arange(n), pick])[:, None]
    b[np.arange(n), pick] = np.einsum("ni,nij->nj", weights, a)
    return nudged(rng, a, 1), nudged(rng, b, 2)


def coplanar(rng: Generator, n: int) -> Pairs:
    """Both in one plane: exactly (equal coordinates, or a coordinate sum of 0), or up to rounding."""
    a, b = rng.normal(size=(2, n, 3, 3))
    b *= rng.choice([0.1, 1.0, 5.0], (n, 1, 1))  # some triangles lie inside the other
    flat = rng.integers(0, 3, n)
    a[np.arange(n), :, flat] = b[np.arange(n), :, flat] = rng.normal(size=(n, 1))
    on_grid = rng.integers(-8, 9, (2, n, 3, 3)) / 8.0
    on_grid[..., 2] = -on_grid[..., 0] - on_grid[..., 1]
    turn = _rotations(rng, n)
    turned = np.einsum("nij,nkj->nki", turn, a), np.einsum("nij,nkj->nki", turn, b)
    kind = rng.integers(0, 3, (n, 1, 1))
    return np.choose(kind, [a, on_grid[0], turned[0]]), np.choose(kind, [b, on_grid[1], turned[1]])


def sharing_edge(rng: Generator, n: int) -> Pairs:
    """Two common corners, or an edge of one along an edge of the other up to rounding."""
    a, b = rng.normal(size=(2, n, 3, 3))
    ends = rng.uniform(-0.5, 1.5, (n, 2, 1))
    along = a[:, :1] + ends * (a[:, 1:2] - a[:, :1])
    b[:, :2] = np.where(rng.random((n, 1, 1)) < 0.4, a[:, 1::-1], along)
    return _shuffled(rng, a), _shuffled(rng, b)


def sharing_vertex(rng: Generator, n: int) -> Pairs:
    """A common corner, exactly or within one ulp."""
    a, b = rng.normal(size=(2, n, 3, 3))
    b[:, 0] = a[:, 0]
    b = np.where(rng.random((n, 1, 1)) < 0.5, nudged(rng, b, 1), b)
    return _shuffled(rng, a), _shuffled(rng, b)


def needles(rng: Generator, n: int) -> Pairs:
    """Triangles 1e8 times as long as wide that cross each other or miss by about their width."""
    a = _needle(rng, n)
    b = _needle(rng, n)
    at_a, at_b = _weights(rng, n) @ a, _weights(rng, n) @ b
    return a, b + (at_a - at_b) + 1e-8 * rng.normal(size=(n, 1, 3)) * rng.integers(0, 2, (n, 1, 1))


def zero_area(rng: Generator, n: int) -> Pairs:
    """One or both are segments or points: repeated or collinear corners, exactly or up to rounding."""
    a, b = near_contact(rng, n)
    return _flattened(rng, a), np.where(rng.random((n, 1, 1)) < 0.5, _flattened(rng, b), b)


def duplicates(rng: Generator, n: int) -> Pairs:
    """The same triangle twice with permuted corners; in half of the pairs moved by an ulp."""
    a = rng.normal(size=(n, 3, 3))
    b = _shuffled(rng, a)
    return a, np.where(rng.random((n, 1, 1)) < 0.5, nudged(rng, b, 1), b)


def moved_far(rng: Generator, n: int) -> Pairs:
    """Pairs of other families moved by 1e6 m; the remaining digits decide."""
    parts = [make(rng, n // 4 + 1) for make in (near_contact, touching, sharing_edge, coplanar)]
    pick = rng.permutation(4 * (n // 4 + 1))[:n]
    return (np.concatenate([a for a, _ in parts])[pick] + FAR, np.concatenate([b for _, b in parts])[pick] + FAR)


def on_a_grid(rng: Generator, n: int) -> Pairs:
    """Small integer coordinates: touches of every kind, all exact."""
    size = rng.integers(1, 5, (n, 1, 1))
    return (rng.integers(-size, size + 1, (n, 3, 3)).astype(np.float64),
            rng.integers(-size, size + 1, (n, 3, 3)).astype(np.float64))


def tiny_and_huge(rng: Generator, n: int) -> Pairs:
    """Other families scaled to subnormal numbers, to 1e-100, 1e100 and 1e307, or by a different scale per axis."""
    parts = [make(rng, n // 4 + 1) for make in (near_contact, touching, coplanar, on_a_grid)]
    pick = rng.permutation(4 * (n // 4 + 1))[:n]
    a, b = (np.concatenate([part[k] for part in parts])[pick] for k in (0, 1))
    scale = rng.choice([5e-324, 1e-322, 1e-308, 1e-160, 1e-100, 1.0, 1e100, 1e160, 1e306], (n, 1, 3))
    scale = np.where(rng.random((n, 1, 1)) < 0.5, scale[:, :, :1], scale)
    return np.clip(a * scale, -1.7e308, 1.7e308), np.clip(b * scale, -1.7e308, 1.7e308)


FAMILIES: dict[str, Callable[[Generator, int], Pairs]] = {
    make.__name__: make for make in (
        near_contact, touching, coplanar, sharing_edge, sharing_vertex, needles, zero_area, duplicates, moved_far,
        on_a_grid, tiny_and_huge)
}


def nudged(rng: Generator, corners: Floats, largest: int) -> Floats:
    """Each number moved by up to `largest` steps of float64 in either direction."""
    steps: Integers = rng.integers(-largest, largest + 1, corners.shape)
    for _ in range(largest):
        corners = np.where(steps == 0, corners, np.nextafter(corners, np.copysign(np.inf, steps)))
        steps -= np.sign(steps)
    return corners


def _weights(rng: Generator, n: int) -> Floats:
    """Barycentric weights (n, 1, 3) of random points of triangles."""
    return rng.dirichlet([1.0, 1.0, 1.0], (n, 1))


def _rotations(rng: Generator, n: int) -> Floats:
    q, _ = np.linalg.qr(rng.normal(size=(n, 3, 3)))
    return np.asarray(q, np.float64)


def _shuffled(rng: Generator, corners: Floats) -> Floats:
    order = np.argsort(rng.random((len(corners), 3)), axis=1)
    return np.take_along_axis(corners, order[:, :, None], axis=1)


def _needle(rng: Generator, n: int) -> Floats:
    start, end = rng.normal(size=(2, n, 3))
    tip = end + 1e-8 * rng.normal(size=(n, 3))
    return _shuffled(rng, np.stack([start, end, tip], axis=1))


def _flattened(rng: Generator, corners: Floats) -> Floats:
    """Corner 2 on the line of the others, or equal to one, or all equal; the mean of two grid points is exact."""
    n = len(corners)
    flat = corners.copy()
    on_grid = np.round(corners * 64.0) / 64.0
    kind = rng.integers(0, 4, n)
    t = rng.uniform(-1.0, 2.0, (n, 1))
    flat[:, 2] = np.choose(kind[:, None], [corners[:, 0] + t * (corners[:, 1] - corners[:, 0]), corners[:, 1],
                                           corners[:, 0], 0.5 * (on_grid[:, 0] + on_grid[:, 1])])
    flat[kind == 2, 1] = flat[kind == 2, 0]
    flat[kind == 3, :2] = on_grid[kind == 3, :2]
    return _shuffled(rng, flat)
