"""A fleet: copies of one scene, run in blocks where the scene allows it, else as one World each."""

import numpy as np
from numpy.typing import ArrayLike

from drone_engine.fleet.block import advance, set_commands
from drone_engine.fleet.block_setup import BlockConstants, why_not_in_blocks
from drone_engine.fleet.layout import BLOCK_ROWS, LANES, STATE_ROWS
from drone_engine.fleet.state import FleetState
from drone_engine.flight.quadrotor import EXPECTED as OBSERVER
from drone_engine.flight.quadrotor import SPEED as ROTOR_SPEED
from drone_engine.flight.quadrotor import rotors_of
from drone_engine.scene.schema import Scene
from drone_engine.world import LIMIT, World


class Fleet:
    """Independent copies of a scene. Copy k equals, bit for bit, a World of the scene (with the seed `seeds[k]`) that
    gets the same commands.

    A single quadrotor that can touch nothing, with no effects but those of block_setup.IN_BLOCKS, runs in blocks: many
    copies at once. Any other scene runs as one World after the other. `in_blocks` tells which; `why_not` gives the
    reason.
    """

    def __init__(self, scene: Scene, copies: int, seeds: ArrayLike | None = None, drone: str = "") -> None:
        """seeds: (copies,) integers; by default the scene's seed and its successors. drone: the one that commands and
        `state` refer to; by default the first.

        Raises ValueError, SceneError and MeshError.
        """
        if copies < 1:
            raise ValueError(f"copies: expected at least 1, got {copies}")
        given = np.arange(copies) + scene.seed if seeds is None else np.asarray(seeds)
        if given.shape != (copies,) or not np.issubdtype(given.dtype, np.integer) or given.min() < 0:
            raise ValueError(f"seeds: expected {copies} integers of at least 0, got {str(seeds)[:60]}")
        first = World(scene)
        drones = [first.model.bodies.names[i] for i in first.model.drones.body]
        if drone not in (drones if drone else drones and [""]):
            raise ValueError(f"drone: no drone is called '{drone}'; there are {', '.join(drones) or 'none'}")
        self.scene, self.copies, self.dt, self.steps = scene, copies, first.dt, 0
        self.seeds = tuple(int(seed) for seed in given)
        self._name = drone or drones[0]
        self._drone = drones.index(self._name)
        self._body = int(first.model.drones.body[self._drone])
        quadrotors = first.model.drones.quadrotor
        self._quadrotor = int(quadrotors[: self._drone].sum()) if quadrotors[self._drone] else -1  # index, or -1
        self._rotors = rotors_of(first.model, self._drone)
        self.why_not = why_not_in_blocks(first)
        self.in_blocks = not self.why_not
        self._table = np.empty((STATE_ROWS, copies))
        self.state = FleetState.of(self._table)
        self.worlds: tuple[World, ...] = ()
        if self.in_blocks:
            self._constants = BlockConstants.of(first)
            self._block = np.zeros(BLOCK_ROWS * LANES)
        else:
            self.worlds = tuple(World(scene.model_copy(update={"seed": seed})) for seed in self.seeds)
        for k in range(copies):
            self._read(k, self.worlds[k] if self.worlds else first)
        self._start = self._table.copy()

    def run(self, steps: int, commands: ArrayLike | None = None) -> None:
        """Runs this many steps. commands: (n, 4), or (4,) for all, given before the first step; None: no new commands.

        A command is forward, left, up in m/s and yaw rate in rad/s. Raises ValueError for one that is not finite.
        """
        if commands is not None:
            given = np.ascontiguousarray(commands, np.float64)
            fits = given.shape in ((4,), (self.copies, 4))
            if not (fits and set_commands(self._table, given.reshape(-1, 4), LIMIT)):
                raise ValueError(f"commands: expected four finite numbers, or {self.copies} times four")
        if self.in_blocks:
            advance(self._table, self._block, *self._constants, steps)
        for k, world in enumerate(self.worlds):
            self._write(k, world)
            if commands is not None:
                world.command(self._name, tuple(self.state.command_b[k]))
            world.run(steps)
            self._read(k, world)
        self.steps += steps

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return self.steps * self.dt

    def reset(self) -> None:
        """Returns to the initial state."""
        for world in self.worlds:
            world.reset()
        self._table[:] = self._start
        self.steps = 0

    def world(self, k: int) -> World:
        """Copy k as a World in its present state: its own World if it has one, else a new, independent one."""
        if self.worlds:
            self._write(k, self.worlds[k])
            return self.worlds[k]
        world = World(self.scene.model_copy(update={"seed": self.seeds[k]}))
        world.state.step[0] = self.steps
        self._write(k, world)
        return world

    def _write(self, k: int, world: World) -> None:
        """Copies the drone of copy k into a World, and wakes it there if it has moved."""
        own, s, d, i = self.state, world.state, self._drone, self._body
        if world.sleep and not s.is_awake[i] and any(
            (there[i] != here[k]).any()
            for there, here in ((s.position_w, own.position_w), (s.orientation_w, own.orientation_w),
                                (s.velocity_w, own.velocity_w), (s.angular_velocity_w, own.angular_velocity_w))
        ):
            world.sleep.wake(np.array([i]))
        s.position_w[i], s.orientation_w[i] = own.position_w[k], own.orientation_w[k]
        s.velocity_w[i], s.angular_velocity_w[i] = own.velocity_w[k], own.angular_velocity_w[k]
        s.command_b[d], s.hold_w[d], s.silence[d] = own.command_b[k], own.hold_w[k], own.silence[k]
        if self._quadrotor >= 0:
            s.memory[ROTOR_SPEED][self._quadrotor] = own.rotor_speed[k]
            s.memory[OBSERVER][self._quadrotor] = own.expected_velocity_and_push[k]
        if self._rotors[0] >= 0:
            s.rotor_angle[self._rotors] = own.rotor_angle[k]

    def _read(self, k: int, world: World) -> None:
        """Copies the drone of a World into copy k."""
        own, s, d, i = self.state, world.state, self._drone, self._body
        own.position_w[k], own.orientation_w[k] = s.position_w[i], s.orientation_w[i]
        own.velocity_w[k], own.angular_velocity_w[k] = s.velocity_w[i], s.angular_velocity_w[i]
        own.command_b[k], own.hold_w[k], own.silence[k] = s.command_b[d], s.hold_w[d], s.silence[d]
        if self._quadrotor >= 0:
            own.rotor_speed[k] = s.memory[ROTOR_SPEED][self._quadrotor]
            own.expected_velocity_and_push[k] = s.memory[OBSERVER][self._quadrotor]
        else:
            own.rotor_speed[k], own.expected_velocity_and_push[k] = 0.0, np.nan
        own.rotor_angle[k] = s.rotor_angle[self._rotors] if self._rotors[0] >= 0 else 0.0
