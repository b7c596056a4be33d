"""YAML without its traps: duplicate keys, aliases, deep nesting and malformed scalars are errors."""

import re
from typing import Any

import yaml

DEPTH_LIMIT = 32  # levels of nesting; PyYAML recurses in C, and a deep file would overflow its stack


def read_yaml(text: bytes) -> Any:
    """The data in a YAML text. Raises ValueError in one line: where, and what is wrong."""
    try:
        _check_events(text)
        return yaml.load(text, Loader=_StrictLoader)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        lines = len(text.splitlines()) or 1  # an unclosed bracket is reported one line behind the last
        where = f"line {min(mark.line + 1, lines)}: " if mark else ""
        raise ValueError(f"{where}{getattr(error, 'problem', None) or str(error).splitlines()[0]}") from None


def _check_events(text: bytes) -> None:
    """Raises YAMLError for aliases and for nesting deeper than DEPTH_LIMIT."""
    depth = 0
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEPTH_LIMIT:
            raise _error(f"nested in more than {DEPTH_LIMIT} levels", event.start_mark)
        if isinstance(event, yaml.AliasEvent):
            raise _error(f"YAML aliases are not allowed ('*{event.anchor}')", event.start_mark)


def _error(problem: str, mark: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=mark)


class _StrictLoader(yaml.CSafeLoader):
    """PyYAML silently keeps the last of two equal keys; here they are an error, as is every malformed scalar. 1e3 is a
    number, as in YAML 1.2."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if key.value in seen:
                    raise _error(f"key '{key.value}' appears twice", key.start_mark)
                seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        try:
            return super().construct_object(node, deep)
        except (ArithmeticError, AttributeError, LookupError, ValueError):  # PyYAML does not catch these
            problem = f"not a valid {node.tag.rpartition(':')[2]}: {str(node.value)[:60]!r}"
            raise _error(problem, node.start_mark) from None


_StrictLoader.add_implicit_resolver(
    "tag:yaml.org,2002:float", re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$"), list("-+.0123456789"))
