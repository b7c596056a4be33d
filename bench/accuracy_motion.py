"""What accuracy of motion costs: error at the end over CPU time, for every integrator, step and number of sub-steps.

python bench/accuracy_motion.py writes docs/accuracy/dynamics.json and .md; figures/motion_accuracy_plot.py draws the
former.
"""

import statistics
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

from box_world import Setting
from engines import Engine, MuJoCo, Ours, PyBullet
from motion_cases import INTEGRATORS
from motion_problems import Problem

OUT = Path(__file__).parents[1] / "docs" / "accuracy"
RATES = (30.0, 60.0, 120.0, 240.0, 480.0, 960.0, 1920.0, 3840.0)  # Hz
SUBSTEPS = (1, 2, 4, 8, 16, 32)  # at a rate of SUBSTEPPED Hz
SUBSTEPPED = 60.0
IN_CONTACT = 4  # sub-steps in problems with contacts while the step is varied
SPENT = 0.1  # s of CPU time at least in one timing
REPEATS = 3


class Line(NamedTuple):
    """One curve: an engine made for each step, 1 / rate / sub-steps."""

    name: str
    make: Callable[[Problem, float, int], Engine]
    points: Sequence[tuple[float, int]]  # rate, sub-steps


def lines(problem: str, rates: Sequence[float]) -> Iterator[Line]:
    """Ours with each integrator and with more and more sub-steps, then the others."""
    free = problem == "flight"
    for integrator in INTEGRATORS if free else INTEGRATORS[:1]:
        yield Line(integrator, lambda p, rate, n, how=integrator: Ours(p.what, Setting(rate, n, how)),
                   [(rate, 1 if free else IN_CONTACT) for rate in rates])
    yield Line("sub-steps", lambda p, rate, n: Ours(p.what, Setting(rate, n)), [(SUBSTEPPED, n) for n in SUBSTEPS])
    for scheme in ("EULER", "RK4") if free else ("EULER",):
        yield Line("MuJoCo" if scheme == "EULER" else "MuJoCo RK4",
                   lambda p, rate, _, how=scheme: MuJoCo(p.what, rate, integrator=how), [(rate, 1) for rate in rates])
    yield Line("PyBullet", lambda p, rate, _: PyBullet(p.what, rate), [(rate, 1) for rate in rates])


def measure(problem: Problem, line: Line) -> Iterator[dict[str, Any]]:
    """Error at the end and ms of CPU time per simulated s, for each point of a line."""
    for rate, substeps in line.points:
        engine = line.make(problem, rate, substeps)
        steps = round(problem.seconds * rate)
        engine.run(3)  # compiles
        engine.reset()
        engine.run(steps)
        errors = dict(problem.errors(engine.positions(), engine.orientations()))
        yield {"rate": rate, "substeps": substeps, "cost_ms": cost(engine, steps) / problem.seconds, **errors}
        engine.close()


def cost(engine: Engine, steps: int) -> float:
    """ms of CPU time of so many steps from the start, the median."""
    taken: list[float] = []
    while len(taken) < REPEATS or (sum(taken) < SPENT and len(taken) < 100):
        engine.reset()
        begin = process_time()
        engine.run(steps)
        taken.append(process_time() - begin)
    return 1000.0 * statistics.median(taken)
