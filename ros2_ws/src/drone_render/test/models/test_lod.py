"""Levels of detail keep the shape, its seams and its borders."""

from itertools import pairwise

import numpy as np
import trimesh

from drone_render.models import lod


def sphere() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Position, normal, uv and faces of a unit sphere whose texture has a seam where it closes."""
    columns, rows = 33, 17
    around, polar = np.meshgrid(np.linspace(0, 2 * np.pi, columns), np.linspace(0.2, np.pi - 0.2, rows))
    position = np.dstack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)])
    position[:, -1] = position[:, 0]
    uv = np.dstack([around / (2 * np.pi), polar / np.pi]).reshape(-1, 2)
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    faces = np.vstack([np.column_stack([a, a + columns, a + 1]),
                       np.column_stack([a + 1, a + columns, a + columns + 1])])
    position = position.reshape(-1, 3)
    return position, position, uv, faces.astype(np.int32)


def borders(position: np.ndarray, faces: np.ndarray) -> set[tuple[bytes, bytes]]:
    """Edges, as places, that one triangle alone has."""
    place = np.unique(position.round(9), axis=0, return_inverse=True)[1].ravel()
    edges = np.sort(place[faces][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    found, count = np.unique(edges, axis=0, return_counts=True)
    return {tuple(edge) for edge in found[count != 2].tolist()}


def test_a_sphere_stays_round_and_closed_where_it_was() -> None:
    position, normal, uv, faces = sphere()
    found = lod.levels(position, normal, uv, faces, np.zeros(len(position), bool))
    counts = [len(level.faces) for level in found]
    assert len(found) == 6 and all(b < 0.7 * a for a, b in pairwise(counts))
    errors = [level.error for level in found]
    assert errors == sorted(errors) and errors[0] == 0 < errors[1]
    for level in found:
        middles = np.linalg.norm(position[level.faces].mean(axis=1), axis=1)
        assert middles.min() > 1 - max(4 * level.error, 0.02)
        holes = borders(position, level.faces)
        assert len(holes) <= 64  # the two rims and nothing else: at most the edges that they had
    # On the seam both sides keep their own texture coordinates: no triangle spans the whole texture.
    spans = np.ptp(uv[found[-1].faces][..., 0], axis=1)
    assert spans.max() < 0.75


def test_kept_vertices_stay_and_flat_parts_lose_vertices() -> None:
    plate = trimesh.creation.box((2, 2, 0)).subdivide().subdivide().subdivide().subdivide()
    position = np.column_stack([plate.vertices[:, :2], np.zeros(len(plate.vertices))])
    up = plate.face_normals[:, 2] > 0.5
    grid = np.unique(plate.faces[up], return_inverse=True)
    position, faces = position[grid[0]], grid[1].reshape(-1, 3).astype(np.int32)
    normal = np.tile([0.0, 0.0, 1.0], (len(position), 1))
    kept = np.abs(position[:, 0]) < 1e-9
    (*_, last) = lod.levels(position, normal, position[:, :2], faces, kept)
    assert len(last.faces) < 0.5 * len(faces) and last.error < 1e-6
    assert set(np.flatnonzero(kept)) <= set(last.faces.ravel().tolist())
    area = 0.5 * np.linalg.norm(np.cross(*(position[last.faces[:, i]] - position[last.faces[:, 0]] for i in (1, 2))),
                                axis=1)
    assert np.isclose(area.sum(), 4.0)


def test_every_triangle_is_in_one_block() -> None:
    mesh = trimesh.creation.icosphere(5)
    found = lod.blocks(mesh.vertices, mesh.faces)
    assert len(found) > 8 and max(map(len, found)) <= lod.BLOCK
    assert sorted(np.concatenate(found).tolist()) == list(range(len(mesh.faces)))


def test_no_hole_opens_at_duplicate_vertices() -> None:
    """A sphere whose triangles use either of two vertices at a place at random, so that seams run anywhere."""
    mesh = trimesh.creation.icosphere(4)
    lots = np.random.default_rng(5)
    doubled = lots.random(len(mesh.vertices)) < 0.3
    second = (lots.random(mesh.faces.shape) < 0.5) & doubled[mesh.faces]
    position = np.vstack([mesh.vertices, mesh.vertices])
    faces = np.where(second, mesh.faces + len(mesh.vertices), mesh.faces).astype(np.int32)
    found = lod.levels(position, position, np.zeros((len(position), 2)), faces, np.zeros(len(position), bool))
    assert len(found) > 2
    for level in found:
        around = level.faces % len(mesh.vertices)
        edges = np.sort(np.vstack([around[:, [0, 1]], around[:, [1, 2]], around[:, [2, 0]]]), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
