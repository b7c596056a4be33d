"""Checks of the repository: style, types, import rules, links, requirements, and no paths of a machine in the files."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TOOLS = Path(sys.executable).parent
PACKAGES = ("drone_engine", "drone_sim", "drone_render", "drone_teleop", "drone_ai")


def run(*command: str) -> None:
    """Runs a tool of the environment; fails with its output if it reports an error."""
    result = subprocess.run([str(TOOLS / command[0]), *command[1:]], cwd=ROOT, capture_output=True, text=True,
                            check=False)
    assert result.returncode == 0, f"{' '.join(command)}\n{result.stdout}{result.stderr}"


def tracked(*patterns: str) -> list[Path]:
    """Files of the repository that match."""
    listed = subprocess.run(["git", "ls-files", "--", *patterns], cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / line for line in listed.stdout.splitlines()]


def test_style() -> None:
    run("ruff", "check", ".")


@pytest.mark.parametrize("package", [*PACKAGES, "reference", "bench", "figures"])
def test_types(package: str) -> None:
    run("mypy", "-p", package)


def test_types_of_the_workspace_programs() -> None:
    run("mypy", *sorted(str(path.relative_to(ROOT)) for path in (ROOT / "ros2_ws").glob("*.py")))


def test_import_rules() -> None:
    run("lint-imports", "--no-cache")


def test_no_path_of_a_machine() -> None:
    # Split, so that this file does not match.
    forbidden = re.compile("|".join(["/" + "home/", "/" + "root/", "/" + "work/", re.escape(str(ROOT)) + r"\b"]))
    texts = tracked("*.py", "*.md", "*.yaml", "*.toml", "*.txt", "*.sh", "Makefile", "*.xml", "*.json")
    found = [f"{path.relative_to(ROOT)}:{number}" for path in texts
             for number, line in enumerate(path.read_text().splitlines(), 1) if forbidden.search(line)]
    assert not found


def test_links_have_targets() -> None:
    target = re.compile(r"""\]\(([^)\s#]+)|(?:src|href)="([^"#]+)""")
    broken = [f"{path.relative_to(ROOT)}: {link}" for path in tracked("README.md", "CONTRIBUTING.md", "docs/*.md")
              for link in map("".join, target.findall(path.read_text()))
              if "://" not in link and not (path.parent / link).exists()]
    assert not broken


def test_requirements_are_pinned_and_have_a_reason() -> None:
    for path in (ROOT / f"requirements/{name}.txt" for name in ("run", "dev", "docs", "bench")):
        for line in path.read_text().splitlines():
            if line and not line.startswith("#"):
                assert re.fullmatch(r"[\w.-]+==[\w.]+ +# .+", line), f"{path.name}: {line}"


def test_no_file_is_longer_than_400_lines() -> None:
    """Longer files usually have several subjects."""
    long = [f"{path.relative_to(ROOT)}: {count} lines" for path in tracked("*.py")
            if (count := len(path.read_text().splitlines())) > 400]
    assert not long
