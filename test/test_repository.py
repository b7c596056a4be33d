"""The house is in order: style, types, arrows that point down, and nothing of any one machine in the files."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOOLS = Path(sys.executable).parent
PACKAGES = ("drone_engine", "drone_sim", "drone_render", "drone_teleop", "drone_ai")


def run(*command: str) -> None:
    result = subprocess.run([str(TOOLS / command[0]), *command[1:]], cwd=ROOT, capture_output=True, text=True,
                            check=False)
    assert result.returncode == 0, f"{' '.join(command)}\n{result.stdout}{result.stderr}"


def tracked(*patterns: str) -> list[Path]:
    listed = subprocess.run(["git", "ls-files", "--", *patterns], cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / line for line in listed.stdout.splitlines()]


def test_style() -> None:
    run("ruff", "check", ".")


@pytest.mark.parametrize("package", [*PACKAGES, "reference", "bench", "figures"])
def test_types(package: str) -> None:
    run("mypy", "-p", package)


def test_types_of_the_workspace_programs() -> None:
    run("mypy", *sorted(str(path.relative_to(ROOT)) for path in (ROOT / "ros2_ws").glob("*.py")))


def test_arrows_point_down() -> None:
    run("lint-imports", "--no-cache")


def test_no_path_of_one_machine() -> None:
    # Split, so that this file does not name what it looks for.
    forbidden = re.compile("|".join(["/" + "home/", "/" + "root/", "/" + "work/", re.escape(str(ROOT)) + r"\b"]))
    texts = tracked("*.py", "*.md", "*.yaml", "*.toml", "*.txt", "*.sh", "Makefile", "*.xml", "*.json")
    found = [f"{path.relative_to(ROOT)}:{number}" for path in texts
             for number, line in enumerate(path.read_text().splitlines(), 1) if forbidden.search(line)]
    assert not found


def test_every_link_leads_somewhere() -> None:
    target = re.compile(r"""\]\(([^)\s#]+)|(?:src|href)="([^"#]+)""")
    broken = [f"{path.relative_to(ROOT)}: {link}" for path in tracked("README.md", "CONTRIBUTING.md", "docs/*.md")
              for link in map("".join, target.findall(path.read_text()))
              if "://" not in link and not (path.parent / link).exists()]
    assert not broken


def test_every_requirement_is_pinned_and_has_its_reason() -> None:
    for path in (ROOT / f"requirements/{name}.txt" for name in ("run", "dev", "docs", "bench")):
        for line in path.read_text().splitlines():
            if line and not line.startswith("#"):
                assert re.fullmatch(r"[\w.-]+==[\w.]+ +# .+", line), f"{path.name}: {line}"


def test_files_have_one_subject() -> None:
    """Long files tell of several subjects; 350 lines are where we look for a second one."""
    long = [f"{path.relative_to(ROOT)}: {count} lines" for path in tracked("*.py")
            if (count := len(path.read_text().splitlines())) > 350]
    assert not long
