"""The debug view of collision detection for RViz, Foxglove and the renderer.

It shows bounding spheres, boxes, octrees, sectors of the broad phase, and contacts. A marker is in the frame of its
body, so it moves with the body between two messages. Its color is that of the body's collision level, red while the
body touches another one; standing on a static body does not count.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision_level import OBB, OCTREE, SPHERE, TRIANGLE, UNSET
from drone_engine.world import World
from drone_sim.wire import debug_depth, layouts
from drone_sim.wire.layouts import MarkerLayout, marker_array

LEVELS = {SPHERE: (0.15, 0.75, 1.0), OBB: (0.2, 0.85, 0.3), OCTREE: (0.75, 0.35, 1.0), TRIANGLE: (0.95, 0.95, 0.95)}
TOUCHING = (1.0, 0.12, 0.08)
SECTOR, CONTACT = (0.65, 0.85, 1.0, 0.6), (1.0, 0.85, 0.0, 1.0)
FAINT, FAINT_SPHERE = 0.5, 0.2  # opacity of octrees and static bodies; of bounding spheres
THIN, PLAIN, STRONG, BOLD = 0.005, 0.01, 0.015, 0.02  # m, widths of lines
SUPPORT = 0.7  # upward component of the normal from which a contact with a static body counts as standing on it

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
EDGES = np.array([(i, j) for i in range(8) for j in range(i + 1, 8) if abs(CORNERS[i] - CORNERS[j]).sum() == 2]).ravel()
IDENTITY = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])  # pose
LENGTH, HEAD, DISC = 0.25, 0.08, 0.05  # m: length of an arrow, of its head, and radius of the disc at its start


def _arrow() -> Floats:
    """End points (2 k, 3) of the lines of an arrow along z, with a disc at its start; m."""
    angle = 2 * np.pi * (np.arange(8)[:, None] + [0, 1]).ravel() / 8
    disc = DISC * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    barbs = [end for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
             for end in ((0, 0, LENGTH), (0.45 * HEAD * x, 0.45 * HEAD * y, LENGTH - HEAD))]
    return np.vstack([disc, [(0, 0, 0), (0, 0, LENGTH)], barbs])


ARROW = _arrow()


class Markers:
    """The markers of one world; their constant parts are laid out once. SI units."""

    def __init__(self, world: World) -> None:
        self._world = world
        bodies = world.model.bodies
        self._bodies: Integers = np.flatnonzero(bodies.solid)
        poses = np.tile(IDENTITY, (bodies.count, 1))
        poses[:, :3] = bodies.center_b
        self._poses = poses
        half = bodies.half[self._bodies]
        corners = CORNERS[EDGES] * half[:, None]
        self._corners = [points.tobytes() for points in corners]
        diameters = 2.0 * np.linalg.norm(bodies.half, axis=1)
        solid = self._bodies.tolist()
        self._boxes = [self._lines("boxes", i, STRONG if bodies.movable[i] else THIN) for i in solid]
        self._spheres = [MarkerLayout(bodies.names[i], "spheres", i, layouts.SPHERE, poses[i], (diameters[i],) * 3)
                         for i in solid]
        self._trees: dict[int, tuple[MarkerLayout, bytes]] = {}
        self._trees_of: tuple[int, Octree] | None = None  # depth and octrees that _trees was made for
        self._sectors = MarkerLayout("world", "sectors", 0, layouts.LINE_LIST, IDENTITY, (PLAIN, 0.0, 0.0))
        self._contacts: dict[int, MarkerLayout] = {}

    def _lines(self, name: str, body: int, width: float) -> MarkerLayout:
        names = self._world.model.bodies.names
        return MarkerLayout(names[body], name, body, layouts.LINE_LIST, self._poses[body], (width, 0.0, 0.0))

    def message(self, time_ns: int, depth: int = debug_depth.DEFAULT) -> bytes:
        """A serialized visualization_msgs/MarkerArray of the last step; depth: of the octrees, 0 for their roots."""
        return marker_array(time_ns, self._markers(depth))

    def _markers(self, depth: int) -> Iterator[tuple[MarkerLayout, bytes, bytes]]:
        world, movable = self._world, self._world.model.bodies.movable
        contacts = world.contacts
        normal, pair = contacts.normal[contacts.manifold], contacts.pair[contacts.manifold]
        fixed = ~movable[pair]
        touching = np.zeros(len(movable), bool)
        touching[pair[~is_support(normal, fixed)]] = True
        level = self._levels()
        table = np.array([LEVELS[level] for level in range(max(LEVELS) + 1)])
        shades = np.where(touching[:, None], TOUCHING, table[np.clip(level, 0, max(LEVELS))])
        own = level == SPHERE

        boxes = _colors(shades, np.where(movable | touching, 1.0, FAINT))
        for row, body in enumerate(self._bodies.tolist()):
            yield self._boxes[row], boxes[body].tobytes(), self._corners[row]
        spheres = _colors(np.where(own[:, None], shades, LEVELS[SPHERE]), np.where(own, 3 * FAINT_SPHERE, FAINT_SPHERE))
        for row, body in enumerate(self._bodies.tolist()):
            if movable[body] or own[body]:
                yield self._spheres[row], spheres[body].tobytes(), b""
        trees = _colors(shades, np.full(len(shades), FAINT))
        for body in np.flatnonzero(touching | (movable & (level >= OCTREE))).tolist():
            if tree := self._tree(body, depth):
                yield tree[0], trees[body].tobytes(), tree[1]
        yield self._sectors, np.array(SECTOR, np.float32).tobytes(), self._sector_lines().tobytes()
        yield from self._arrows(pair, normal, fixed, contacts.arm)

    def _levels(self) -> Integers:
        """The collision level that each body requests, (n,)."""
        default, own, _, _ = self._world.detection.levels.tables()
        return np.where(own[:, 0] == UNSET, default[0], own[:, 0])

    def _tree(self, body: int, depth: int) -> tuple[MarkerLayout, bytes] | None:
        """The octree nodes of a body at the depth, and the leaves above it; None if the body has no octree."""
        forest = self._world.detection.forest
        if forest is None or forest[1][body] < 0:
            return None
        tree, roots = forest
        if self._trees_of is None or self._trees_of[0] != depth or self._trees_of[1] is not tree:
            self._trees, self._trees_of = {}, (depth, tree)
        if body not in self._trees:
            box = tree.box[_nodes(tree, int(roots[body]), depth)]
            points = box[:, None, :3] + CORNERS[EDGES] * box[:, None, 3:]
            self._trees[body] = self._lines("octrees", body, THIN), points.tobytes()
        return self._trees[body]

    def _sector_lines(self) -> Floats:
        """Edges (2 k, 3) of the sectors of the broad phase that contain a moving body, world frame, m."""
        corner, edge = self._world.detection.sectors()
        return np.asarray(corner[:, None] + (CORNERS[EDGES] + 1) * edge[:, None, None] / 2)

    def _arrows(self, pair: Integers, normal: Floats, fixed: Booleans, arm: Floats
                ) -> Iterator[tuple[MarkerLayout, bytes, bytes]]:
        """Contacts: an arrow along the normal, into the second moving body or the only one, in the frame of the first.

        pair: (k, 2) bodies. normal: (k, 3) unit, from the first to the second, world frame. fixed: (k, 2) whether
        static. arm: (k, 2, 3) from the center of mass of each body to the contact point, world frame, m.
        """
        side = fixed[:, 0].astype(int)
        rows = np.arange(len(side))
        body = pair[rows, side]
        axes = self._world.detection.axes[body]  # at the start of the step, as are the arms
        ahead = np.where(fixed[:, 1], -1.0, 1.0)[:, None] * normal
        middle = np.einsum("kij,kj->ki", axes, arm[rows, side])
        along = np.einsum("kij,kj->ki", axes, ahead)
        points = middle[:, None] + np.einsum("pj,kji->kpi", ARROW, _frames(along))
        order = np.argsort(body, kind="stable")
        bodies, first = np.unique(body[order], return_index=True)
        color = np.array(CONTACT, np.float32).tobytes()
        for i, group in zip(bodies.tolist(), np.split(points[order], first[1:]), strict=False):
            if i not in self._contacts:
                self._contacts[i] = self._lines("contacts", i, BOLD)
            yield self._contacts[i], color, group.tobytes()


def is_support(normal: Floats, fixed: Booleans) -> Booleans:
    """Which contacts (k,) are of a body that stands on a static one. normal: (k, 3) from a to b; fixed: (k, 2)."""
    up = normal[:, 2]
    return np.asarray((fixed[:, 0] & (up > SUPPORT)) | (fixed[:, 1] & (up < -SUPPORT)))


def _colors(shades: Floats, opacity: Floats) -> NDArray[np.float32]:
    """Red, green, blue, alpha (n, 4) from 0 to 1. shades: (n, 3). opacity: (n,)."""
    return np.column_stack([shades, opacity]).astype(np.float32)


def _frames(along: Floats) -> Floats:
    """Right-handed axes (k, 3, 3), one per row, of which the third is `along` (k, 3), unit vectors."""
    other = np.where(np.abs(along[:, :1]) < 0.7, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    first = np.cross(along, other)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(along, first), along], axis=1)


def _nodes(tree: Octree, root: int, depth: int) -> list[int]:
    """Nodes of an octree at a depth below a root, and leaves above that depth."""
    nodes = [root]
    for _ in range(depth):
        below: list[int] = []
        for node in nodes:
            first, children = tree.link[node, :2]
            below += range(first, first + children) if children else [node]
        nodes = below
    return nodes
