"""Cost of accuracy in collision: the four levels at poses from flights and at random poses near touch.

Writes docs/accuracy/collision.json and .md; figures.accuracy.collision draws the former.
"""

import argparse
import json
import statistics
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
from rich.progress import Progress

from bench import ROOT
from bench.accuracy.collision.approaches import APART, DEEP, EACH, lines
from bench.accuracy.collision.comparison import CONTACTS, HALVINGS, LEVELS, QUERIES, REPEATS, Tally, evaluate
from bench.accuracy.collision.flights import CRUISE, SPEED, Flight, targets
from bench.accuracy.collision.page import text
from bench.report.results import Row, machine, report
from drone_engine.assets import asset_path
from drone_engine.collision_level import TESTED

OUT = ROOT / "docs" / "accuracy"
SCENES = {"ring": 6, "hangar": 6, "island": 4}  # passes at each target
MODELS = ("archway", "brick_house", "crate", "drone", "palm", "person", "ring", "rock_round", "table", "television",
          "truck")  # approached along random lines
LINES = 40  # per model
SEED = 1


def fly(scene: str, passes: int, tallies: dict[str, Tally], progress: Progress) -> dict[str, float]:
    """Adds a flight's encounters to the tallies by model; returns the CPU time of detection per step, us, by level."""
    flight = Flight(scene, SEED)
    names = targets(flight.world)
    task = progress.add_task(f"flying through {scene}", total=passes * len(names))
    for _ in flight.passes(names, passes):
        progress.advance(task)
    encounters = flight.encounters()
    task = progress.add_task(f"evaluating {scene}", total=len(encounters) + len(LEVELS))
    for e in encounters:
        evaluate(tallies[e.path_b.stem], e, e)
        progress.advance(task)
    costs = {}
    for level in TESTED:
        costs[level] = detection_cost(flight, level)
        progress.advance(task)
    return costs


def detection_cost(flight: Flight, level: str) -> float:
    """CPU time in us of broad phase and contacts per step, mean over the states of the flight."""
    world = flight.world
    world.set_collision_level(level)
    runs = []
    for _ in range(REPEATS):
        spent = 0
        for state in flight.states:
            world.state.assign(state)
            start = time.thread_time_ns()
            world.detect()
            spent += time.thread_time_ns() - start
        runs.append(spent / 1000 / len(flight.states))
    return statistics.median(runs)


def approach(models: tuple[str, ...], count: int, tallies: dict[str, Tally], progress: Progress) -> None:
    """Adds the poses of random lines to the tallies by model."""
    random = np.random.default_rng(SEED)
    for model in progress.track(models, description="random lines"):
        rows, near = lines(asset_path("models", "drone.obj"), asset_path("models", f"{model}.obj"), count, random)
        evaluate(tallies[model], rows, near)


def summary(tally: Tally) -> dict[str, dict[str, float | int | None]]:
    """Results of each level, in m, degrees and us."""
    def of(samples: list[float], percent: float | None = None) -> float | None:
        if not samples:
            return None
        return float(np.mean(samples) if percent is None else np.percentile(samples, percent))

    return {name: {
        "poses": tally.poses, "hits": tally.hits[i], "false": tally.false[i], "missed": tally.missed[i],
        "alarms": len(tally.gaps[i]), "gap_mean": of(tally.gaps[i]), "gap_95": of(tally.gaps[i], 95),
        "contacts": len(tally.contacts_us[i]), "silent": tally.without_contact[i],
        "depth_median": of(tally.depth[i], 50), "depth_95": of(tally.depth[i], 95),
        "normal_median": of(tally.normal[i], 50), "normal_95": of(tally.normal[i], 95),
        "question_us": of(tally.test_us[i]), "answer_us": of(tally.contacts_us[i]),
    } for i, name in enumerate(TESTED)}


def whole(tallies: dict[str, Tally]) -> Tally:
    """Sum of the tallies of all models."""
    total = Tally()
    for tally in tallies.values():
        total.add(tally)
    return total


def rows(result: dict[str, Any]) -> list[Row]:
    """The samples for the table and bench/results."""
    found = []
    for sample, levels in result["samples"].items():
        for name, n in levels.items():
            of = f"{sample}, {name}"
            found += [Row(f"{of}: intersection test, CPU", "us", n["question_us"]),
                      Row(f"{of}: contacts, CPU", "us", n["answer_us"]),
                      Row(f"{of}: false contacts", "% of poses", 100 * n["false"] / n["poses"]),
                      Row(f"{of}: missed contacts", "", n["missed"], "0", n["missed"] == 0),
                      Row(f"{of}: intersecting surfaces without contact", "", n["silent"]),
                      Row(f"{of}: gap at the first hit, mean", "m", n["gap_mean"]),
                      Row(f"{of}: depth error, median", "m", n["depth_median"]),
                      Row(f"{of}: normal error, median", "deg", n["normal_median"])]
    return found


def main() -> None:
    """Command line; exits with an error if a level misses a contact that a finer one finds."""
    parser = argparse.ArgumentParser(prog="python -m bench.accuracy.collision", description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one scene, two models, few lines: within a minute")
    parser.add_argument("--out", type=Path, default=OUT, help="folder to write to")
    options = parser.parse_args()
    scenes = {"ring": 3} if options.quick else SCENES
    models, count = (("ring", "rock_round"), 8) if options.quick else (MODELS, LINES)

    flown: dict[str, Tally] = defaultdict(Tally)
    random: dict[str, Tally] = defaultdict(Tally)
    with Progress() as progress:
        costs = {scene: fly(scene, passes, flown, progress) for scene, passes in scenes.items()}
        approach(models, count, random, progress)
    samples = {"flights": flown, "random": random}
    result = {
        "machine": machine(),
        "settings": {"seed": SEED, "passes": scenes, "speed": SPEED, "height": CRUISE, "models": models, "lines": count,
                     "deep": DEEP, "apart": APART, "poses_each": 2 * EACH, "repeats": REPEATS, "questions": QUERIES,
                     "contacts": CONTACTS},
        "samples": {name: summary(whole(tallies)) for name, tallies in samples.items()},
        "models": {name: {model: summary(tallies[model]) for model in sorted(tallies)}
                   for name, tallies in samples.items()},
        "detection_us": costs,
    }
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "collision.json").write_text(json.dumps(result, indent=1) + "\n")
    (options.out / "collision.md").write_text(text(result, HALVINGS))
    report("accuracy", result["settings"], rows(result))
    missed = sum(n["missed"] for levels in result["samples"].values() for n in levels.values())
    if missed:
        raise SystemExit(f"{missed} contacts of a finer level were missed by a coarser one")


if __name__ == "__main__":
    main()
