"""Bytes into keys, and the mode of a terminal, on a real pseudo-terminal."""

import os
import pty
import termios
import time
from collections.abc import Iterator
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drone_teleop.terminal import Decoder, Keyboard

SEQUENCES = [
    (b"i", ["i"]),
    (b"uIo", ["u", "I", "o"]),
    (b"\t", ["Tab"]),
    (b" ", ["Space"]),
    (b"\x1bOS", ["F4"]),
    (b"\x1b[14~", ["F4"]),
    (b"\x1b[[D", ["F4"]),
    (b"\x1bOQ", ["F2"]),
    (b"\x1b[12~", ["F2"]),
    (b"\x1b[[B", ["F2"]),
    (b"\x1bOR", ["F3"]),
    (b"\x1b[13~", ["F3"]),
    (b"\x1b[[C", ["F3"]),
    (b"\x1bOSi\x1b[14~\t", ["F4", "i", "F4", "Tab"]),
    (b"\x1b[1;2S", ["\x1b[1;2S"]),  # Shift-F4: a sequence without a name
    (b"\x1b[A", ["\x1b[A"]),
    (b"\x1bi", ["\x1bi"]),  # Alt-i is not i
    (b"\x1b\x1bOS", ["Esc", "F4"]),
    (b"\x1b[\x01", ["Esc", "[", "\x01"]),  # no sequence at all
    ("é€𝄞".encode(), ["é", "€", "𝄞"]),
    (b"\xff\xfei\xc3i\x80", ["i", "i"]),  # not UTF-8
]


@pytest.mark.parametrize(("data", "keys"), SEQUENCES)
def test_sequences_are_decoded_at_once_and_byte_by_byte(data: bytes, keys: list[str]) -> None:
    assert Decoder().feed(data) == keys
    decoder = Decoder()
    assert [key for byte in data for key in decoder.feed(bytes([byte]))] == keys
    assert decoder.flush() == []


@pytest.mark.parametrize(
    ("data", "key"), [(b"\x1b", "Esc"), (b"\x1b[", "\x1b["), (b"\x1bO", "\x1bO"), (b"\x1b[[", "\x1b[[")]
)
def test_what_is_not_continued_is_a_key_after_a_silence(data: bytes, key: str) -> None:
    decoder = Decoder()
    assert decoder.feed(data) == []
    assert decoder.pending
    assert decoder.flush() == [key]
    assert not decoder.pending
    assert decoder.feed(b"i") == ["i"]


@given(st.lists(st.binary(max_size=8) | st.sampled_from([data for data, _ in SEQUENCES])))
def test_any_bytes_decode_the_same_however_they_are_split(parts: list[bytes]) -> None:
    split, whole = Decoder(), Decoder()
    keys = [key for part in parts for key in split.feed(part)] + split.flush()
    assert keys == whole.feed(b"".join(parts)) + whole.flush()


@given(st.binary(max_size=64))
def test_no_bytes_are_held_back_for_long(data: bytes) -> None:
    decoder = Decoder()
    decoder.feed(data)
    assert decoder.feed(b"\x1b[" + b"0" * 40)[-1] == "0"  # longer than any sequence, so it is none


@pytest.fixture
def terminal() -> Iterator[tuple[int, int]]:
    """The two ends of a pseudo-terminal: the person's and the program's."""
    person, program = pty.openpty()
    yield person, program
    for descriptor in (person, program):
        with suppress(OSError):  # the test has closed it
            os.close(descriptor)


def read(keyboard: Keyboard) -> list[str]:
    """The next keys, within a deadline."""
    deadline = time.monotonic() + 5.0
    while time.monotonic() < deadline:
        if keys := keyboard.read():
            return keys
        time.sleep(0.001)
    raise TimeoutError("no key came")


def test_keys_come_one_by_one_without_echo(terminal: tuple[int, int]) -> None:
    person, program = terminal
    with Keyboard(program) as keyboard:
        assert keyboard.read() == []
        for data, key in ((b"i", "i"), (b"\x1bOS", "F4"), (b"\x1b", "Esc"), (b"\x1a", "\x1a"), (b"\x13", "\x13")):
            os.write(person, data)
            assert read(keyboard) == [key]
        os.set_blocking(person, False)
        with pytest.raises(BlockingIOError):
            os.read(person, 100)


def test_the_mode_is_restored_at_the_end(terminal: tuple[int, int]) -> None:
    _, program = terminal
    before = termios.tcgetattr(program)
    with Keyboard(program):
        assert termios.tcgetattr(program) != before
    assert termios.tcgetattr(program) == before


@pytest.mark.parametrize("error", [KeyboardInterrupt, SystemExit, ValueError])
def test_the_mode_is_restored_after_an_error(terminal: tuple[int, int], error: type[BaseException]) -> None:
    _, program = terminal
    before = termios.tcgetattr(program)
    with pytest.raises(error), Keyboard(program):
        raise error
    assert termios.tcgetattr(program) == before


def test_a_terminal_that_goes_away_is_an_end_of_file(terminal: tuple[int, int]) -> None:
    person, program = terminal
    with Keyboard(program) as keyboard:
        os.close(person)
        with pytest.raises(EOFError):
            read(keyboard)
