"""What the parts of a step are built from: the model, the state, shared arrays, and the names that kernels bind to."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.model import Model
from drone_engine.program.scope import Scope
from drone_engine.program.stage import Stage
from drone_engine.scene.fields import Strict
from drone_engine.state import State


class Forces(NamedTuple):
    """Forces on n bodies with r rotors at one instant of a step; effects and flight models share the arrays. World
    frame, SI units."""

    force: Floats  # (n, 3) N, at the centers of mass
    torque: Floats  # (n, 3) N m
    air_velocity: Floats  # (n, 3) m/s, velocity of the air around each body; (0, 3) where the air is at rest
    thrust: Floats  # (r,) N along the rotors' z axes, from the flight model, before effects change it
    time_in_step: Floats  # (1,) s since the step began
    inverse_mass: Floats  # (n,) 1/kg, with added mass; 0: does not move
    inertia: Floats  # (n, 3) kg m^2 about the axes of the box, with added mass

    @classmethod
    def none(cls, model: Model, moving_air: bool) -> "Forces":
        """No force yet; moving_air: whether any effect moves the air."""
        n = model.bodies.count
        force, torque = np.zeros((2, n, 3))
        return cls(force, torque, np.zeros((n if moving_air else 0, 3)), np.zeros(len(model.rotors.names)), np.zeros(1),
                   model.bodies.inverse_mass.copy(), model.bodies.inertia_b.copy())


@dataclass(frozen=True)
class Context:
    """Everything that effects, flight models, collision detection and dynamics are built from."""

    model: Model
    state: State
    forces: Forces
    dt: float  # s, of a step
    substeps: int  # of a step
    seed: int  # of the scene
    active: Mapping[str, Strict]  # parameters of the scene's effects, by name
    scope: Scope = field(default_factory=Scope)

    def __post_init__(self) -> None:
        """Shares the arrays that any kernel may take, each under one name. Kernels work in the world frame; n bodies,
        d drones, r rotors."""
        bodies, drones, rotors = self.model.bodies, self.model.drones, self.model.rotors
        self.scope.share(self, "dt", "h")
        self.scope.share(
            self.state, "silence", "landed", "rotor_angle", "rotor_rate", "awake", "still", "step",
            position="position_w", orientation="orientation_w", velocity="velocity_w",
            angular_velocity="angular_velocity_w", command="command_b", hold="hold_w")
        self.scope.share(bodies, "movable", "solid", "half", "mass", "friction", "restitution",
                         body_inertia="inertia_b")
        self.scope.share(drones, "max_speed", "max_acceleration", "max_yaw_rate", drone_body="body")
        self.scope.share(rotors, rotor_drone="drone", flight_rate="rate")
        self.scope.share(self.forces, *Forces._fields)

    @property
    def h(self) -> float:
        """Length of a sub-step, s; forces are evaluated at least once per sub-step."""
        return self.dt / self.substeps

    def stage(self, name: str, kernel: Any, /, handle: Callable[[int], Stage | None] = lambda code: None,
              **given: Any) -> Stage:
        """A stage whose kernel takes the shared arrays by their names, and `given` ones of its own."""
        return Stage(name, kernel, self.scope, given, handle)


class Stages(NamedTuple):
    """The stages that an effect or a flight model adds to a step."""

    step: tuple[Stage, ...] = ()  # once a step, before collision detection
    substep: tuple[Stage, ...] = ()  # at the beginning of every sub-step
    force: tuple[Stage, ...] = ()  # whenever forces are evaluated: at least once per sub-step, after `substep`
    idle: str = ""  # the reason, if there is nothing to do
