"""The same scene of boxes in this project's World, in MuJoCo and in PyBullet, behind one protocol."""

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

MEMORY = 4 << 30  # bytes for MuJoCo's contacts
STIFFNESS = 0.5  # frequency of MuJoCo's contacts with restitution, rad per step


@dataclass(frozen=True)
class BoxScene:
    """Boxes to simulate, the movable ones first.

    floor: height in m of a floor with that friction and restitution, None for no floor; velocity_w, angular_velocity_w:
    initial velocities (k, 3) of the k movable boxes, None for rest.
    """

    boxes: Mapping[str, Box]
    floor: float | None = None
    friction: float = 0.6
    restitution: float = 0.0
    velocity_w: Floats | None = None
    angular_velocity_w: Floats | None = None

    @property
    def movable(self) -> list[Box]:
        """The boxes with a mass."""
        return [box for box in self.boxes.values() if box.mass]

    @property
    def static(self) -> list[Box]:
        """The boxes without a mass."""
        return [box for box in self.boxes.values() if not box.mass]


class Engine(Protocol):
    """A scene of boxes in a library. Results are those of the last step; arrays have a row for each movable box."""

    name: str

    def reset(self) -> None:
        """Restores the initial state."""
    def run(self, steps: int) -> None:
        """Runs `steps` steps."""
    def positions(self) -> Floats:
        """Centers in the world, (k, 3) m."""
    def orientations(self) -> Floats:
        """Orientations in the world, (k, 4) as x, y, z, w."""
    def deepest(self) -> float:
        """Deepest penetration, m."""
    def energy(self) -> float:
        """Kinetic and potential energy, J."""
    def fastest(self) -> float:
        """Highest speed of a center, m/s."""
    def close(self) -> None:
        """Releases the engine's resources."""


class Ours:
    """A World."""

    name = "ours"

    def __init__(self, scene: BoxScene, setting: Setting) -> None:
        self.world = world_of(scene.boxes, setting, floor=scene.floor, friction=scene.friction,
                              restitution=scene.restitution)
        self._scene, self._count = scene, len(scene.movable)
        self.reset()

    def reset(self) -> None:
        self.world.reset()
        if self._scene.velocity_w is not None:
            self.world.state.velocity_w[: self._count] = self._scene.velocity_w
        if self._scene.angular_velocity_w is not None:
            self.world.state.angular_velocity_w[: self._count] = self._scene.angular_velocity_w

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
        """Nothing to release."""


class MuJoCo:
    """solver: NEWTON, the default of MuJoCo, or CG; integrator: EULER, its default, RK4 or IMPLICITFAST."""

    def __init__(self, scene: BoxScene, rate: float, solver: str = "NEWTON", integrator: str = "EULER",
                 sleep: bool = False) -> None:
        self.name = f"MuJoCo {solver}{' with sleep' if sleep else ''}"
        self._scene = scene
        spec = mujoco.MjSpec()
        spec.memory = MEMORY
        spec.option.timestep, spec.option.gravity = 1.0 / rate, [0.0, 0.0, -G]
        spec.option.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver}")
        spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}")
        if sleep:
            spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        if scene.floor is not None:
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], pos=[0, 0, scene.floor],
                                    **_surface(scene.friction, scene.restitution, rate))
        for box in scene.boxes.values():
            pose = {"pos": box.pose[:3], "quat": np.roll(from_rpy(*(*box.pose[3:], 0.0, 0.0, 0.0)[:3]), 1)}
            geom = {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": np.array(box.size) / 2,
                    **_surface(box.friction, box.restitution, rate)}
            if box.mass:
                body = spec.worldbody.add_body(**pose)
                body.add_freejoint()
                body.add_geom(mass=box.mass, **geom)
            else:
                spec.worldbody.add_geom(**pose, **geom)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self.reset()

    def reset(self) -> None:
        mujoco.mj_resetData(self._model, self._data)
        velocities = self._data.qvel.reshape(-1, 6)
        if self._scene.velocity_w is not None:
            velocities[:, :3] = self._scene.velocity_w
        if self._scene.angular_velocity_w is not None:
            velocities[:, 3:] = rotate_all(inverse(self.orientations()), self._scene.angular_velocity_w)

    def run(self, steps: int) -> None:
        mujoco.mj_step(self._model, self._data, steps)

    def set_solver(self, solver: str) -> None:
        """Changes the solver: NEWTON or CG."""
        self._model.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver}")

    def positions(self) -> Floats:
        return np.array(self._data.qpos.reshape(-1, 7)[:, :3])

    def orientations(self) -> Floats:
        return np.roll(self._data.qpos.reshape(-1, 7)[:, 3:], -1, axis=1)

    def deepest(self) -> float:
        return max(0.0, -float(self._data.contact.dist[: self._data.ncon].min(initial=0.0)))

    def energy(self) -> float:
        velocities = self._data.qvel.reshape(-1, 6)  # angular velocities are in the frames of the boxes
        return energy_of(self._scene, self.positions(), velocities[:, :3], velocities[:, 3:])

    def fastest(self) -> float:
        return float(np.linalg.norm(self._data.qvel.reshape(-1, 6)[:, :3], axis=1).max())

    def close(self) -> None:
        """Nothing to release."""


