"""What the collision detection sees, as lines for RViz, Foxglove and the picture: balls, boxes, octrees, contacts.

Each kind is a marker of its own. What touches something is red; the rest has the colour of its collision level.
"""

import numpy as np

from drone_sim import layouts
from drone_sim.arrays import Booleans, Floats, Integers
from drone_sim.collision.detection import Detection
from drone_sim.collision.octree import Octree
from drone_sim.model import OBB, OCTREE, SPHERE, TRIANGLE, UNSAID
from drone_sim.world import World

LEVELS = {SPHERE: (0.2, 0.7, 1.0, 1.0), OBB: (0.2, 0.8, 0.3, 1.0), OCTREE: (0.8, 0.4, 1.0, 1.0),
          TRIANGLE: (0.9, 0.9, 0.9, 1.0)}
TOUCHING = (1.0, 0.2, 0.1, 1.0)
SECTOR, CONTACT = (0.3, 0.5, 1.0, 0.4), (1.0, 0.9, 0.1, 1.0)
NORMAL_LENGTH = 0.3  # m
DEPTH = 3  # of the octrees: what is deeper is not shown

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
EDGES = np.array([(i, j) for i in range(8) for j in range(i + 1, 8) if abs(CORNERS[i] - CORNERS[j]).sum() == 2]).ravel()
_ANGLE = 2 * np.pi * (np.arange(32)[:, None] + [0, 1]).ravel() / 32
CIRCLES = np.vstack([np.roll(np.column_stack([np.cos(_ANGLE), np.sin(_ANGLE), 0 * _ANGLE]), turn, axis=1)
                     for turn in range(3)])


def markers(world: World, time_ns: int) -> bytes:
    """A serialized visualization_msgs/MarkerArray of the last step, in the world frame."""
    bodies, detection = world.model.bodies, world.detection
    touching = np.zeros(bodies.count, bool)
    touching[[body for event in world.events if event.phase != event.phase.END for body in (event.a, event.b)]] = True
    colours = _colours(detection, touching)
    balls = np.flatnonzero(bodies.solid & (_levels(detection) == SPHERE))
    boxes = np.flatnonzero(bodies.solid & (_levels(detection) != SPHERE))
    near = np.flatnonzero(bodies.solid & (bodies.movable | touching))
    position = world.state.position_w
    lines = {
        "boxes": (_wire(position[boxes], detection.axes[boxes], bodies.half[boxes]),
                  np.repeat(colours[boxes], len(EDGES), axis=0)),
        "spheres": _balls(position[balls], np.linalg.norm(bodies.half[balls], axis=1), colours[balls]),
        "octrees": _octrees(detection, near, position, colours),
        "sectors": _sectors(detection),
        "contacts": _contacts(detection),
    }
    message = layouts.line_markers("world", ((name, len(points)) for name, (points, _) in lines.items()))
    message.stamp(time_ns)
    for name, (points, shades) in lines.items():
        if len(points):
            message.write(f"{name}/points", points.ravel())
            message.write(f"{name}/colours", shades.ravel())
    return bytes(message)


def _levels(detection: Detection) -> Integers:
    """The level that each body asks for, (n,)."""
    default, own, _, _ = detection.levels.tables()
    return np.where(own[:, 0] == UNSAID, default[0], own[:, 0])


def _colours(detection: Detection, touching: Booleans) -> Floats:
    """Of each body, (n, 4)."""
    table = np.array([LEVELS.get(level, LEVELS[OBB]) for level in range(max(LEVELS) + 1)])
    return np.where(touching[:, None], TOUCHING, table[np.clip(_levels(detection), 0, max(LEVELS))])


def _balls(centre: Floats, radius: Floats, colours: Floats) -> tuple[Floats, Floats]:
    """Three great circles of each of n balls."""
    points = centre[:, None] + CIRCLES * radius[:, None, None]
    return points.reshape(-1, 3), np.repeat(colours, len(CIRCLES), axis=0)


def _octrees(detection: Detection, bodies: Integers, position: Floats, colours: Floats) -> tuple[Floats, Floats]:
    """The nodes at DEPTH, and the leaves above it, of bodies that have octrees."""
    lines, shades = [np.empty((0, 3))], [np.empty((0, 4))]
    if detection.forest is not None:
        tree, roots = detection.forest
        for body in bodies[roots[bodies] >= 0]:
            box = tree.box[_nodes(tree, int(roots[body]))]
            axes = detection.axes[body]
            many = np.broadcast_to(axes, (len(box), 3, 3))
            lines.append(_wire(position[body] + box[:, :3] @ axes, many, box[:, 3:]))
            shades.append(np.tile(colours[body] * (1.0, 1.0, 1.0, 0.5), (len(lines[-1]), 1)))
    return np.vstack(lines), np.vstack(shades)


def _nodes(tree: Octree, root: int) -> list[int]:
    nodes = [root]
    for _ in range(DEPTH):
        below: list[int] = []
        for node in nodes:
            first, children = tree.link[node, :2]
            below += range(first, first + children) if children else [node]
        nodes = below
    return nodes


def _wire(centre: Floats, axes: Floats, half: Floats) -> Floats:
    """Ends (24 n, 3) of the edges of n boxes; axes (n, 3, 3), one a row."""
    corners = centre[:, None] + (CORNERS * half[:, None]) @ axes
    return np.asarray(corners[:, EDGES].reshape(-1, 3))


def _sectors(detection: Detection) -> tuple[Floats, Floats]:
    """The sectors of the broad phase in which something stands that moves."""
    corner, edge = detection.sectors()
    half = np.repeat(edge[:, None] / 2, 3, axis=1)
    points = _wire(corner + half, np.broadcast_to(np.eye(3), (len(corner), 3, 3)), half)
    return points, np.tile(SECTOR, (len(points), 1))


def _contacts(detection: Detection) -> tuple[Floats, Floats]:
    """Each contact point, with the normal from it."""
    found = detection.manifolds
    held = np.arange(found.point_w.shape[1]) < found.points[: found.count, None]
    start = found.point_w[: found.count][held]
    normal = np.repeat(found.normal_w[: found.count], found.points[: found.count], axis=0)
    points = np.stack([start, start + NORMAL_LENGTH * normal], axis=1).reshape(-1, 3)
    return points, np.tile(CONTACT, (len(points), 1))
