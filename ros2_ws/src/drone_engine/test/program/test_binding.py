"""Parameters of kernels are bound by name; a wrong name or a wrong array is an error when a program is built."""

from typing import NamedTuple

import numpy as np
import pytest

from drone_engine.kernel import kernel
from drone_engine.program.program import Program
from drone_engine.program.scope import BindingError, Scope
from drone_engine.program.stage import Stage, in_python


class Pair(NamedTuple):
    """A record."""

    first: np.ndarray
    second: np.ndarray


class Owner:
    """Shares arrays."""

    def __init__(self) -> None:
        self.position, self.velocity = np.zeros((2, 3)), np.ones((2, 3))
        self.pair = Pair(np.zeros(2), np.ones(2))


@kernel
def move(position, velocity, h):
    """Adds h times velocity (n, 3) to position (n, 3)."""
    for i in range(position.shape[0]):
        for c in range(3):
            position[i, c] += h * velocity[i, c]


@kernel
def move_record(h, pair):
    """Adds h times the second array of a record to the first."""
    for i in range(pair.first.shape[0]):
        pair.first[i] += h * pair.second[i]


@kernel
def ask_once(flag):
    """Returns 7 as long as flag (1,) is 0."""
    return 7 if flag[0] == 0 else 0


@pytest.fixture
def owner() -> Owner:
    return Owner()


def scope_of(owner: Owner) -> Scope:
    scope = Scope()
    scope.share(owner, "position", "velocity", "pair")
    return scope


def run(*stages: Stage, steps: int = 1) -> None:
    program = Program(stages)
    program.compile()
    program.run(steps)


def test_arrays_are_found_by_name_whatever_the_order(owner: Owner) -> None:
    run(Stage("move", move, scope_of(owner), {"h": 0.5}), steps=4)
    np.testing.assert_array_equal(owner.position, 2.0)
    np.testing.assert_array_equal(owner.velocity, 1.0)


def test_a_record_is_passed_as_one(owner: Owner) -> None:
    run(Stage("move", move_record, scope_of(owner), {"h": 0.25}), steps=2)
    np.testing.assert_array_equal(owner.pair.first, 0.5)


def test_a_name_that_nothing_has_is_an_error(owner: Owner) -> None:
    with pytest.raises(BindingError, match=r"stage 'move': kernel .*\.move: parameter 'h' is neither given nor shared"):
        Program([Stage("move", move, scope_of(owner))])


def test_a_name_that_is_given_and_shared_is_an_error(owner: Owner) -> None:
    given = {"h": 0.5, "velocity": owner.position}
    with pytest.raises(BindingError, match="'velocity' is given and shared"):
        Program([Stage("move", move, scope_of(owner), given)])


def test_an_argument_that_the_kernel_does_not_have_is_an_error(owner: Owner) -> None:
    with pytest.raises(BindingError, match="has no parameter 'mass', which is given"):
        Program([Stage("move", move, scope_of(owner), {"h": 0.5, "mass": 1.0})])


def test_one_name_for_two_arrays_is_an_error(owner: Owner) -> None:
    scope = scope_of(owner)
    with pytest.raises(BindingError, match="'position' is shared by Owner and by Owner"):
        scope.share(Owner(), "position")


def test_an_array_that_is_not_contiguous_is_an_error(owner: Owner) -> None:
    owner.position = np.zeros((2, 6))[:, ::2]
    with pytest.raises(BindingError, match=r"'position' has to be contiguous, got an array of shape \(2, 3\)"):
        Program([Stage("move", move, scope_of(owner), {"h": 0.5})])


def test_a_replaced_array_is_taken_after_binding_again(owner: Owner) -> None:
    program = Program([Stage("move", move, scope_of(owner), {"h": 1.0})])
    program.compile()
    program.run(1)
    owner.position = np.full((2, 3), 5.0)
    program.bind()
    program.run(1)
    np.testing.assert_array_equal(owner.position, 6.0)


def test_a_code_is_handled_and_the_stage_that_is_returned_runs_next() -> None:
    flag, codes = np.zeros(1, np.int64), []

    def handle(code: int) -> Stage:
        codes.append(code)
        flag[0] = 1
        return asking

    asking = Stage("asking", ask_once, given={"flag": flag}, handle=handle)
    seen: list[int] = []
    run(asking, in_python("look", lambda: seen.append(int(flag[0]))), steps=3)
    assert codes == [7]
    assert seen == [1, 1, 1]
