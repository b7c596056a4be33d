"""The stage that moves all bodies by one step, and its buffers."""

from collections.abc import Callable
from typing import Any

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.collision.manifold import Manifolds
from drone_engine.dynamics.constraint import GATHERED
from drone_engine.dynamics.contact_constraints import COLOURS, tables
from drone_engine.dynamics.contact_solver import PRESSED, ROW
from drone_engine.dynamics.schemes import SCHEMES
from drone_engine.effects import Setting
from drone_engine.program.program import Program
from drone_engine.program.stage import Stage


class Motion:
    """The stage and its buffers."""

    def __init__(self, scheme: str, setting: Setting, acting: Program, steering: Program,
                 manifolds: Callable[[], Manifolds], passes: int) -> None:
        n = setting.model.bodies.count
        self._setting, self._acting, self._steering, self._manifolds = setting, acting, steering, manifolds
        self._kernel, self._passes, self._h = SCHEMES[scheme], passes, setting.dt / setting.substeps
        self._free, self._held = np.zeros((2, n + 1), np.int64)
        self._mark, self._hurried, self._used = *np.zeros((2, n), np.bool_), np.zeros((n, 2), np.int64)
        self._radius: Floats = np.linalg.norm(setting.model.bodies.half, axis=1)
        self._start, self._tensor, self._trial = (np.zeros((n, width)) for width in (7, 6, 26))
        self._moving, self._gathered = np.zeros((n + 1, ROW)), np.zeros(GATHERED)  # one row for nobody
        self._moving[:, PRESSED - 1] = 0.5
        self._size = np.empty((2, COLOURS), np.int64)
        self._colours = np.empty((64, 2), np.int64)
        self._tables = tables(32)

    @property
    def stage(self) -> Stage:
        return Stage("motion", self._kernel, self._arguments, self._grow)

    def belong_to(self, program: Program) -> None:
        """Tells which program to bind anew when arrays become others."""
        self._program = program

    def _grow(self, code: int) -> str:
        if code > 0:
            self._colours = np.empty((2 * code, 2), np.int64)
        else:
            self._tables = tables(-2 * code)
        self._program.bind("motion")
        return "motion"

    def _arguments(self) -> tuple[Any, ...]:
        s, bodies, forces, m = self._setting.state, self._setting.model.bodies, self._setting.forces, self._manifolds()
        acting, steering = self._acting, self._steering
        return (acting.function, acting.row, steering.function, steering.row, forces.clock, s.awake, m.end, m.pair,
                m.points, m.normal_w, m.anchor_w, m.separation, m.impulse, m.friction, m.total, s.position_w,
                s.orientation_w, s.velocity_w, s.angular_velocity_w, forces.force_w, forces.torque_w,
                forces.inverse_mass, forces.inertia_b, self._radius, bodies.friction, bodies.restitution, self._free,
                self._held, self._mark, self._start, self._tensor, self._moving, self._gathered, self._hurried,
                self._used, self._colours, self._size, *self._tables, self._trial, self._setting.substeps,
                self._passes, self._h)
