"""Curves of a work-precision diagram: error at the end and CPU time of an engine at decreasing step sizes."""

import statistics
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from time import process_time
from typing import Any, NamedTuple

from bench.accuracy.motion.problems import Problem, Quadrotor
from bench.dynamics.engines import BoxScene, Engine, MuJoCo, Ours, PyBullet
from reference.box_world import Setting
from reference.motion.cases import INTEGRATORS

RATES = (30.0, 60.0, 120.0, 240.0, 480.0, 960.0, 1920.0)  # Hz
QUICK_RATES = (60.0, 240.0, 960.0)
SUBSTEPS = (1, 2, 4, 8, 16, 32)  # at a rate of SUBSTEPPED
SUBSTEPPED = 60.0  # Hz
IN_CONTACT = 4  # sub-steps in problems with contacts when the rate varies
SPENT, LONG = 0.05, 0.5  # s of CPU time: minimum of all runs together; no further run after LONG
REPEATS = 3


class Line(NamedTuple):
    """One curve; make(scene, rate, substeps) creates the engine of each point."""

    name: str
    make: Callable[[Any, float, int], Engine]
    points: Sequence[tuple[float, int]]


def ours(scene: BoxScene, rate: float, substeps: int, integrator: str) -> Engine:
    """A World with these boxes."""
    return Ours(scene, Setting(rate, substeps, integrator))


def quadrotor(scene: Any, rate: float, substeps: int, integrator: str) -> Engine:
    """The quadrotor; it has no box scene."""
    return Quadrotor(Setting(rate, substeps, integrator))


def mujoco(scene: BoxScene, rate: float, substeps: int, integrator: str) -> Engine:
    """MuJoCo with these boxes; substeps are ignored."""
    return MuJoCo(scene, rate, integrator=integrator)


def pybullet(scene: BoxScene, rate: float, substeps: int) -> Engine:
    """PyBullet with these boxes; substeps are ignored."""
    return PyBullet(scene, rate)


def lines(problem: str, rates: Sequence[float]) -> Iterator[Line]:
    """The curves of a problem: each integrator, an increasing number of sub-steps, then the other engines."""
    free, flying = problem in ("flight", "quadrotor"), problem == "quadrotor"
    own = quadrotor if flying else ours
    for integrator in INTEGRATORS:
        yield Line(integrator.replace("_", " "), partial(own, integrator=integrator),
                   [(rate, 1 if free else IN_CONTACT) for rate in rates])
    yield Line("sub-steps", partial(own, integrator=Setting().integrator), [(SUBSTEPPED, n) for n in SUBSTEPS])
    if flying:
        return
    for name, scheme in (("MuJoCo", "EULER"), ("MuJoCo RK4", "RK4")) if free else (("MuJoCo", "EULER"),):
        yield Line(name, partial(mujoco, integrator=scheme), [(rate, 1) for rate in rates])
    yield Line("PyBullet", pybullet, [(rate, 1) for rate in rates])


def measure(problem: Problem, line: Line) -> Iterator[dict[str, Any]]:
    """Error at the end and CPU time in ms per simulated s for each point of a curve."""
    for rate, substeps in line.points:
        engine = line.make(problem.scene, rate, substeps)
        steps = round(problem.seconds * rate)
        engine.run(3)  # compiles the kernels
        taken: list[float] = []
        while not taken or sum(taken) < SPENT or (len(taken) < REPEATS and sum(taken) < LONG):
            engine.reset()
            begin = process_time()
            engine.run(steps)
            taken.append(process_time() - begin)
        errors = dict(problem.errors(engine.positions(), engine.orientations()))
        cost = 1000.0 * statistics.median(taken) / problem.seconds
        yield {"rate": rate, "substeps": substeps, "cost_ms": cost, **errors}
        engine.close()
