"""Conventions of the code: docstrings, kernels with few parameters, no change of sys.path, plain wording."""

import ast
import re
import subprocess
import tokenize
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
ENGINE = "ros2_ws/src/drone_engine/drone_engine/"
MAX_PARAMETERS = 15  # of a kernel
# Decorators that compile.
KERNEL = re.compile(r"(kernel|inlined|allocating|c_function|numba\.(njit|jit|cfunc|vectorize))\b")

# Words that the documentation, docstrings and comments do not use: old ones, and those that make persons of programs.
WORDING = re.compile(r"\b(anew|reckon(ed|s|ing)?|seldom|shall|whoever|somebody|nobody|anybody|(is|are|was|were) told"
                     r"|knows (no|nothing|nobody)|hangs? on|in vain|takes leave|those who|who wants|springy|hurry)\b",
                     re.IGNORECASE)

# Kernels with more parameters, by file under drone_engine and name, each with the reason.
MANY_PARAMETERS = {
    "collision/box/sat.py:gaps": "scalars only: a SIMD leaf",
    "collision/mesh/traversal.py:_find_all": "called from Python for each query: flat arrays",
    "collision/mesh/traversal.py:_intersects_all": "called from Python for each query: flat arrays",
    "collision/mesh/traversal.py:_leaf_triangles": "the innermost loop: access to fields of records counts references",
    "collision/ray/cast.py:ray_octree": "scalars of the ray beside the arrays of the tree",
    "flight/control.py:loops": "scalars only: a SIMD leaf",
    "flight/control.py:rates": "scalars only: a SIMD leaf",
    "flight/pilot.py:guidance": "scalars only: a SIMD leaf",
}


class Definition(NamedTuple):
    """A class or function of a file; name: with those of the classes around it."""

    path: Path
    name: str
    node: ast.ClassDef | ast.FunctionDef

    @property
    def public(self) -> bool:
        """Whether no part of the name begins with an underscore."""
        return not any(part.startswith("_") for part in self.name.split("."))

    @property
    def decorators(self) -> list[str]:
        """Source of the decorators."""
        return [ast.unparse(decorator) for decorator in self.node.decorator_list]

    @property
    def is_kernel(self) -> bool:
        """Whether numba compiles the function."""
        return any(KERNEL.match(decorator) for decorator in self.decorators)

    def __str__(self) -> str:
        return f"{self.path.relative_to(ROOT)}:{self.node.lineno} {self.name}"


def sources() -> list[Path]:
    """All tracked Python files but tests."""
    listed = subprocess.run(["git", "ls-files", "--", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / line for line in listed.stdout.splitlines() if not re.search(r"(^|/)test(s?)/", line)]


def definitions(path: Path) -> Iterator[Definition]:
    """Classes, methods and functions of a file, without those inside functions."""

    def search(node: ast.AST, prefix: str) -> Iterator[Definition]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.ClassDef | ast.FunctionDef):
                yield Definition(path, prefix + child.name, child)
            if isinstance(child, ast.ClassDef):
                yield from search(child, f"{prefix}{child.name}.")
            elif isinstance(child, ast.If | ast.Try | ast.With):
                yield from search(child, prefix)

    return search(ast.parse(path.read_text()), "")


def test_modules_classes_functions_and_kernels_have_docstrings() -> None:
    """All public ones and all kernels. A method may have the docstring of an interface or base class in its module."""
    missing = []
    for path in sources():
        module = ast.parse(path.read_text())
        if module.body and not ast.get_docstring(module):
            missing.append(f"{path.relative_to(ROOT)} module")
        found = list(definitions(path))
        documented = {d.node.name for d in found if "." in d.name and ast.get_docstring(d.node)}
        missing += [str(d) for d in found if (d.public or d.is_kernel) and not ast.get_docstring(d.node)
                    and not ("." in d.name and d.node.name in documented)
                    and not any(re.search(r"overload|\.setter", decorator) for decorator in d.decorators)]
    assert not missing, "\n".join(missing)


def test_kernels_have_few_parameters() -> None:
    """Arrays that belong together are passed as one record; exceptions have a reason."""
    many = {}
    for path in sources():
        for d in definitions(path):
            if d.is_kernel and isinstance(d.node, ast.FunctionDef):
                arguments = d.node.args
                count = len(arguments.posonlyargs) + len(arguments.args) + len(arguments.kwonlyargs)
                if count > MAX_PARAMETERS:
                    many[f"{str(path.relative_to(ROOT)).removeprefix(ENGINE)}:{d.name}"] = count
    assert sorted(set(many) - set(MANY_PARAMETERS)) == [], f"more than {MAX_PARAMETERS} parameters, without a reason"
    assert sorted(set(MANY_PARAMETERS) - set(many)) == [], "no exception any more: remove it from MANY_PARAMETERS"


def test_nothing_changes_the_import_path() -> None:
    # Split, so that this file does not match.
    change = re.compile(r"\bsys" r"\.path\b\s*(\.(insert|append|extend|remove|pop)|\[|\+?=[^=])|site\.addsite" r"dir")
    listed = subprocess.run(["git", "ls-files", "--", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True)
    found = [f"{line}:{number}" for line in listed.stdout.splitlines()
             for number, text in enumerate((ROOT / line).read_text().splitlines(), 1) if change.search(text)]
    assert not found


def prose(path: Path) -> Iterator[tuple[int, str]]:
    """Line numbers and texts: all lines of a page; docstrings and comments of a Python file."""
    if path.suffix == ".md":
        yield from enumerate(path.read_text().splitlines(), 1)
        return
    with path.open("rb") as file:
        for token in tokenize.tokenize(file.readline):
            if token.type == tokenize.COMMENT:
                yield token.start[0], token.string
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
            yield from enumerate(text.splitlines(), node.body[0].lineno)


def test_wording() -> None:
    listed = subprocess.run(["git", "ls-files", "--", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    found = [f"{path.relative_to(ROOT)}:{number}: {match[0]}"
             for path in [*sources(), *(ROOT / line for line in listed.stdout.splitlines())]
             for number, text in prose(path) for match in WORDING.finditer(text)]
    assert not found, "\n".join(found)
