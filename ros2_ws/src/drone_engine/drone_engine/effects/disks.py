"""Rotor disks: their positions on bodies, axes and radii."""

from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.geometry import mesh
from drone_engine.math.poses import compose, rotate_all
from drone_engine.model import Model


class Disks(NamedTuple):
    """r rotors' disks, in their bodies' frames."""

    body: Integers  # (r,) index of the body
    place_b: Floats  # (r, 3) m, from the center of mass
    axis_b: Floats  # (r, 3) unit, direction of thrust
    radius: Floats  # (r,) m


def disks(model: Model, radius: float | None = None) -> Disks:
    """The disks of all rotors. radius: m; default: from the bounds of their models. Raises MeshError."""
    rotors, bodies, fixed = model.rotors, model.bodies, model.fixed
    poses = rotors.pose_p.copy()
    for r, parent in enumerate(rotors.parents):
        while parent not in bodies.names:  # a rotor may be a child of a part of the drone
            part = fixed.names.index(parent)
            poses[r], parent = compose(fixed.pose_p[part], poses[r]), fixed.parents[part]
    body = model.drones.body[rotors.drone]
    sizes = {path: _radius(mesh.bounds(path)) for path in set(rotors.paths)} if radius is None else {}
    return Disks(body=body, place_b=poses[:, :3] - bodies.center_b[body],
                 axis_b=rotate_all(poses[:, 3:], np.array([0.0, 0.0, 1.0])),
                 radius=np.array([sizes.get(path, radius) for path in rotors.paths], np.float64))


def _radius(box: tuple[Floats, Floats]) -> float:
    """Radius (m) of a rotor about z, from the bounds of its model."""
    low, high = box
    return float(max(np.abs(low[:2]).max(), np.abs(high[:2]).max()))
