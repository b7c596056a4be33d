"""Everything that changes while a scene runs, as arrays; a run is repeated by repeating these."""

import hashlib
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.model import Model


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
    step: Integers  # (1,) steps since the start

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
            step=np.zeros(1, np.int64),
        )

    def assign(self, other: Self) -> None:
        """Takes over all numbers of another state of the same model, into the same arrays."""
        for field in fields(self):
            getattr(self, field.name)[...] = getattr(other, field.name)

    def copy(self) -> Self:
        return type(self)(**{field.name: getattr(self, field.name).copy() for field in fields(self)})

    def hash(self) -> str:
        """SHA-256 over all numbers, bit for bit, hexadecimal."""
        digest = hashlib.sha256()
        for field in fields(self):
            digest.update(np.ascontiguousarray(getattr(self, field.name)).data)
        return digest.hexdigest()
