"""Pairs of triangles that rounding gets wrong: a family makes n of them, (n, 3, 3) twice, from a seeded generator."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from drone_engine.arrays import Floats, Integers

Pairs = tuple[Floats, Floats]

MOVED = np.array([1e6, -1e6, 1e6])  # m


def near_contact(rng: Generator, n: int) -> Pairs:
    """Two random triangles, a point or a corner of one near a point of the other."""
    a, b = rng.normal(size=(2, n, 3, 3))
    at_a, at_b = _weights(rng, n) @ a, np.where(rng.random((n, 1, 1)) < 0.6, b[:, :1], _weights(rng, n) @ b)
    return a, b + (at_a - at_b) + rng.normal(size=(n, 1, 3)) * rng.choice([1e-9, 1e-3, 0.3], (n, 1, 1))


def touching(rng: Generator, n: int) -> Pairs:
    """A point of a rounded, put on an edge, on a corner or inside of b, then up to 2 ulp on every number."""
    a, b = near_contact(rng, n)
    pick = rng.integers(0, 3, n)
    weights = np.where(rng.random((n, 3)) < 0.4, 0.0, rng.random((n, 3))) + 1e-300
    weights /= weights.sum(axis=1, keepdims=True)
    b += (np.einsum("ni,nij->nj", weights, a) - b[np.arange(n), pick])[:, None]
    b[np.arange(n), pick] = np.einsum("ni,nij->nj", weights, a)
    return nudged(rng, a, 1), nudged(rng, b, 2)


def coplanar(rng: Generator, n: int) -> Pairs:
    """Both in one plane: exactly (a coordinate equal, or a sum of coordinates 0), or as near as rounding allows."""
    a, b = rng.normal(size=(2, n, 3, 3))
    b *= rng.choice([0.1, 1.0, 5.0], (n, 1, 1))  # some lie inside the other
    flat = rng.integers(0, 3, n)
    a[np.arange(n), :, flat] = b[np.arange(n), :, flat] = rng.normal(size=(n, 1))
    on_grid = rng.integers(-8, 9, (2, n, 3, 3)) / 8.0
    on_grid[..., 2] = -on_grid[..., 0] - on_grid[..., 1]
    turn = _rotations(rng, n)
    turned = np.einsum("nij,nkj->nki", turn, a), np.einsum("nij,nkj->nki", turn, b)
    kind = rng.integers(0, 3, (n, 1, 1))
    return np.choose(kind, [a, on_grid[0], turned[0]]), np.choose(kind, [b, on_grid[1], turned[1]])


def sharing_edge(rng: Generator, n: int) -> Pairs:
    """Two corners are common, or the edge of one lies along that of the other up to rounding."""
    a, b = rng.normal(size=(2, n, 3, 3))
    ends = rng.uniform(-0.5, 1.5, (n, 2, 1))
    along = a[:, :1] + ends * (a[:, 1:2] - a[:, :1])
    b[:, :2] = np.where(rng.random((n, 1, 1)) < 0.4, a[:, 1::-1], along)
    return _shuffled(rng, a), _shuffled(rng, b)


def sharing_vertex(rng: Generator, n: int) -> Pairs:
    """A corner is common, or as common as one ulp leaves it."""
    a, b = rng.normal(size=(2, n, 3, 3))
    b[:, 0] = a[:, 0]
    b = np.where(rng.random((n, 1, 1)) < 0.5, nudged(rng, b, 1), b)
    return _shuffled(rng, a), _shuffled(rng, b)


def needles(rng: Generator, n: int) -> Pairs:
    """1e8 times as long as wide, crossing each other or missing by about their width."""
    a = _needle(rng, n)
    b = _needle(rng, n)
    at_a, at_b = _weights(rng, n) @ a, _weights(rng, n) @ b
    return a, b + (at_a - at_b) + 1e-8 * rng.normal(size=(n, 1, 3)) * rng.integers(0, 2, (n, 1, 1))


def zero_area(rng: Generator, n: int) -> Pairs:
    """One or both are segments or points: corners twice, or on one line, exactly or up to rounding."""
    a, b = near_contact(rng, n)
    return _flattened(rng, a), np.where(rng.random((n, 1, 1)) < 0.5, _flattened(rng, b), b)


def duplicates(rng: Generator, n: int) -> Pairs:
    """The same triangle twice, its corners in another order, on half of them moved by an ulp."""
    a = rng.normal(size=(n, 3, 3))
    b = _shuffled(rng, a)
    return a, np.where(rng.random((n, 1, 1)) < 0.5, nudged(rng, b, 1), b)


def moved_far(rng: Generator, n: int) -> Pairs:
    """Pairs of the other families, a million metres away: what is left of their digits decides."""
    parts = [make(rng, n // 4 + 1) for make in (near_contact, touching, sharing_edge, coplanar)]
    pick = rng.permutation(4 * (n // 4 + 1))[:n]
    return (np.concatenate([a for a, _ in parts])[pick] + MOVED, np.concatenate([b for _, b in parts])[pick] + MOVED)


def on_a_grid(rng: Generator, n: int) -> Pairs:
    """Corners with small whole coordinates: touches of every kind, all exact."""
    size = rng.integers(1, 5, (n, 1, 1))
    return (rng.integers(-size, size + 1, (n, 3, 3)).astype(np.float64),
            rng.integers(-size, size + 1, (n, 3, 3)).astype(np.float64))


def tiny_and_huge(rng: Generator, n: int) -> Pairs:
    """Other families scaled to subnormals, to 1e-100, 1e100 and 1e307, or each axis by a scale of its own."""
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


def nudged(rng: Generator, corners: Floats, most: int) -> Floats:
    """Every number up or down by up to `most` steps of float64."""
    steps: Integers = rng.integers(-most, most + 1, corners.shape)
    for _ in range(most):
        corners = np.where(steps == 0, corners, np.nextafter(corners, np.copysign(np.inf, steps)))
        steps -= np.sign(steps)
    return corners


def _weights(rng: Generator, n: int) -> Floats:
    """(n, 1, 3), weights of the corners of a point of a triangle."""
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
