"""The arrays that a kernel reads and writes, derived from its text and that of all kernels that it calls.

The analysis follows names: a parameter, a field of a record, a row of an array that is kept in a variable, and
arguments of calls. It does not follow values, so that a branch that is never taken counts as taken.
"""

import ast
import inspect
import textwrap
from functools import cache
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np

from drone_engine.program import binding
from drone_engine.program.stage import Stage

_NOT_CONTENTS = ("shape", "size", "ndim")


class Access(NamedTuple):
    """Names of arrays: parameters, or 'record.field'."""

    reads: frozenset[str]
    writes: frozenset[str]


class _Alias(NamedTuple):
    """What a variable stands for: an array or record by its path, and how many dimensions it has left; -1: unknown."""

    path: str
    dimensions: int


def of_stage(stage: Stage) -> Access:
    """The arrays that a stage reads and writes, including those that its handler is declared to write. Numbers, which
    never change, are left out."""
    if stage.kernel is None:
        return Access(frozenset(), frozenset(stage.writes))
    values = binding.arguments(stage)
    dimensions: dict[str, int] = {}
    for name, value in zip(binding.parameters(stage), values, strict=True):
        for path, leaf in binding.leaves(value, name):
            if isinstance(leaf, np.ndarray):
                dimensions[path] = leaf.ndim
    analysis = _Analysis(dimensions)
    names = binding.parameters(stage)
    aliases = tuple(frozenset({_Alias(name, dimensions.get(name, -1))}) for name in names)
    analysis.function(getattr(stage.kernel, "py_func", stage.kernel), aliases)
    known = dimensions.keys()
    return Access(frozenset(analysis.reads & known), frozenset((analysis.writes & known) | set(stage.writes)))


@cache
def _tree(function: Any) -> ast.FunctionDef:
    node = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    assert isinstance(node, ast.FunctionDef)
    return node


class _Analysis:
    """Collects paths over a function and its callees."""

    def __init__(self, dimensions: dict[str, int]) -> None:
        self.dimensions = dimensions
        self.reads: set[str] = set()
        self.writes: set[str] = set()
        self._done: set[tuple[Any, tuple[frozenset[_Alias], ...]]] = set()

    def function(self, function: Any, arguments: tuple[frozenset[_Alias], ...]) -> None:
        """Analyzes a function whose parameters stand for these arrays."""
        if (function, arguments) in self._done:
            return
        self._done.add((function, arguments))
        tree = _tree(function)
        names = dict(zip((parameter.arg for parameter in tree.args.args), arguments, strict=False))
        visitor = _Visitor(self, function.__globals__, names)
        for _ in range(2):  # a row may be kept in a loop after the line that uses it
            for statement in tree.body:
                visitor.visit(statement)


class _Visitor(ast.NodeVisitor):
    """Visits the statements of one function."""

    def __init__(self, analysis: _Analysis, namespace: dict[str, Any], names: dict[str, frozenset[_Alias]]) -> None:
        self.analysis, self.namespace, self.names = analysis, namespace, names

    def aliases(self, node: ast.AST) -> frozenset[_Alias]:
        """What an expression of names, fields and indices stands for; empty for anything else."""
        if isinstance(node, ast.Name):
            return self.names.get(node.id, frozenset())
        if isinstance(node, ast.Attribute):
            return frozenset(self._alias(f"{alias.path}.{node.attr}") for alias in self.aliases(node.value))
        if isinstance(node, ast.Subscript):
            index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            taken = sum(not isinstance(part, ast.Slice) for part in index)
            return frozenset(alias._replace(dimensions=alias.dimensions - taken if alias.dimensions >= taken else -1)
                             for alias in map(self._typed, self.aliases(node.value)))
        if isinstance(node, ast.IfExp):
            return self.aliases(node.body) | self.aliases(node.orelse)
        return frozenset()

    def _alias(self, path: str) -> _Alias:
        return _Alias(path, self.analysis.dimensions.get(path, -1))

    def _typed(self, alias: _Alias) -> _Alias:
        return self._alias(alias.path) if alias.dimensions < 0 else alias

    def _read(self, node: ast.AST) -> None:
        self.analysis.reads |= {alias.path for alias in self.aliases(node)}

    def visit_Name(self, node: ast.Name) -> None:
        if isinstance(node.ctx, ast.Load):
            self._read(node)

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if node.attr in _NOT_CONTENTS and self.aliases(node.value):
            return
        if isinstance(node.ctx, ast.Load):
            self._read(node)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.value, ast.Attribute) and node.value.attr in _NOT_CONTENTS:
            return
        self._read(node)
        self.visit(node.slice)

    def _assign(self, target: ast.AST, value: ast.AST | None) -> None:
        if isinstance(target, ast.Tuple | ast.List):
            parts = value.elts if isinstance(value, ast.Tuple | ast.List) else [None] * len(target.elts)
            for part, of in zip(target.elts, parts, strict=True):
                self._assign(part, of)
            if value is not None and not isinstance(value, ast.Tuple | ast.List):
                self.visit(value)
            return
        if isinstance(target, ast.Name):
            kept = self.aliases(value) if value is not None else frozenset()
            arrays = frozenset(alias for alias in kept if alias.dimensions != 0)
            if arrays:
                self.names[target.id] = self.names.get(target.id, frozenset()) | arrays
            if value is not None and (not arrays or arrays != kept):
                self.visit(value)
            return
        if isinstance(target, ast.Subscript):
            self.analysis.writes |= {alias.path for alias in self.aliases(target.value)}
            self.visit(target.slice)
        if value is not None:
            self.visit(value)

    def visit_Assign(self, node: ast.Assign) -> None:
        for target in node.targets:
            self._assign(target, node.value)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        if isinstance(node.target, ast.Subscript):
            self._read(node.target.value)
        self._assign(node.target, None)
        self.visit(node.value)

    def visit_For(self, node: ast.For) -> None:
        self.visit(node.iter)
        if isinstance(node.iter, ast.Tuple | ast.List):  # such as `for axis, out in ((0, low), (1, high))`
            for value in node.iter.elts:
                self._assign(node.target, value)
        for statement in [*node.body, *node.orelse]:
            self.visit(statement)

    def visit_Call(self, node: ast.Call) -> None:
        callee = self._resolve(node.func)
        function = getattr(callee, "py_func", None)
        if function is None or node.keywords or any(isinstance(part, ast.Starred) for part in node.args):
            for part in [*node.args, *(keyword.value for keyword in node.keywords)]:
                self.visit(part)
            return
        for part in node.args:  # numbers, and the indices of rows
            if not self.aliases(part):
                self.visit(part)
            elif isinstance(part, ast.Subscript):
                self.visit(part.slice)
                self.analysis.reads |= {alias.path for alias in self.aliases(part) if alias.dimensions == 0}
        self.analysis.function(function, tuple(self.aliases(part) for part in node.args))

    def _resolve(self, node: ast.AST) -> Any:
        """The object that a call names: a function, or one of a module."""
        if isinstance(node, ast.Name):
            return self.namespace.get(node.id)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module = self.namespace.get(node.value.id)
            return getattr(module, node.attr, None) if isinstance(module, ModuleType) else None
        return None
