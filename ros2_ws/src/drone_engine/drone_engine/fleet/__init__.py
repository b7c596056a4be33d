"""Many copies of one scene at once, for Monte Carlo: other starts, other commands, other chance.

    fleet = Fleet(load("my_scene.yaml"), 1000)
    fleet.state.velocity_w[:] = random.normal(size=(1000, 3))
    fleet.run(240, commands=(1.0, 0.0, 0.0, 0.0))
    print(fleet.state.position_w.std(axis=0))
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from drone_engine import effects
from drone_engine.arrays import Floats
from drone_engine.effects.drag import Parameters as Drag
from drone_engine.effects.gravity import Parameters as Gravity
from drone_engine.effects.motor_lag import Parameters as MotorLag
from drone_engine.fleet.block import ANGLE, COMMAND, EXPECTED, HOLD, KEPT, LANES, ROWS, SILENT, SPEED, A, P, Q, V
from drone_engine.fleet.schemes import advance, left_over, tell
from drone_engine.flight.quadrotor import EXPECTED as VELOCITY_AND_PUSH
from drone_engine.flight.quadrotor import SPEED as ROTOR_SPEED
from drone_engine.flight.quadrotor import rotors_of, row_of
from drone_engine.scene.schema import Scene
from drone_engine.world import LIMIT, World

IN_BLOCKS = ("gravity", "drag", "motor_lag")  # effects that blocks know
SCHEMES = ("midpoint", "semi_implicit_euler")


class FleetState(NamedTuple):
    """The drone of each of n copies. Views: what is written here counts from the next step on."""

    position_w: Floats  # (n, 3) m, centres of the boxes
    orientation_w: Floats  # (n, 4) x y z w
    velocity_w: Floats  # (n, 3) m/s
    angular_velocity_w: Floats  # (n, 3) rad/s
    rotor_speed: Floats  # (n, 4) rad/s, of quadrotors
    rotor_angle: Floats  # (n, 4) rad, of quadrotors with four rotors in the scene
    command_b: Floats  # (n, 4) m/s, m/s, m/s, rad/s: the last one given
    silence: Floats  # (n,) steps since a command was given
    hold_w: Floats  # (n, 3) m, where a drone without commands stays; NaN while it is not there yet
    expected_velocity_and_push: Floats  # (n, 6) m/s and m/s^2, of quadrotors, as their loops have it; NaN: not yet


class Fleet:
    """Copies of a scene that know nothing of each other. Copy k stays equal, bit for bit, to a World of the scene (with
    seed `seeds[k]`) that gets the same commands.

    A single quadrotor that can touch nothing, with effects of IN_BLOCKS, flies in blocks of many copies at once; any
    other scene is so many Worlds, one after the other. `in_blocks` says which, and `why_not` why.
    """

    def __init__(self, scene: Scene, copies: int, seeds: ArrayLike | None = None, drone: str = "") -> None:
        """seeds: (copies,), else the scene's and those that follow it; drone: the one that is flown, else the first.

        Raises ValueError, and what World raises.
        """
        if copies < 1:
            raise ValueError(f"copies: expected at least 1, got {copies}")
        chance = np.arange(copies) + scene.seed if seeds is None else np.asarray(seeds)
        if chance.shape != (copies,) or not np.issubdtype(chance.dtype, np.integer) or chance.min() < 0:
            raise ValueError(f"seeds: expected {copies} whole numbers from 0 on")
        first = World(scene)
        drones = [first.model.bodies.names[i] for i in first.model.drones.body]
        if drone not in (drones if drone else drones and [""]):
            raise ValueError(f"drone: no drone is called '{drone}'; there are {', '.join(drones) or 'none'}")
        self.scene, self.copies, self.dt, self.steps = scene, copies, first.dt, 0
        self.seeds = tuple(int(seed) for seed in chance)
        self._name = drone or drones[0]
        self._drone = drones.index(self._name)
        self._body = int(first.model.drones.body[self._drone])
        flown = first.model.drones.quadrotor
        self._place = int(flown[: self._drone].sum()) if flown[self._drone] else -1  # among the quadrotors
        self._rotors = rotors_of(first.model, self._drone)
        self.why_not = _why_not(first)
        self.in_blocks = not self.why_not
        self._table = np.empty((KEPT, copies))
        self.worlds: tuple[World, ...] = ()
        if self.in_blocks:
            self._shared = _shared(first)
            self._block = np.zeros(ROWS * LANES)
        else:
            self.worlds = tuple(World(scene.model_copy(update={"seed": seed})) for seed in self.seeds)
        for k in range(copies):
            self._take(self.worlds[k] if self.worlds else first, k)
        self._start = self._table.copy()
        t = self._table
        self.state = FleetState(t[P : P + 3].T, t[Q : Q + 4].T, t[V : V + 3].T, t[A : A + 3].T, t[SPEED : SPEED + 4].T,
                                t[ANGLE : ANGLE + 4].T, t[COMMAND : COMMAND + 4].T, t[SILENT], t[HOLD : HOLD + 3].T,
                                t[EXPECTED : EXPECTED + 6].T)

    def run(self, steps: int, commands: ArrayLike | None = None) -> None:
        """Many steps. commands: (n, 4) or one for all (4,), given before the first; none: silence goes on.

        Raises ValueError for one that is not finite.
        """
        if commands is not None:
            wanted = np.ascontiguousarray(commands, np.float64)
            if wanted.shape not in ((4,), (self.copies, 4)) or not tell(self._table, wanted.reshape(-1, 4), LIMIT):
                raise ValueError(f"commands: expected four finite numbers, or {self.copies} times four")
        if self.in_blocks:
            advance(self._table, self._block, *self._shared, steps)
        for k, world in enumerate(self.worlds):
            self._give(k, world)
            if commands is not None:
                world.command(self._name, tuple(self.state.command_b[k]))
            world.run(steps)
            self._take(world, k)
        self.steps += steps

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return self.steps * self.dt

    def reset(self) -> None:
        """Back to the start, as if just made."""
        for world in self.worlds:
            world.reset()
        self._table[:] = self._start
        self.steps = 0

    def world(self, k: int) -> World:
        """Copy k as it is now, as a World: its own if it is one, else a new one that goes on alone."""
        if self.worlds:
            self._give(k, self.worlds[k])
            return self.worlds[k]
        world = World(self.scene.model_copy(update={"seed": self.seeds[k]}))
        world.state.step[0] = self.steps
        self._give(k, world)
        return world

    def _give(self, k: int, world: World) -> None:
        """Writes the drone of copy k into a World."""
        s, column, d, i = world.state, self._table[:, k], self._drone, self._body
        if world.sleep and not s.is_awake[i] and any(
            (there[i] != column[at : at + there.shape[1]]).any()
            for there, at in ((s.position_w, P), (s.orientation_w, Q), (s.velocity_w, V), (s.angular_velocity_w, A))
        ):
            world.sleep.wake(np.array([i]))
        s.position_w[i], s.orientation_w[i] = column[P : P + 3], column[Q : Q + 4]
        s.velocity_w[i], s.angular_velocity_w[i] = column[V : V + 3], column[A : A + 3]
        s.command_b[d], s.hold_w[d] = column[COMMAND : COMMAND + 4], column[HOLD : HOLD + 3]
        s.silence[d] = column[SILENT]
        if self._place >= 0:
            s.memory[ROTOR_SPEED][self._place] = column[SPEED : SPEED + 4]
            s.memory[VELOCITY_AND_PUSH][self._place] = column[EXPECTED : EXPECTED + 6]
        if self._rotors[0] >= 0:
            s.rotor_angle[self._rotors] = column[ANGLE : ANGLE + 4]

    def _take(self, world: World, k: int) -> None:
        """Reads it back."""
        s, column, d, i = world.state, self._table[:, k], self._drone, self._body
        column[P : P + 3], column[Q : Q + 4] = s.position_w[i], s.orientation_w[i]
        column[V : V + 3], column[A : A + 3] = s.velocity_w[i], s.angular_velocity_w[i]
        column[COMMAND : COMMAND + 4], column[HOLD : HOLD + 3] = s.command_b[d], s.hold_w[d]
        column[SILENT] = s.silence[d]
        flown = self._place >= 0
        column[SPEED : SPEED + 4] = s.memory[ROTOR_SPEED][self._place] if flown else 0.0
        column[EXPECTED : EXPECTED + 6] = s.memory[VELOCITY_AND_PUSH][self._place] if flown else np.nan
        column[ANGLE : ANGLE + 4] = s.rotor_angle[self._rotors] if self._rotors[0] >= 0 else 0.0


def _why_not(world: World) -> str:
    """Why copies of a scene cannot fly in blocks, or nothing if they can."""
    scene, model = world.scene, world.model
    if model.bodies.count != 1:
        others = [name for i, name in enumerate(model.bodies.names) if i not in model.drones.body]
        return f"there is more than one drone that touches nothing: {', '.join(others[:3]) or 'another drone'}"
    if not model.drones.quadrotor[0]:
        return "the flight model is not 'quadrotor'"
    if scene.dynamics.integrator not in SCHEMES:
        return f"the integrator is '{scene.dynamics.integrator}', not one of {', '.join(SCHEMES)}"
    other = [name for name in scene.effects if name not in IN_BLOCKS]
    return f"the scene has the effect '{other[0]}'" if other else ""


def _shared(world: World) -> tuple[Floats, Floats | None, float | None, bool | None, bool | None, bool | None, int]:
    """What `advance` takes of a scene: numbers, lag, drag, rotors, seen, second_order, substeps."""
    scene, bodies, drones = world.scene, world.model.bodies, world.model.drones
    active, substeps = effects.parameters(scene), scene.dynamics.substeps
    gravity, drag, slow = active.get("gravity"), active.get("drag"), active.get("motor_lag")
    h = world.dt / substeps
    row = row_of(world.model, 0, h, scene.path)
    number = np.array([*row, gravity.acceleration if isinstance(gravity, Gravity) else 0.0, h, world.dt,
                       bodies.inverse_mass[0], drones.max_speed[0], drones.max_yaw_rate[0], *bodies.half[0]])
    lag = None
    if isinstance(slow, MotorLag):
        lag = np.empty((substeps + 1, 2))
        left_over(h, substeps, slow.up, slow.down, lag)
    return (number, lag, 0.5 * drag.density * drag.coefficient if isinstance(drag, Drag) else None,
            True if row[6] else None, True if rotors_of(world.model, 0)[0] >= 0 else None,
            True if scene.dynamics.integrator == "midpoint" else None, substeps)
