"""The example of CONTRIBUTING that runs kernels without compiling them."""

import os
import re
import subprocess
import sys
from pathlib import Path

TEXT = (Path(__file__).parents[1] / "CONTRIBUTING.md").read_text()


def test_a_small_scene_runs_without_compiling(tmp_path: Path) -> None:
    scene = re.search(r"<< 'END'\n(.*?)    END\n", TEXT, re.DOTALL)
    program = re.search(r'NUMBA_DISABLE_JIT=1 python -c "(.*)"', TEXT)
    assert scene
    assert program
    (tmp_path / "small.yaml").write_text(re.sub("^    ", "", scene[1], flags=re.MULTILINE))
    run = subprocess.run([sys.executable, "-c", program[1]], cwd=tmp_path, capture_output=True, text=True, check=False,
                         env={**os.environ, "NUMBA_DISABLE_JIT": "1"})
    assert run.returncode == 0, run.stderr
    x, y, z = (float(number) for number in run.stdout.strip("[] \n").split()[:3])
    assert abs(x) + abs(y) + abs(z) < 1e-3  # it fell onto the floor, where its origin has the height 0
