"""Runs the hard cases of motion in all their settings.

Writes docs/hard_cases/motion.json, from which figures.hard_cases.motion draws the plots, and the part of the gallery
that describes motion.
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
    """Outcome of a case in c of its settings, as JSON."""
    case = CASES[name]
    setting = case.settings[number]
    return {"setting": str(setting), "known": case.known_failures.get(setting, ""), **case.run(setting).as_dict()}


def rows() -> Iterator[Row]:
    """One row per limit and setting; writes the gallery at the end."""
    jobs = [(name, number) for name, case in CASES.items() for number in range(len(case.settings))]
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in CASES}
    with ProcessPoolExecutor() as pool:
        results = pool.map(run, *zip(*jobs, strict=True))
        for (name, _), result in zip(jobs, track(results, "motion", len(jobs)), strict=True):
            found[name].append(result)
            for c in result["reached"]:
                yield Row(f"{CASES[name].title}, {result['setting']}: {c['what']}", c["unit"], c["value"],
                          f"at most {c['limit']:g}", c["met"], known=result["known"])
    cases = {name: {"title": case.title, "tries": case.description, "held_to": case.criterion, "runs": found[name]}
             for name, case in CASES.items()}
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "motion.json").write_text(json.dumps({"machine": machine(), "cases": cases}) + "\n")
    gallery(OUT / "README.md", cases)