def _surface(friction: float, restitution: float, rate: float) -> dict[str, list[float]]:
    """Friction, of which MuJoCo uses the maximum of a pair, and the contact spring for restitution.

    The damping of the spring follows from the restitution after Nagurka and Huang (2004).
    """
    keys = {"friction": [friction, 0.005, 0.0001]}
    if restitution > 0.0:
        frequency, loss = STIFFNESS * rate, -math.log(restitution)
        keys["solref"] = [-frequency**2, -2.0 * frequency * loss / math.hypot(math.pi, loss)]
    return keys


class PyBullet:
    """Free boxes in maximal coordinates, the faster of PyBullet's two representations, without damping."""

    name = "PyBullet"

    def __init__(self, scene: BoxScene, rate: float) -> None:
        self._scene = scene
        self._client = {"physicsClientId": pybullet.connect(pybullet.DIRECT)}
        pybullet.setGravity(0, 0, -G, **self._client)
        pybullet.setTimeStep(1.0 / rate, **self._client)
        if scene.floor is not None:
            plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, **self._client)
            self._add(0.0, plane, (0.0, 0.0, scene.floor), scene.friction, scene.restitution)
        self._bodies = []
        for box in scene.boxes.values():
            half = [side / 2 for side in box.size]
            shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half, **self._client)
            body = self._add(box.mass or 0.0, shape, box.pose, box.friction, box.restitution)
            if box.mass:
                self._bodies.append(body)
        self._start = pybullet.saveState(**self._client)
        self.reset()

    def _add(self, mass: float, shape: int, pose: tuple[float, ...], friction: float, restitution: float) -> int:
        """Adds a body and returns its number."""
        orientation = from_rpy(*(*pose[3:], 0.0, 0.0, 0.0)[:3])
        body = pybullet.createMultiBody(mass, shape, basePosition=list(pose[:3]), baseOrientation=list(orientation),
                                        useMaximalCoordinates=mass > 0.0, **self._client)
        pybullet.changeDynamics(body, -1, lateralFriction=math.sqrt(friction),  # PyBullet uses the product of a pair
                                restitution=restitution, linearDamping=0.0, angularDamping=0.0, **self._client)
        return int(body)

    def reset(self) -> None:
        pybullet.restoreState(self._start, **self._client)
        zero = np.zeros((len(self._bodies), 3))
        velocity, angular = (zero if given is None else given
                             for given in (self._scene.velocity_w, self._scene.angular_velocity_w))
        for body, v, w in zip(self._bodies, velocity.tolist(), angular.tolist(), strict=True):
            pybullet.resetBaseVelocity(body, v, w, **self._client)

    def run(self, steps: int) -> None:
        client, step = self._client, pybullet.stepSimulation
        for _ in range(steps):
            step(**client)

    def positions(self) -> Floats:
        return np.array([pybullet.getBasePositionAndOrientation(body, **self._client)[0] for body in self._bodies])

    def orientations(self) -> Floats:
        return np.array([pybullet.getBasePositionAndOrientation(body, **self._client)[1] for body in self._bodies])

    def deepest(self) -> float:
        return max([0.0, *(-float(point[8]) for point in pybullet.getContactPoints(**self._client))])

    def energy(self) -> float:
        velocity, angular = self._velocities()
        return energy_of(self._scene, self.positions(), velocity, rotate_all(inverse(self.orientations()), angular))

    def fastest(self) -> float:
        return float(np.linalg.norm(self._velocities()[0], axis=1).max())

    def _velocities(self) -> Floats:
        """Linear and angular velocities, (2, k, 3)."""
        found = np.array([pybullet.getBaseVelocity(body, **self._client) for body in self._bodies])
        return np.asarray(found.transpose(1, 0, 2))

    def close(self) -> None:
        pybullet.disconnect(**self._client)


def energy_of(scene: BoxScene, position: Floats, velocity: Floats, angular_b: Floats) -> float:
    """Kinetic and potential energy in J; angular_b: angular velocities (k, 3) in the frames of the boxes."""
    mass = np.array([box.mass for box in scene.movable])
    squares = np.array([box.size for box in scene.movable]) ** 2
    inertia = mass[:, None] / 12 * (squares.sum(1, keepdims=True) - squares)
    potential, linear = mass * G * position[:, 2], 0.5 * mass * (velocity**2).sum(1)
    return float((potential + linear + 0.5 * (inertia * angular_b**2).sum(1)).sum())
