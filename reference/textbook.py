"""Separating axis tests in plain float64, without any treatment of rounding, to compare with the exact answers.

Touching counts as a hit. All functions take n pairs and return (n,). Sums are written out, so that every platform
rounds them alike.
"""

import numpy as np

from drone_engine.arrays import Booleans, Floats

NEXT = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


def boxes(center_a: Floats, axes_a: Floats, half_a: Floats,
          center_b: Floats, axes_b: Floats, half_b: Floats, *, epsilon: float = 0.0) -> Booleans:
    """The fifteen box tests of Gottschalk et al. 1996: centers and half extents (n, 3), axes (n, 3, 3), one per row.

    epsilon: added to each product of axes, as there, to cover parallel axes.
    """
    turn = dot(axes_a[:, :, None], axes_b[:, None])
    away = dot(axes_a, (center_b - center_a)[:, None])
    size = np.abs(turn) + epsilon
    apart = (np.abs(away) > half_a + dot(size, half_b[:, None])).any(axis=1)
    back, size_back = turn.swapaxes(1, 2), size.swapaxes(1, 2)
    apart |= (np.abs(dot(away[:, None], back)) > half_b + dot(half_a[:, None], size_back)).any(axis=1)
    for i, i1, i2 in NEXT:
        for j, j1, j2 in NEXT:
            distance = np.abs(away[:, i2] * turn[:, i1, j] - away[:, i1] * turn[:, i2, j])
            reach = half_a[:, i1] * size[:, i2, j] + half_a[:, i2] * size[:, i1, j]
            reach += half_b[:, j1] * size[:, i, j2] + half_b[:, j2] * size[:, i, j1]
            apart |= distance > reach
    return np.asarray(~apart)


def triangles(a: Floats, b: Floats) -> Booleans:
    """Corners (n, 3, 3), one per row: both normals, nine cross products of edges, in-plane edge normals."""
    edges_a, edges_b = (np.roll(t, -1, axis=1) - t for t in (a, b))
    normal_a, normal_b = (np.cross(edges[:, 0], edges[:, 1]) for edges in (edges_a, edges_b))
    axes = [normal_a, normal_b]
    axes += [np.cross(edges_a[:, i], edges_b[:, j]) for i in range(3) for j in range(3)]
    axes += [np.cross(normal_a, edges_a[:, i]) for i in range(3)]
    axes += [np.cross(normal_b, edges_b[:, i]) for i in range(3)]
    apart = np.zeros(len(a), bool)
    for axis in axes:
        on_a, on_b = (dot(t, axis[:, None]) for t in (a, b))
        apart |= (on_a.max(axis=1) < on_b.min(axis=1)) | (on_b.max(axis=1) < on_a.min(axis=1))
    return ~apart


def dot(a: Floats, b: Floats) -> Floats:
    """Dot products along the last axis (length 3), summed from the left."""
    return np.asarray(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])
