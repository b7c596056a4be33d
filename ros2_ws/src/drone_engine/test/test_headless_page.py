"""What docs/headless.md shows runs as it stands there."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[4] / "docs" / "headless.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
SCENE = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(), re.DOTALL)


def test_there_are_two_examples_and_a_scene() -> None:
    assert (len(EXAMPLES), len(SCENE)) == (2, 1)


@pytest.mark.parametrize("text", EXAMPLES, ids=["world", "fleet"])
def test_the_example_runs(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                          capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "my_quadrotor.yaml").write_text(SCENE[0])
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    exec(compile(text, str(PAGE), "exec"), names)
    told = capsys.readouterr().out
    assert "nan" not in told
    assert len(told.splitlines()) >= text.count("print(") > 0
    if "fleet" in names:
        assert names["fleet"].in_blocks  # type: ignore[attr-defined]
