"""Everything that changes while a scene runs, as arrays; a run is repeated by repeating these."""

import hashlib
from dataclasses import dataclass, field, fields
from typing import Self

import numpy as np

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.model import Model


@dataclass
class State:
    """n bodies, d drones, r rotors. Bodies that do not move keep their start and zero velocity."""

    position_w: Floats  # (n, 3) m, centres of the boxes
    orientation_w: Floats  # (n, 4) x y z w
    velocity_w: Floats  # (n, 3) m/s
    angular_velocity_w: Floats  # (n, 3) rad/s
    command_b: Floats  # (d, 4) m/s, m/s, m/s, rad/s: the last one given
    silence: Integers  # (d,) steps since a command was given
    hold_w: Floats  # (d, 3) m, where a drone without commands stays; NaN while it is not there yet
    landed: Integers  # (d,) 1 while its rotors are off
    rotor_angle: Floats  # (r,) rad
    rotor_rate: Floats  # (r,) rad/s
    awake: Integers  # (n + 1,) how many bodies move and are not asleep, and which, ascending
    still: Floats  # (n,) s for which a body has hardly moved
    step: Integers  # (1,) steps since the start
    memory: dict[str, Floats] = field(default_factory=dict)  # what effects keep from step to step, by their names

    @classmethod
    def of(cls, model: Model) -> Self:
        """The state at the start: drones in the air hover, as if they had just been told to stop."""
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
        """Which bodies move and are not asleep, (n,)."""
        mask: Booleans = np.zeros(len(self.awake) - 1, np.bool_)
        mask[self.awake[1 : 1 + self.awake[0]]] = True
        return mask

    def remember(self, name: str, start: Floats) -> Floats:
        """Keeps an array as part of the state, with these numbers at the start."""
        return self.memory.setdefault(name, start)

    def arrays(self) -> dict[str, Floats | Integers]:
        """Everything that changes, by name."""
        own = {field.name: getattr(self, field.name) for field in fields(self) if field.name != "memory"}
        return own | {f"memory.{name}": array for name, array in self.memory.items()}

    def assign(self, other: Self) -> None:
        """Takes over all numbers of another state of the same model, into the same arrays."""
        for mine, others in zip(self.arrays().values(), other.arrays().values(), strict=True):
            mine[...] = others

    def copy(self) -> Self:
        own = {field.name: getattr(self, field.name).copy() for field in fields(self) if field.name != "memory"}
        return type(self)(**own, memory={name: array.copy() for name, array in self.memory.items()})

    def hash(self) -> str:
        """SHA-256 over all numbers, bit for bit, hexadecimal."""
        digest = hashlib.sha256()
        for array in self.arrays().values():
            digest.update(np.ascontiguousarray(array).data)
        return digest.hexdigest()


def _all_awake(model: Model) -> Integers:
    which = np.flatnonzero(model.bodies.movable)
    awake = np.zeros(model.bodies.count + 1, np.int64)
    awake[0], awake[1 : 1 + len(which)] = len(which), which
    return awake
