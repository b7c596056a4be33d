"""What the collision detection sees, for RViz, Foxglove and the picture: balls, boxes, octrees, sectors, contacts.

A marker stands in the frame of its body, so that it is where the body is, however seldom it is told. A body has the
colour of its level, and is red while it touches another thing; what merely stands on something static is not.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.collision.mesh.octree import Octree
from drone_engine.collision_level import OBB, OCTREE, SPHERE, TRIANGLE, UNSET
from drone_engine.world import World
from drone_sim.wire import debug_depth
from drone_sim.wire.layouts import BALL, LINE_LIST, Mark, marker_array

LEVELS = {SPHERE: (0.15, 0.75, 1.0), OBB: (0.2, 0.85, 0.3), OCTREE: (0.75, 0.35, 1.0), TRIANGLE: (0.95, 0.95, 0.95)}
TOUCHING = (1.0, 0.12, 0.08)
SECTOR, CONTACT = (0.65, 0.85, 1.0, 0.6), (1.0, 0.85, 0.0, 1.0)
FAINT, FAINT_BALL = 0.5, 0.2  # opacity of octrees and of what never moves; of bounding spheres
THIN, PLAIN, STRONG, BOLD = 0.005, 0.01, 0.015, 0.02  # m, widths of lines
CARRIES = 0.7  # upward part of the normal from which on a contact with something static is standing on it

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
EDGES = np.array([(i, j) for i in range(8) for j in range(i + 1, 8) if abs(CORNERS[i] - CORNERS[j]).sum() == 2]).ravel()
HERE = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])  # the pose of what needs none
LENGTH, HEAD, DISC = 0.25, 0.08, 0.05  # m, of an arrow, of its head, and the radius of the disc that it stands on


def _arrow() -> Floats:
    """Ends (2 k, 3) of the lines of an arrow along z, with a disc where it starts."""
    angle = 2 * np.pi * (np.arange(8)[:, None] + [0, 1]).ravel() / 8
    disc = DISC * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    wings = [end for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
             for end in ((0, 0, LENGTH), (0.45 * HEAD * x, 0.45 * HEAD * y, LENGTH - HEAD))]
    return np.vstack([disc, [(0, 0, 0), (0, 0, LENGTH)], wings])


ARROW = _arrow()


class Markers:
    """Marks of one world, of which all that does not change is laid out once. SI units."""

    def __init__(self, world: World) -> None:
        self._world = world
        bodies = world.model.bodies
        self._bodies: Integers = np.flatnonzero(bodies.solid)
        poses = np.tile(HERE, (bodies.count, 1))
        poses[:, :3] = bodies.center_b
        self._poses = poses
        half = bodies.half[self._bodies]
        corners = CORNERS[EDGES] * half[:, None]
        self._corners = [points.tobytes() for points in corners]
        diameters = 2.0 * np.linalg.norm(bodies.half, axis=1)
        solid = self._bodies.tolist()
        self._boxes = [self._mark("boxes", i, STRONG if bodies.movable[i] else THIN) for i in solid]
        self._balls = [Mark(bodies.names[i], "spheres", i, BALL, poses[i], (diameters[i],) * 3) for i in solid]
        self._trees: dict[int, tuple[Mark, bytes]] = {}
        self._grown: tuple[int, Octree] | None = None  # depth and octrees that these are of
        self._sectors = Mark("world", "sectors", 0, LINE_LIST, HERE, (PLAIN, 0.0, 0.0))
        self._contacts: dict[int, Mark] = {}

    def _mark(self, name: str, body: int, width: float) -> Mark:
        names = self._world.model.bodies.names
        return Mark(names[body], name, body, LINE_LIST, self._poses[body], (width, 0.0, 0.0))

    def message(self, time_ns: int, depth: int = debug_depth.DEFAULT) -> bytes:
        """A serialized visualization_msgs/MarkerArray of the last step; depth: of the octrees, 0 for their roots."""
        return marker_array(time_ns, self._marks(depth))

    def _marks(self, depth: int) -> Iterator[tuple[Mark, bytes, bytes]]:
        world, movable = self._world, self._world.model.bodies.movable
        contacts = world.contacts
        normal, pair = contacts.normal[contacts.manifold], contacts.pair[contacts.manifold]
        fixed = ~movable[pair]
        touching = np.zeros(len(movable), bool)
        touching[pair[~stands(normal, fixed)]] = True
        level = self._levels()
        table = np.array([LEVELS[level] for level in range(max(LEVELS) + 1)])
        shades = np.where(touching[:, None], TOUCHING, table[np.clip(level, 0, max(LEVELS))])
        own = level == SPHERE

        boxes = _colours(shades, np.where(movable | touching, 1.0, FAINT))
        for row, body in enumerate(self._bodies.tolist()):
            yield self._boxes[row], boxes[body].tobytes(), self._corners[row]
        balls = _colours(np.where(own[:, None], shades, LEVELS[SPHERE]), np.where(own, 3 * FAINT_BALL, FAINT_BALL))
        for row, body in enumerate(self._bodies.tolist()):
            if movable[body] or own[body]:
                yield self._balls[row], balls[body].tobytes(), b""
        trees = _colours(shades, np.full(len(shades), FAINT))
        for body in np.flatnonzero(touching | (movable & (level >= OCTREE))).tolist():
            if tree := self._tree(body, depth):
                yield tree[0], trees[body].tobytes(), tree[1]
        yield self._sectors, np.array(SECTOR, np.float32).tobytes(), self._sector_lines().tobytes()
        yield from self._arrows(pair, normal, fixed, contacts.arm)

    def _levels(self) -> Integers:
        """The level that each body asks for, (n,)."""
        default, own, _, _ = self._world.detection.levels.tables()
        return np.where(own[:, 0] == UNSET, default[0], own[:, 0])

    def _tree(self, body: int, depth: int) -> tuple[Mark, bytes] | None:
        """The nodes at the depth, and the leaves above it, of a body that has an octree."""
        forest = self._world.detection.forest
        if forest is None or forest[1][body] < 0:
            return None
        tree, roots = forest
        if self._grown is None or self._grown[0] != depth or self._grown[1] is not tree:
            self._trees, self._grown = {}, (depth, tree)
        if body not in self._trees:
            box = tree.box[_nodes(tree, int(roots[body]), depth)]
            points = box[:, None, :3] + CORNERS[EDGES] * box[:, None, 3:]
            self._trees[body] = self._mark("octrees", body, THIN), points.tobytes()
        return self._trees[body]

    def _sector_lines(self) -> Floats:
        """The sectors of the broad phase in which something stands that moves."""
        corner, edge = self._world.detection.sectors()
        return np.asarray(corner[:, None] + (CORNERS[EDGES] + 1) * edge[:, None, None] / 2)

    def _arrows(self, pair: Integers, normal: Floats, fixed: Booleans, arm: Floats
                ) -> Iterator[tuple[Mark, bytes, bytes]]:
        """Where bodies touch: an arrow along the normal, into the second of two that move, or the only one; in the
        frame of the first of them that moves."""
        side = fixed[:, 0].astype(int)
        rows = np.arange(len(side))
        body = pair[rows, side]
        axes = self._world.detection.axes[body]  # as the step started, as are the arms
        ahead = np.where(fixed[:, 1], -1.0, 1.0)[:, None] * normal
        middle = np.einsum("kij,kj->ki", axes, arm[rows, side])
        along = np.einsum("kij,kj->ki", axes, ahead)
        points = middle[:, None] + np.einsum("pj,kji->kpi", ARROW, _frames(along))
        order = np.argsort(body, kind="stable")
        bodies, first = np.unique(body[order], return_index=True)
        colour = np.array(CONTACT, np.float32).tobytes()
        for i, group in zip(bodies.tolist(), np.split(points[order], first[1:]), strict=False):
            if i not in self._contacts:
                self._contacts[i] = self._mark("contacts", i, BOLD)
            yield self._contacts[i], colour, group.tobytes()


def stands(normal: Floats, fixed: Booleans) -> Booleans:
    """Which contacts (k,) are of what stands on something static. normal: (k, 3); fixed: (k, 2) of a and b."""
    up = normal[:, 2]
    return np.asarray((fixed[:, 0] & (up > CARRIES)) | (fixed[:, 1] & (up < -CARRIES)))


def _colours(shades: Floats, opacity: Floats) -> NDArray[np.float32]:
    """Red, green, blue, alpha (n, 4)."""
    return np.column_stack([shades, opacity]).astype(np.float32)


def _frames(along: Floats) -> Floats:
    """Right-handed axes (k, 3, 3), one a row, the third of which is `along`, (k, 3)."""
    other = np.where(np.abs(along[:, :1]) < 0.7, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    first = np.cross(along, other)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(along, first), along], axis=1)


def _nodes(tree: Octree, root: int, depth: int) -> list[int]:
    nodes = [root]
    for _ in range(depth):
        below: list[int] = []
        for node in nodes:
            first, children = tree.link[node, :2]
            below += range(first, first + children) if children else [node]
        nodes = below
    return nodes
