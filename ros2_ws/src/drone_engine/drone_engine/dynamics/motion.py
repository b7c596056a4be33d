"""The stage that moves all bodies by one step, and its buffers."""

import numpy as np

from drone_engine.context import Context
from drone_engine.dynamics.contact_motion import MotionBuffers
from drone_engine.dynamics.contact_table import SolverArrays
from drone_engine.dynamics.grouping import COLORS
from drone_engine.dynamics.integrators import TRIAL_FIELDS, BodyStates
from drone_engine.dynamics.step import INTEGRATORS
from drone_engine.program.program import Compiled, Program
from drone_engine.program.stage import Stage


class Motion:
    """The stage and its buffers, which grow with the number of contacts."""

    def __init__(self, integrator: str, context: Context, force_program: Program, substep_program: Program,
                 iterations: int) -> None:
        """integrator: one of INTEGRATORS; iterations: of the contact solver per sub-step, at most."""
        n, state = context.model.bodies.count, context.state
        self._force_program, self._substep_program = force_program, substep_program
        self.forces = context.forces
        self.states = BodyStates(state.position_w, state.orientation_w, state.velocity_w, state.angular_velocity_w)
        self.solver = SolverArrays.allocate(n, groups=32)
        self.buffers = MotionBuffers(
            radius=np.linalg.norm(context.model.bodies.half, axis=1),
            unconstrained=np.zeros(n + 1, np.int64), in_contact=np.zeros(n + 1, np.int64),
            has_contact=np.zeros(n, np.bool_), fast=np.zeros(n, np.bool_), start=np.zeros((n, 7)),
            inverse_inertia=np.zeros((n, 6)), used_colors=np.zeros((n, 2), np.int64),
            color=np.empty((64, 2), np.int64), color_size=np.empty((2, COLORS), np.int64),
            trial=np.zeros((n, TRIAL_FIELDS)))
        scope = context.scope.child(self, "force_program", "substep_program", "states", "forces", "solver", "buffers")
        self.stage = Stage("motion", INTEGRATORS[integrator], scope,
                           {"substeps": context.substeps, "iterations": iterations}, self._grow)

    @property
    def force_program(self) -> Compiled | Program:
        """The stages that evaluate forces."""
        return self._force_program.argument

    @property
    def substep_program(self) -> Compiled | Program:
        """The stages at the beginning of a sub-step."""
        return self._substep_program.argument

    def belong_to(self, program: Program) -> None:
        """Sets the program to bind again when buffers grow."""
        self._program = program

    def _grow(self, code: int) -> Stage:
        """Grows the buffer that was too small, for `code` manifolds or for -`code` groups, and repeats the stage."""
        if code > 0:
            self.buffers = self.buffers._replace(color=np.empty((2 * code, 2), np.int64))
        else:
            self.solver = self.solver.with_groups(-2 * code)
        self._program.bind(self.stage)
        return self.stage
