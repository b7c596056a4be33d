"""The wheels of the libraries hold what they need and nothing else; every file names the same version."""

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from zipfile import ZipFile

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = sorted(path.parent for path in (ROOT / "ros2_ws/src").glob("*/package.xml"))
LIBRARIES = sorted(path.parent for path in (ROOT / "ros2_ws/src").glob("*/pyproject.toml"))
VERSION = re.search(r'__version__ = "(.+)"', (ROOT / "ros2_ws/src/drone_engine/drone_engine/version.py").read_text())[1]


@pytest.fixture(scope="module", params=LIBRARIES, ids=lambda path: path.name)
def wheel(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, set[str]]:
    """(library, names of the files in its wheel), built from a copy of the sources, without network."""
    folder = tmp_path_factory.mktemp(request.param.name)
    source = shutil.copytree(request.param, folder / "source", ignore=shutil.ignore_patterns("__pycache__", "build"))
    build = subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-index", "--no-build-isolation",
         "--wheel-dir", str(folder), str(source)], capture_output=True, text=True, check=False)
    assert build.returncode == 0, build.stdout + build.stderr
    path, = folder.glob("*.whl")
    assert path.name == f"{request.param.name}-{VERSION}-py3-none-any.whl"
    with ZipFile(path) as archive:
        return request.param.name, {name for name in archive.namelist() if not name.endswith("/")}


def test_the_wheel_holds_every_module_and_no_test(wheel: tuple[str, set[str]]) -> None:
    library, names = wheel
    folder = ROOT / "ros2_ws/src" / library
    modules = {str(path.relative_to(folder)) for path in (folder / library).rglob("*.py")
               if "__pycache__" not in path.parts}
    assert {name for name in names if name.endswith(".py")} == modules
    assert f"{library}/py.typed" in names
    assert not [name for name in names if "test/" in name or "__pycache__" in name]


def test_the_wheel_holds_the_assets_or_shaders(wheel: tuple[str, set[str]]) -> None:
    library, names = wheel
    if library == "drone_engine":
        expected = {f"drone_engine/data/{path.relative_to(ROOT / 'assets')}"
                    for kind in ("scenes", "models", "textures") for path in (ROOT / "assets" / kind).glob("[!.]*")}
        assert {name for name in names if name.startswith("drone_engine/data/")} == expected
        assert {Path(name).stem for name in expected if name.endswith(".yaml")} >= {
            "island", "hangar", "lagoon", "crates", "ring"}
    else:
        folder = ROOT / "ros2_ws/src" / library / library
        expected = {f"{library}/{path.relative_to(folder)}" for suffix in ("vert", "frag", "glsl")
                    for path in folder.rglob(f"*.{suffix}")}
        assert expected
        assert expected <= names


@pytest.mark.parametrize("library", LIBRARIES, ids=lambda path: path.name)
def test_a_library_takes_its_version_from_the_one_place(library: Path) -> None:
    project = tomllib.loads((library / "pyproject.toml").read_text())["project"]
    assert project.get("version", VERSION) == VERSION
    assert "version" in project or "version" in project["dynamic"]


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_a_package_has_the_version(package: Path) -> None:
    assert f"<version>{VERSION}</version>" in (package / "package.xml").read_text()
    if (package / "setup.py").exists():
        versions = re.findall(r'version="([\d.]+)"', (package / "setup.py").read_text())
        assert set(versions) <= {VERSION}


def test_the_citation_and_the_changelog_name_the_version() -> None:
    assert f"\nversion: {VERSION}\n" in (ROOT / "CITATION.cff").read_text()
    assert f"\n## {VERSION}" in (ROOT / "CHANGELOG.md").read_text()
