"""The heap in MuJoCo and in PyBullet, each with its own defaults but for friction, and without damping."""

import math

import mujoco
import numpy as np
import pybullet
from box_world import G
from heap import FRICTION, RATE, STATIC, Heap

from drone_sim.arrays import Floats
from drone_sim.rotation import inverse, rotate_all

ROOM = 4 << 30  # bytes that MuJoCo may take for contacts


class MuJoCo:
    """solver: NEWTON, which is its default, or CG."""

    def __init__(self, heap: Heap, solver: str = "NEWTON", sleep: bool = False) -> None:
        self.name = f"MuJoCo {solver}{' with sleep' if sleep else ''}"
        self._heap = heap
        spec = mujoco.MjSpec()
        spec.memory = ROOM
        spec.option.timestep, spec.option.gravity = 1.0 / RATE, [0.0, 0.0, -G]
        spec.option.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver}")
        if sleep:
            spec.option.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP
        box, rough = mujoco.mjtGeom.mjGEOM_BOX, [FRICTION, 0.005, 0.0001]
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], friction=rough)
        for half, place, yaw in zip(heap.static_half, heap.static_position, heap.static_yaw, strict=True):
            spec.worldbody.add_geom(type=box, size=half, pos=place, friction=rough,
                                    quat=[math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)])
        for half, place, turn, mass in zip(heap.half, heap.position, heap.orientation, heap.mass, strict=True):
            body = spec.worldbody.add_body(pos=place, quat=np.roll(turn, 1))
            body.add_freejoint()
            body.add_geom(type=box, size=half, mass=mass, friction=rough)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)

    def reset(self) -> None:
        mujoco.mj_resetData(self._model, self._data)

    def run(self, steps: int) -> None:
        mujoco.mj_step(self._model, self._data, steps)

    def set_solver(self, solver: str) -> None:
        """Newton needs minutes to settle a thousand boxes, for which CG will do."""
        self._model.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver}")

    def deepest(self) -> float:
        return max(0.0, -float(self._data.contact.dist[: self._data.ncon].min(initial=0.0)))

    def energy(self) -> float:
        speeds = self._data.qvel.reshape(-1, 6)  # angular ones are in the boxes' own frames
        return self._heap.energy(self.positions(), speeds[:, :3], speeds[:, 3:])

    def fastest(self) -> float:
        return float(np.linalg.norm(self._data.qvel.reshape(-1, 6)[:, :3], axis=1).max())

    def positions(self) -> Floats:
        return np.asarray(self._data.qpos.reshape(-1, 7)[:, :3])

    def close(self) -> None:
        """Nothing to give back."""


class PyBullet:
    """Free boxes in maximal coordinates, which is the faster of its two ways."""

    name = "PyBullet"

    def __init__(self, heap: Heap) -> None:
        self._heap = heap
        self._client = client = pybullet.connect(pybullet.DIRECT)
        at = {"physicsClientId": client}
        pybullet.setGravity(0, 0, -G, **at)
        pybullet.setTimeStep(1.0 / RATE, **at)
        pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE, **at), **at)
        for half, place, yaw in zip(heap.static_half, heap.static_position, heap.static_yaw, strict=True):
            shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half.tolist(), **at)
            pybullet.createMultiBody(0, shape, basePosition=place.tolist(),
                                     baseOrientation=[0, 0, math.sin(yaw / 2), math.cos(yaw / 2)], **at)
        for half, place, turn, mass in zip(heap.half, heap.position, heap.orientation, heap.mass, strict=True):
            shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half.tolist(), **at)
            pybullet.createMultiBody(float(mass), shape, basePosition=place.tolist(), baseOrientation=turn.tolist(),
                                     useMaximalCoordinates=True, **at)
        own = math.sqrt(FRICTION)  # a pair's is the product
        for body in range(pybullet.getNumBodies(**at)):
            pybullet.changeDynamics(body, -1, lateralFriction=own, restitution=0.0, linearDamping=0.0,
                                    angularDamping=0.0, **at)
        self._bodies = range(1 + STATIC, 1 + STATIC + heap.count)
        self._start = pybullet.saveState(**at)

    def reset(self) -> None:
        pybullet.restoreState(self._start, physicsClientId=self._client)

    def run(self, steps: int) -> None:
        client, step = self._client, pybullet.stepSimulation
        for _ in range(steps):
            step(physicsClientId=client)

    def deepest(self) -> float:
        found = pybullet.getContactPoints(physicsClientId=self._client)
        return max([0.0, *(-float(point[8]) for point in found)])

    def energy(self) -> float:
        velocity, angular = np.array([pybullet.getBaseVelocity(b, physicsClientId=self._client) for b in self._bodies]
                                     ).transpose(1, 0, 2)
        turns = np.array([pybullet.getBasePositionAndOrientation(b, physicsClientId=self._client)[1]
                          for b in self._bodies])
        return self._heap.energy(self.positions(), velocity, rotate_all(inverse(turns), angular))

    def fastest(self) -> float:
        return max(float(np.linalg.norm(pybullet.getBaseVelocity(b, physicsClientId=self._client)[0]))
                   for b in self._bodies)

    def positions(self) -> Floats:
        return np.array([pybullet.getBasePositionAndOrientation(b, physicsClientId=self._client)[0]
                         for b in self._bodies])

    def close(self) -> None:
        pybullet.disconnect(physicsClientId=self._client)
