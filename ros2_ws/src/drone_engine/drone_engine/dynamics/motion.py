"""The stage that moves all bodies by one step, and its buffers."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from drone_engine.arrays import Booleans, Floats, Integers
from drone_engine.context import Context
from drone_engine.dynamics.constraint import GATHERED
from drone_engine.dynamics.contact_constraints import COLOURS, tables
from drone_engine.dynamics.contact_solver import PRESSED, ROW
from drone_engine.dynamics.schemes import SCHEMES
from drone_engine.program.program import Compiled, Program
from drone_engine.program.stage import Stage


class SolverArrays(NamedTuple):
    """Buffers of the motion of n bodies with m manifolds in g groups."""

    radius: Floats  # (n,) m, of the bounding spheres
    free: Integers  # (n + 1,) number and indices of bodies without contacts
    held: Integers  # (n + 1,) the same of bodies in contact
    mark: Booleans  # (n,) scratch
    start: Floats  # (n, 7) poses at the beginning of the step
    tensor: Floats  # (n, 6) inverse inertia tensors in the world: xx xy xz yy yz zz
    moving: Floats  # (n + 1, ROW) velocities and displacements of bodies in contact; the last row is nobody's
    gathered: Floats  # (GATHERED,) scratch
    hurried: Booleans  # (n,) whether a body is above the speed threshold of soft contacts
    used: Integers  # (n, 2) scratch
    colours: Integers  # (m, 2)
    size: Integers  # (2, COLOURS) scratch
    unit: Integers  # (g, LANES)
    body: NDArray[np.int64]  # (g, 2, LANES)
    table: Floats  # (g, FIELDS * LANES)
    trial: Floats  # (n, 26) scratch of the integrators


class Motion:
    """The stage and its buffers."""

    def __init__(self, scheme: str, context: Context, force_program: Program, substep_program: Program,
                 iterations: int) -> None:
        """scheme: one of SCHEMES; iterations: of the contact solver in a sub-step, at most."""
        n = context.model.bodies.count
        self._force_program, self._substep_program = force_program, substep_program
        self.forces = context.forces
        free, held = np.zeros((2, n + 1), np.int64)
        start, tensor, trial = (np.zeros((n, width)) for width in (7, 6, 26))
        moving = np.zeros((n + 1, ROW))
        moving[:, PRESSED - 1] = 0.5
        mark, hurried = np.zeros((2, n), np.bool_)
        unit, body, table = tables(32)
        self.solver = SolverArrays(
            np.linalg.norm(context.model.bodies.half, axis=1), free, held, mark, start, tensor, moving,
            np.zeros(GATHERED), hurried, np.zeros((n, 2), np.int64), np.empty((64, 2), np.int64),
            np.empty((2, COLOURS), np.int64), unit, body, table, trial)
        scope = context.scope.child(self, "force_program", "substep_program", "forces", "solver")
        self.stage = Stage("motion", SCHEMES[scheme], scope,
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
            self.solver = self.solver._replace(colours=np.empty((2 * code, 2), np.int64))
        else:
            unit, body, table = tables(-2 * code)
            self.solver = self.solver._replace(unit=unit, body=body, table=table)
        self._program.bind(self.stage)
        return self.stage
