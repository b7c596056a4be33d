"""The part of the gallery of hard cases that describes motion, written from the measured numbers."""

from pathlib import Path
from textwrap import fill
from typing import Any

LINE = 120  # characters
HEADING = "## Motion"
INTRODUCTION = """
Over minutes, the errors that the integrator and the solver make in each step accumulate. Each case is a scene, runs in
the settings of its table, and has a limit for each measured number. The tests check these limits
(`test/hard_cases/test_motion_*.py`); `make hard-cases` runs the cases in full length, writes the numbers below and
draws the plots. A run that exceeds a limit is listed as a known failure."""


def gallery(page: Path, cases: dict[str, Any]) -> None:
    """Rewrites the page from the heading on; the text above it stays. cases: as in motion.json."""
    text = page.read_text()
    above = text[: text.index(f"\n{HEADING}\n")] if f"\n{HEADING}\n" in text else text.rstrip() + "\n"
    parts = [above.rstrip(), HEADING, fill(" ".join(INTRODUCTION.split()), LINE), summary(cases)]
    for name, case in cases.items():
        parts.append(f"### {case['title']}\n{_fill(case['tries'])}\nCriterion: {case['held_to']}.")
        parts.append(f"![{case['title']}](motion_{name}.png)")
        parts.append(table(case["runs"]))
    page.write_text("\n\n".join(parts) + "\n")


def summary(cases: dict[str, Any]) -> str:
    """How many runs meet their limits, and the list of those that do not."""
    runs = [(case["title"], run) for case in cases.values() for run in case["runs"]]
    failed = [f"- **{title}**, {run['setting']}" + (f": {run['known']}" if run["known"] else "")
              for title, run in runs if not _met(run)]
    passed = f"{len(runs) - len(failed)} of {len(runs)} runs meet their limits."
    return "\n".join([passed + (" Known failures:" if failed else ""), *failed])


def table(runs: list[dict[str, Any]]) -> str:
    """A Markdown table of the measured numbers, one row per setting."""
    names = list(dict.fromkeys(one["what"] for run in runs for one in run["reached"]))
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
