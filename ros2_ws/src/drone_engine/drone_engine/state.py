"""All arrays that change while a scene runs. Equal states with equal commands continue equally, bit for bit."""

import hashlib
from dataclasses import dataclass, field, fields
from typing import Self

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.model import Model


@dataclass
class State:
    """State of n bodies, d drones and r rotors. Static bodies keep their start pose and zero velocity."""

    position_w: Floats  # (n, 3) m, centers of the bounding boxes
    orientation_w: Floats  # (n, 4) unit quaternions x y z w
    velocity_w: Floats  # (n, 3) m/s
    angular_velocity_w: Floats  # (n, 3) rad/s
    command_b: Floats  # (d, 4) latest command: forward, left, up in m/s, yaw rate in rad/s
    silence: Integers  # (d,) steps since the latest command
    hold_w: Floats  # (d, 3) m, where a drone without commands hovers; NaN until it has stopped
    landed: Integers  # (d,) 1 while landed, with the rotors off
    rotor_angle: Floats  # (r,) rad
    rotor_rate: Floats  # (r,) rad/s
    awake: Integers  # (n + 1,) number of awake moving bodies, then their indices, ascending
    still: Floats  # (n,) s since a body last moved noticeably
    step: Integers  # (1,) steps taken
    memory: dict[str, Floats] = field(default_factory=dict)  # state of effects and flight models, by name

    @classmethod
    def of(cls, model: Model) -> Self:
        """The state at the start: drones in the air hover, as if they had just been commanded to stop."""
        n, d, r = model.bodies.count, len(model.drones.body), len(model.rotors.names)
        return cls(
            position_w=model.bodies.start_w[:, :3].copy(),
            orientation_w=model.bodies.start_w[:, 3:].copy(),
            velocity_w=np.zeros((n, 3)),
            angular_velocity_w=np.zeros((n, 3)),
            command_b=np.zeros((d, 4)),
            silence=np.full(d, 1 << 40),
            hold_w=np.full((d, 3), np.nan),
            landed=np.zeros(d, np.int64),
            rotor_angle=np.zeros(r),
            rotor_rate=model.rotors.rate.copy(),
            awake=_all_awake(model),
            still=np.zeros(n),
            step=np.zeros(1, np.int64),
        )

    @property
    def is_awake(self) -> Booleans:
        """Mask (n,) of the moving bodies that are not asleep."""
        mask: Booleans = np.zeros(len(self.awake) - 1, np.bool_)
        mask[self.awake[1 : 1 + self.awake[0]]] = True
        return mask

    def remember(self, name: str, start: Floats) -> Floats:
        """Adds an array of an effect to the state, with its start values; returns the one in the state."""
        return self.memory.setdefault(name, start)

    def arrays(self) -> dict[str, Floats | Integers]:
        """All arrays, by name."""
        own = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "memory"}
        return own | {f"memory.{name}": array for name, array in self.memory.items()}

    def assign(self, other: Self) -> None:
        """Copies all values of another state of the same model into the arrays of this one."""
        for mine, others in zip(self.arrays().values(), other.arrays().values(), strict=True):
            mine[...] = others

    def copy(self) -> Self:
        """A deep copy."""
        own = {field.name: getattr(self, field.name).copy() for field in fields(self) if field.name != "memory"}
        return type(self)(**own, memory={name: array.copy() for name, array in self.memory.items()})

    def hash(self) -> str:
        """SHA-256 over the bits of all arrays, in hexadecimal."""
        digest = hashlib.sha256()
        for array in self.arrays().values():
            digest.update(np.ascontiguousarray(array).data)
        return digest.hexdigest()


def _all_awake(model: Model) -> Integers:
    which = np.flatnonzero(model.bodies.movable)
    awake = np.zeros(model.bodies.count + 1, np.int64)
    awake[0], awake[1 : 1 + len(which)] = len(which), which
    return awake
