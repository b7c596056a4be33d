"""Steps per second of boxes, quadrotors and the island, beside MuJoCo, PyBullet, crazyflow and RotorPy.

All engines run in alternation on one core; rates are medians of steps per second of CPU time over the rounds. Rows
with contacts also report the quality of the solution for each engine: penetration, energy drift and speed at rest.
"""

import argparse
import os
import warnings
from collections.abc import Iterator
from importlib.metadata import version

os.environ["SCIPY_ARRAY_API"] = "1"  # crazyflow needs it before the import of SciPy

from bench.dynamics import contacts, flight
from bench.dynamics.contacts import FULL, QUICK, Size
from bench.dynamics.heap import ITERATIONS, RATE, SUBSTEPS
from bench.report.results import Row, report

PEERS = ("mujoco", "pybullet", "crazyflow", "rotorpy")


def rows(size: Size) -> Iterator[Row]:
    """All rows, in the order of the report."""
    for movable in size.heaps:
        yield from contacts.heap_rows(movable, size)
    yield from contacts.asleep(size)
    yield from flight.quadrotor_rows(size.rounds)
    yield flight.island_row(size.rounds)
    yield flight.unused_effects_row(size.rounds)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer boxes and rounds: within a minute")
    options = parser.parse_args()
    size = QUICK if options.quick else FULL
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})  # before JAX counts the cores
    warnings.filterwarnings("ignore", module="crazyflow")
    found = []
    for row in rows(size):
        found.append(row)
        print(f"{row.work}: {row.ours:.4g} {row.unit}", flush=True)
    report("dynamics", {"step": f"1/{RATE:g} s", "substeps": SUBSTEPS, "passes": ITERATIONS, "cores": 1,
                        "rates": "by CPU time, medians", "rounds": size.rounds,
                        "versions": {name: version(name) for name in PEERS},
                        "given": "published figures of another machine, scaled by the ratio of MuJoCo's rates"}, found)


if __name__ == "__main__":
    main()
