"""Runs the hard cases of motion in all their settings and writes what they reached: docs/hard_cases/motion.json and the
part of the gallery that tells of it. Plots are drawn from the former by figures.hard_cases.motion.
"""

import json
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any

from rich.progress import track

from bench import ROOT
from bench.hard_cases.gallery import gallery
from bench.report.results import Row, machine
from reference.motion.cases import CASES

OUT = ROOT / "docs" / "hard_cases"


def run(name: str, number: int) -> dict[str, Any]:
    """One case in one of its settings."""
    case = CASES[name]
    setting = case.settings[number]
    return {"setting": str(setting), "known": case.known.get(setting, ""), **case.run(setting).as_dict()}


def rows() -> Iterator[Row]:
    """A row for each number that a case is held to, in each setting; writes the gallery at the end."""
    jobs = [(name, number) for name, case in CASES.items() for number in range(len(case.settings))]
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in CASES}
    with ProcessPoolExecutor() as pool:
        results = pool.map(run, *zip(*jobs, strict=True))
        for (name, _), result in zip(jobs, track(results, "motion", len(jobs)), strict=True):
            found[name].append(result)
            for one in result["reached"]:
                yield Row(f"{CASES[name].title}, {result['setting']}: {one['what']}", one["unit"], one["value"],
                          f"at most {one['limit']:g}", one["met"], known=result["known"])
    cases = {name: {"title": case.title, "tries": case.tries, "held_to": case.held_to, "runs": found[name]}
             for name, case in CASES.items()}
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "motion.json").write_text(json.dumps({"machine": machine(), "cases": cases}) + "\n")
    gallery(OUT / "README.md", cases)
