"""Every package.xml names the packages that its sources import, no more and no fewer."""

import ast
import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = sorted(path.parent for path in (ROOT / "ros2_ws/src").glob("*/setup.py"))
ROSDEP_KEYS = {  # of modules whose package has another name
    "PIL": "python3-pil", "numba": "python3-numba", "numpy": "python3-numpy", "pydantic": "python3-pydantic",
    "rich": "python3-rich", "rosbags": "python3-rosbags-pip", "trimesh": "python3-trimesh-pip", "yaml": "python3-yaml",
}


def imported(package: Path) -> set[str]:
    """Top-level modules that a package imports, other than itself and the standard library."""
    names: set[str] = set()
    for path in (package / package.name).rglob("*.py"):
        if "__pycache__" in path.parts:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.split(".")[0])
    return names - sys.stdlib_module_names - {package.name}


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_package_xml_names_what_is_imported(package: Path) -> None:
    text = (package / "package.xml").read_text()
    declared = {element.text for element in ElementTree.fromstring(text).iter("exec_depend")}
    without_key = set(re.findall(r"<!-- pip: (\w+), which has no rosdep key -->", text))
    if "llvmlite comes with numba" in text:
        without_key.add("llvmlite")
    modules = imported(package)
    assert {ROSDEP_KEYS.get(module, module) for module in modules - without_key} == declared
    assert without_key <= modules


@pytest.mark.parametrize("package", PACKAGES, ids=lambda path: path.name)
def test_a_package_is_not_installed_as_an_archive(package: Path) -> None:
    """Data files are read from the file system, and kernels are cached beside their sources."""
    assert "zip_safe=True" not in (package / "setup.py").read_text()
