"""What the collision detection sees, as lines for RViz and Foxglove: boxes, grid sectors, contacts."""

import numpy as np

from drone_sim import layouts
from drone_sim.arrays import Floats
from drone_sim.collision.detection import Detection
from drone_sim.world import World

FREE, TOUCHING = (0.2, 0.8, 0.3, 1.0), (1.0, 0.2, 0.1, 1.0)
SECTOR, CONTACT = (0.3, 0.5, 1.0, 0.4), (1.0, 0.9, 0.1, 1.0)
NORMAL_LENGTH = 0.3  # m

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
EDGES = np.array([(i, j) for i in range(8) for j in range(i + 1, 8) if abs(CORNERS[i] - CORNERS[j]).sum() == 2]).ravel()


def markers(world: World, time_ns: int) -> bytes:
    """A serialized visualization_msgs/MarkerArray of the last step, in the world frame."""
    detection = world.detection
    lines = {"boxes": _boxes(world), "sectors": _sectors(detection), "contacts": _contacts(detection)}
    message = layouts.line_markers("world", ((name, len(points)) for name, (points, _) in lines.items()))
    message.stamp(time_ns)
    for name, (points, colours) in lines.items():
        if len(points):
            message.write(f"{name}/points", points.ravel())
            message.write(f"{name}/colours", colours.ravel())
    return bytes(message)


def _wire(centre: Floats, axes: Floats, half: Floats) -> Floats:
    """Ends (24 n, 3) of the edges of n boxes; axes (n, 3, 3), one a row."""
    corners = centre[:, None] + (CORNERS * half[:, None]) @ axes
    return np.asarray(corners[:, EDGES].reshape(-1, 3))


def _boxes(world: World) -> tuple[Floats, Floats]:
    bodies, detection = world.model.bodies, world.detection
    touching = np.zeros(bodies.count, bool)
    touching[[body for event in world.events if event.phase != event.phase.END for body in (event.a, event.b)]] = True
    shown = bodies.solid
    points = _wire(world.state.position_w[shown], detection.axes[shown], bodies.half[shown])
    return points, np.repeat(np.where(touching[shown, None], TOUCHING, FREE), 24, axis=0)


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
