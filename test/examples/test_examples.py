"""Every program in examples/ runs, prints something, and is short."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_it_runs(example: Path, tmp_path: Path) -> None:
    assert len(example.read_text().splitlines()) < 100
    result = subprocess.run([sys.executable, example], cwd=tmp_path, capture_output=True, text=True, check=False,
                            env={**os.environ, "PYTHONUNBUFFERED": "1"}, timeout=600)
    assert result.returncode == 0, result.stderr
    assert result.stdout.strip()
    assert "nan" not in result.stdout
