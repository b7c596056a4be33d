"""The part of the gallery of hard cases that tells of motion, written from what the cases have reached."""

from pathlib import Path
from textwrap import fill
from typing import Any

LINE = 120  # characters
HEADING = "## Motion"
INTRODUCTION = """
What a body does over minutes hangs on what an integrator and a solver get wrong in a step. Each case runs as a scene,
in the settings that its table names, and is held to its number: by the tests (`test/hard_cases/test_motion_*.py`), and
in full length by `make hard-cases`, which writes these numbers and draws the plots. A run that misses its number stands
here as a known failure until it does not."""


def gallery(page: Path, cases: dict[str, Any]) -> None:
    """Writes everything from the heading on anew; what stands above it stays."""
    text = page.read_text()
    above = text[: text.index(f"\n{HEADING}\n")] if f"\n{HEADING}\n" in text else text.rstrip() + "\n"
    parts = [above.rstrip(), HEADING, fill(" ".join(INTRODUCTION.split()), LINE), summary(cases)]
    for name, case in cases.items():
        parts.append(f"### {case['title']}\n{_fill(case['tries'])}\nHeld to: {case['held_to']}.")
        parts.append(f"![{case['title']}](motion_{name}.png)")
        parts.append(table(case["runs"]))
    page.write_text("\n\n".join(parts) + "\n")


def summary(cases: dict[str, Any]) -> str:
    """How many hold, and which do not."""
    runs = [(case["title"], run) for case in cases.values() for run in case["runs"]]
    failed = [f"- **{title}**, {run['setting']}" + (f": {run['known']}" if run["known"] else "")
              for title, run in runs if not _met(run)]
    held = f"{len(runs) - len(failed)} of {len(runs)} runs hold to their numbers."
    return "\n".join([held + (" Known failures:" if failed else ""), *failed])


def table(runs: list[dict[str, Any]]) -> str:
    """What each setting reached."""
    names = [one["what"] for one in runs[0]["reached"]]
    names += [one["what"] for run in runs[1:] for one in run["reached"] if one["what"] not in names]
    lines = [f"| | {' | '.join(names)} |", "|---|" + "--:|" * len(names)]
    for run in runs:
        found = {one["what"]: one for one in run["reached"]}
        lines.append(f"| {run['setting']} | {' | '.join(_cell(found.get(name)) for name in names)} |")
    return "\n".join(lines)


def _cell(one: dict[str, Any] | None) -> str:
    if one is None:
        return ""
    value = f"{one['value']:.2g}" if one["value"] < 100.0 else f"{one['value']:.0f}"
    number = f"{value} {one['unit']}".rstrip()
    return (number if one["met"] else f"**{number}**") + f" (at most {one['limit']:.3g})"


def _met(run: dict[str, Any]) -> bool:
    return all(one["met"] for one in run["reached"])


def _fill(text: str) -> str:
    return fill(text, LINE)
