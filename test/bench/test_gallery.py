"""The gallery of hard cases is written from the measured numbers and lists every missed limit."""

from pathlib import Path
from typing import Any

from bench.hard_cases.gallery import gallery
from reference.motion.outcome import Criterion, Outcome, thinned


def case(value: float) -> dict[str, Any]:
    outcome = Outcome((Criterion("moved", value, 1.0, "mm"),), thinned({"time_s": list(range(1000))}))
    return {"title": "A stack", "tries": "Boxes.", "held_to": "1 mm",
            "runs": [{"setting": "30 Hz", "known": "", **outcome.as_dict()}]}


def test_text_above_the_heading_stays_and_writing_twice_changes_nothing(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("# Hard cases\n\nBy hand.\n")
    gallery(page, {"stack": case(0.5)})
    first = page.read_text()
    gallery(page, {"stack": case(0.5)})
    assert page.read_text() == first
    assert first.startswith("# Hard cases\n\nBy hand.\n\n## Motion\n")
    assert "1 of 1 runs meet" in first
    assert "| 30 Hz | 0.5 mm (at most 1) |" in first


def test_a_missed_limit_is_listed_as_a_known_failure(tmp_path: Path) -> None:
    page = tmp_path / "README.md"
    page.write_text("# Hard cases\n")
    gallery(page, {"stack": case(2.0)})
    assert "0 of 1 runs meet their limits. Known failures:\n- **A stack**, 30 Hz" in page.read_text()
    assert "**2 mm**" in page.read_text()


def test_nan_does_not_meet_a_limit() -> None:
    assert not Criterion("moved", float("nan"), 1.0).met
    assert Criterion("moved", 1.0, 1.0).met
    assert Outcome((Criterion("moved", 2.0, 1.0, "mm"),)).failures == ["moved: 2 mm, at most 1 mm"]


def test_series_are_thinned_for_plots() -> None:
    series = thinned({"time_s": list(range(1000)), "few": [1.0, 2.0], "rows": [[1.0, 2.0]] * 600})
    assert len(series["time_s"]) == 200
    assert series["few"].tolist() == [1.0, 2.0]
    assert series["rows"].shape == (200, 2)
