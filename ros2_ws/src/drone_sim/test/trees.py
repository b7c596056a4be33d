"""Meshes and octrees of them for the tests."""

from typing import NamedTuple

import numpy as np

LEAF = 6  # triangles


class Tree(NamedTuple):
    box: np.ndarray
    link: np.ndarray
    corners: np.ndarray
    face: np.ndarray


def build(vertices: np.ndarray, faces: np.ndarray) -> Tree:
    """An octree by the octants of the triangles' centroids."""
    triangles = np.asarray(vertices, float)[faces]
    boxes: list[np.ndarray] = []
    links: list[list[int]] = []
    order: list[int] = []

    def box(chosen: np.ndarray) -> np.ndarray:
        points = triangles[chosen].reshape(-1, 3)
        return np.concatenate([(points.max(0) + points.min(0)) / 2, (points.max(0) - points.min(0)) / 2])

    def fill(node: int, chosen: np.ndarray) -> None:
        centroid = triangles[chosen].mean(1)
        octant = (centroid > boxes[node][:3]) @ [1, 2, 4]
        groups = [chosen[octant == o] for o in range(8) if (octant == o).any()]
        start = len(order)
        if len(chosen) <= LEAF or len(groups) == 1:
            order.extend(chosen.tolist())
            links[node] = [0, 0, start, len(chosen)]
            return
        first = len(boxes)
        boxes.extend(box(group) for group in groups)
        links.extend([[]] * len(groups))
        for i, group in enumerate(groups):
            fill(first + i, group)
        links[node] = [first, len(groups), start, len(chosen)]

    everything = np.arange(len(triangles))
    boxes.append(box(everything))
    links.append([])
    fill(0, everything)
    return Tree(np.array(boxes), np.array(links, np.int32), triangles[order], np.array(order, np.int64))


def forest(*trees: Tree) -> tuple[Tree, list[int]]:
    """All in one, and their roots."""
    roots, links, nodes, triangles = [], [], 0, 0
    for tree in trees:
        link = tree.link.copy()
        link[:, 2] += triangles
        link[link[:, 1] > 0, 0] += nodes
        links.append(link)
        roots.append(nodes)
        nodes += len(tree.box)
        triangles += len(tree.corners)
    return Tree(np.concatenate([t.box for t in trees]), np.concatenate(links),
                np.concatenate([t.corners for t in trees]), np.concatenate([t.face for t in trees])), roots


def ball(rows: int = 22, columns: int = 46, bumps: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A closed mesh about the origin, radius about 1: vertices and 2 (rows - 1) columns triangles."""
    theta, phi = np.linspace(0, np.pi, rows + 1)[1:-1], np.linspace(0, 2 * np.pi, columns, endpoint=False)
    t, p = (grid.ravel() for grid in np.meshgrid(theta, phi, indexing="ij"))
    vertices = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], 1)
    vertices *= 1 + bumps * np.sin(5 * p + 3 * t)[:, None]
    vertices = np.vstack([vertices, [0, 0, 1], [0, 0, -1]])
    north, south = len(vertices) - 2, len(vertices) - 1
    faces = []
    for i in range(rows - 2):
        for j in range(columns):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            faces += [(a, a + columns, b), (b, a + columns, b + columns)]
    last = (rows - 2) * columns
    for j in range(columns):
        faces += [(north, j, (j + 1) % columns), (south, last + (j + 1) % columns, last + j)]
    return vertices, np.array(faces)


def block(x: float, y: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """A closed box of half extents x, y, z about the origin: 12 triangles."""
    vertices = np.array([(i * x, j * y, k * z) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return vertices, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
