"""The same boxes in our World, in MuJoCo and in PyBullet, behind one set of methods."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import mujoco
import numpy as np
import pybullet

from drone_engine.arrays import Floats
from drone_engine.math.poses import inverse, rotate_all
from drone_engine.math.quaternion import from_rpy
from reference.box_world import Box, G, Setting, depth, energy, highest_speed, world_of

ROOM = 4 << 30  # bytes that MuJoCo may take for contacts
STIFFNESS = 0.5  # of MuJoCo's contacts that give speed back: their frequency in rad a step


@dataclass(frozen=True)
class Boxes:
    """What is simulated: those that move first. Velocities (k, 3) of those that move, at rest if None."""

    boxes: Mapping[str, Box]
    floor: float | None = None  # height, m
    friction: float = 0.6  # of the floor
    restitution: float = 0.0
    velocity_w: Floats | None = None
    angular_w: Floats | None = None

    @property
    def moving(self) -> list[Box]:
        return [box for box in self.boxes.values() if box.mass]

    @property
    def standing(self) -> list[Box]:
        return [box for box in self.boxes.values() if not box.mass]


class Engine(Protocol):
    """Boxes in a library. Numbers are of the last step, arrays of the boxes that move."""

    name: str

    def reset(self) -> None: ...
    def run(self, steps: int) -> None: ...
    def positions(self) -> Floats: ...
    def orientations(self) -> Floats: ...
    def deepest(self) -> float: ...
    def energy(self) -> float: ...
    def fastest(self) -> float: ...
    def close(self) -> None: ...


class Ours:
    """In a World."""

    name = "ours"

    def __init__(self, what: Boxes, setting: Setting) -> None:
        self.world = world_of(what.boxes, setting, floor=what.floor, friction=what.friction,
                              restitution=what.restitution)
        self._what, self._count = what, len(what.moving)
        self.reset()

    def reset(self) -> None:
        self.world.reset()
        if self._what.velocity_w is not None:
            self.world.state.velocity_w[: self._count] = self._what.velocity_w
        if self._what.angular_w is not None:
            self.world.state.angular_velocity_w[: self._count] = self._what.angular_w

    def run(self, steps: int) -> None:
        self.world.run(steps)

    def positions(self) -> Floats:
        return self.world.state.position_w[: self._count]

    def orientations(self) -> Floats:
        return self.world.state.orientation_w[: self._count]

    def deepest(self) -> float:
        return depth(self.world)

    def energy(self) -> float:
        return energy(self.world)

    def fastest(self) -> float:
        return highest_speed(self.world)

    def close(self) -> None:
        """Nothing to give back."""


class MuJoCo:
    """solver: NEWTON, its default, or CG. integrator: EULER, its default, RK4 or IMPLICITFAST."""

    def __init__(self, what: Boxes, rate: float, solver: str = "NEWTON", integrator: str = "EULER",
                 sleep: bool = False) -> None:
        self.name = f"MuJoCo {solver}{' with sleep' if sleep else ''}"
        self._what = what
        spec = mujoco.MjSpec()
        spec.memory = ROOM
        spec.option.timestep, spec.option.gravity = 1.0 / rate, [0.0, 0.0, -G]
        spec.option.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver}")
        spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}")
        if sleep:
            spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        if what.floor is not None:
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, what.floor],
                                    **_surface(what.friction, what.restitution, rate))
        for box in what.boxes.values():
            place = {"pos": box.pose[:3], "quat": np.roll(from_rpy(*(*box.pose[3:], 0.0, 0.0, 0.0)[:3]), 1)}
            look = {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": np.array(box.size) / 2,
                    **_surface(box.friction, box.restitution, rate)}
            if box.mass:
                body = spec.worldbody.add_body(**place)
                body.add_freejoint()
                body.add_geom(mass=box.mass, **look)
            else:
                spec.worldbody.add_geom(**place, **look)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self.reset()

    def reset(self) -> None:
        mujoco.mj_resetData(self._model, self._data)
        speeds = self._data.qvel.reshape(-1, 6)
        if self._what.velocity_w is not None:
            speeds[:, :3] = self._what.velocity_w
        if self._what.angular_w is not None:
            speeds[:, 3:] = rotate_all(inverse(self.orientations()), self._what.angular_w)

    def run(self, steps: int) -> None:
        mujoco.mj_step(self._model, self._data, steps)

    def set_solver(self, solver: str) -> None:
        self._model.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver}")

    def positions(self) -> Floats:
        return np.array(self._data.qpos.reshape(-1, 7)[:, :3])

    def orientations(self) -> Floats:
        return np.roll(self._data.qpos.reshape(-1, 7)[:, 3:], -1, axis=1)

    def deepest(self) -> float:
        return max(0.0, -float(self._data.contact.dist[: self._data.ncon].min(initial=0.0)))

    def energy(self) -> float:
        speeds = self._data.qvel.reshape(-1, 6)  # angular ones are in the boxes' own frames
        return energy_of(self._what, self.positions(), speeds[:, :3], speeds[:, 3:])

    def fastest(self) -> float:
        return float(np.linalg.norm(self._data.qvel.reshape(-1, 6)[:, :3], axis=1).max())

    def close(self) -> None:
        """Nothing to give back."""


def _surface(friction: float, restitution: float, rate: float) -> dict[str, list[float]]:
    """Friction, of a pair the greater; and a spring for contacts that give speed back (its damping from Nagurka)."""
    keys = {"friction": [friction, 0.005, 0.0001]}
    if restitution > 0.0:
        frequency, loss = STIFFNESS * rate, -math.log(restitution)
        keys["solref"] = [-frequency**2, -2.0 * frequency * loss / math.hypot(math.pi, loss)]
    return keys


class PyBullet:
    """Free boxes in maximal coordinates, which is the faster of its two ways, without damping."""

    name = "PyBullet"

    def __init__(self, what: Boxes, rate: float) -> None:
        self._what = what
        self._at = {"physicsClientId": pybullet.connect(pybullet.DIRECT)}
        pybullet.setGravity(0, 0, -G, **self._at)
        pybullet.setTimeStep(1.0 / rate, **self._at)
        if what.floor is not None:
            plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, **self._at)
            self._add(0.0, plane, (0.0, 0.0, what.floor), what.friction, what.restitution)
        self._bodies = []
        for box in what.boxes.values():
            half = [side / 2 for side in box.size]
            shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, **self._at)
            body = self._add(box.mass or 0.0, shape, box.pose, box.friction, box.restitution)
            if box.mass:
                self._bodies.append(body)
        self._start = pybullet.saveState(**self._at)
        self.reset()

    def _add(self, mass: float, shape: int, pose: tuple[float, ...], friction: float, restitution: float) -> int:
        turn = from_rpy(*(*pose[3:], 0.0, 0.0, 0.0)[:3])
        body = pybullet.createMultiBody(mass, shape, basePosition=list(pose[:3]), baseOrientation=list(turn),
                                        useMaximalCoordinates=mass > 0.0, **self._at)
        pybullet.changeDynamics(body, -1, lateralFriction=math.sqrt(friction),  # of a pair the product
                                restitution=restitution, linearDamping=0.0, angularDamping=0.0, **self._at)
        return int(body)

    def reset(self) -> None:
        pybullet.restoreState(self._start, **self._at)
        still = np.zeros((len(self._bodies), 3))
        velocity, angular = (still if given is None else given
                             for given in (self._what.velocity_w, self._what.angular_w))
        for body, v, w in zip(self._bodies, velocity.tolist(), angular.tolist(), strict=True):
            pybullet.resetBaseVelocity(body, v, w, **self._at)

    def run(self, steps: int) -> None:
        at, step = self._at, pybullet.stepSimulation
        for _ in range(steps):
            step(**at)

    def positions(self) -> Floats:
        return np.array([pybullet.getBasePositionAndOrientation(body, **self._at)[0] for body in self._bodies])

    def orientations(self) -> Floats:
        return np.array([pybullet.getBasePositionAndOrientation(body, **self._at)[1] for body in self._bodies])

    def deepest(self) -> float:
        return max([0.0, *(-float(point[8]) for point in pybullet.getContactPoints(**self._at))])

    def energy(self) -> float:
        velocity, angular = self._velocities()
        return energy_of(self._what, self.positions(), velocity, rotate_all(inverse(self.orientations()), angular))

    def fastest(self) -> float:
        return float(np.linalg.norm(self._velocities()[0], axis=1).max())

    def _velocities(self) -> Floats:
        found = np.array([pybullet.getBaseVelocity(body, **self._at) for body in self._bodies])
        return np.asarray(found.transpose(1, 0, 2))

    def close(self) -> None:
        pybullet.disconnect(**self._at)


def energy_of(what: Boxes, position: Floats, velocity: Floats, angular_b: Floats) -> float:
    """Kinetic and potential, J; angular velocities in the boxes' own frames."""
    mass = np.array([box.mass for box in what.moving])
    squares = np.array([box.size for box in what.moving]) ** 2
    inertia = mass[:, None] / 12 * (squares.sum(1, keepdims=True) - squares)
    potential, moving = mass * G * position[:, 2], 0.5 * mass * (velocity**2).sum(1)
    return float((potential + moving + 0.5 * (inertia * angular_b**2).sum(1)).sum())
