"""Cost of accuracy in motion: error at the end over CPU time, for all integrators, step sizes and numbers of sub-steps.

Writes docs/accuracy/dynamics.json and .md; figures.accuracy.motion draws the former.
"""

import argparse
import json
import os
from collections.abc import Iterator, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.progress import Progress

from bench import ROOT
from bench.accuracy.motion import effect_costs
from bench.accuracy.motion.page import text
from bench.accuracy.motion.problems import PROBLEMS, REFERENCE
from bench.accuracy.motion.work_precision import IN_CONTACT, QUICK_RATES, RATES, SUBSTEPPED, SUBSTEPS, lines, measure
from bench.report.results import Row, machine, report

OUT = ROOT / "docs" / "accuracy"
# Published results of Gazebo's benchmark 'boxes': engine, step in ms, position error in m, CPU ms per simulated s.
PUBLISHED = (("ODE", 1.0, 0.049, 56.0), ("ODE", 0.1, 0.0049, 550.0), ("Bullet", 1.0, 0.049, 64.0),
             ("Simbody", 1.0, 0.0245, 127.0))


def diagrams(rates: Sequence[float], progress: Progress) -> dict[str, Any]:
    """Points of all curves of all problems."""
    found: dict[str, Any] = {}
    for name, create in PROBLEMS.items():
        problem = create()
        curves = list(lines(name, rates))
        task = progress.add_task(problem.title, total=sum(len(line.points) for line in curves))
        found[name] = {"title": problem.title, "seconds": problem.seconds, "lines": {}}
        for line in curves:
            points = found[name]["lines"][line.name] = []
            for point in measure(problem, line):
                points.append(point)
                progress.advance(task)
    return found


def rows(result: dict[str, Any]) -> Iterator[Row]:
    """The last point of each curve, and the effects, for the table and bench/results."""
    for problem in result["problems"].values():
        for line, points in problem["lines"].items():
            best = points[-1]
            work = f"{problem['title']}, {line}, {best['rate']:g} Hz x {best['substeps']}"
            yield Row(f"{work}: position error", "m", best["position"])
            yield Row(f"{work}: CPU per simulated s", "ms", best["cost_ms"])
    for effect, cost in result["effects"].items():
        yield Row(f"effect {effect}: CPU per step", "us", cost["us"])
        yield Row(f"effect {effect}: change of the position without it after {cost['seconds']:g} s", "m", cost["off_m"])


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m bench.accuracy.motion", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="fewer steps: within a minute")
    parser.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    options = parser.parse_args()
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    rates = QUICK_RATES if options.quick else RATES
    with Progress() as progress:
        problems = diagrams(rates, progress)
        effects = effect_costs.measure(3 if options.quick else 9, progress)
    result: dict[str, Any] = {
        "machine": machine(),
        "settings": {"rates": rates, "substeps": SUBSTEPS, "substepped_rate": SUBSTEPPED, "in_contact": IN_CONTACT,
                     "reference": REFERENCE,
                     "versions": {name: version(name) for name in ("mujoco", "pybullet")}},
        "problems": problems, "published": PUBLISHED, "effects": effects}
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "dynamics.json").write_text(json.dumps(result, indent=1) + "\n")
    (options.out / "dynamics.md").write_text(text(result))
    report("accuracy_motion", result["settings"], list(rows(result)))


if __name__ == "__main__":
    main()
