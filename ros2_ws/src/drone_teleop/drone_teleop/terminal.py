"""Reads keys from a terminal: its mode, and the decoding of the bytes that keys send."""

import codecs
import os
import re
import select
import signal
import termios
import time
from types import TracebackType
from typing import Self

ESCAPE = 0x1B
ESCAPE_TIMEOUT = 0.05  # s without a byte after which a lone escape byte means the Esc key

# xterm and rxvt, older xterm, the Linux console.
FUNCTION_KEYS = {
    b"\x1bOQ": "F2",
    b"\x1b[12~": "F2",
    b"\x1b[[B": "F2",
    b"\x1bOR": "F3",
    b"\x1b[13~": "F3",
    b"\x1b[[C": "F3",
    b"\x1bOS": "F4",
    b"\x1b[14~": "F4",
    b"\x1b[[D": "F4",
}
NAMED = {"\t": "Tab", " ": "Space", "\x1b": "Esc"}

# ECMA-48 control sequences, single shift three, the Linux console's function keys, and Alt with a key.
_WHOLE = re.compile(rb"\x1b(?:\[\[[A-E]|\[[0-?]{0,16}[ -/]{0,4}[@-~]|O[0-9;]{0,16}[@-~]|[ -NP-Z\\-~])")
_BEGUN = re.compile(rb"\x1b(?:\[\[|\[[0-?]{0,16}[ -/]{0,4}|O[0-9;]{0,16})?\Z")


class Decoder:
    """Decodes the bytes of a terminal into names of keys, however the bytes are split over reads.

    The name of a printable key is its character; others are 'Tab', 'Space', 'Esc', 'F2', 'F3', 'F4'. The name of any
    other escape sequence is the sequence itself. Bytes that are not UTF-8 are ignored.
    """

    def __init__(self) -> None:
        self._bytes = b""
        self._utf8 = codecs.getincrementaldecoder("utf-8")("ignore")

    @property
    def pending(self) -> bool:
        """Whether an escape sequence is incomplete."""
        return bool(self._bytes)

    def feed(self, data: bytes) -> list[str]:
        """Takes bytes and returns the keys that they complete."""
        self._bytes += data
        keys = []
        while self._bytes and not _BEGUN.match(self._bytes):
            keys += self._take()
        return keys

    def flush(self) -> list[str]:
        """Ends an incomplete sequence: returns Esc for a lone escape byte, otherwise the bytes as they are."""
        begun, self._bytes = self._bytes.decode("latin-1"), b""
        return [NAMED.get(begun, begun)] if begun else []

    def _take(self) -> list[str]:
        whole = _WHOLE.match(self._bytes)
        end = whole.end() if whole else 1
        head, self._bytes = self._bytes[:end], self._bytes[end:]
        if whole:
            return [FUNCTION_KEYS.get(head, head.decode("latin-1"))]
        return [NAMED.get(character, character) for character in self._utf8.decode(head)]


class Keyboard:
    """Reads the keys of a terminal one by one, without echo, within a `with` block; restores its mode at the end.

    Ctrl-C still interrupts. Ctrl-Z, Ctrl-S and Ctrl-Q are ordinary keys, so that they cannot stop a flying program.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._decoder = Decoder()
        self._last_byte = 0.0

    def __enter__(self) -> Self:
        self._before = termios.tcgetattr(self._descriptor)
        mode = termios.tcgetattr(self._descriptor)
        mode[0] &= ~termios.IXON
        mode[3] = (mode[3] & ~(termios.ECHO | termios.ICANON)) | termios.ISIG
        mode[6][termios.VMIN], mode[6][termios.VTIME] = 1, 0
        mode[6][termios.VSUSP] = b"\0"
        termios.tcsetattr(self._descriptor, termios.TCSANOW, mode)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        stops = signal.signal(signal.SIGTTOU, signal.SIG_IGN)  # setting the mode would stop a background process
        try:
            termios.tcsetattr(self._descriptor, termios.TCSANOW, self._before)
            termios.tcflush(self._descriptor, termios.TCIFLUSH)  # the shell must not receive repeats of a held key
        except termios.error:  # the terminal is gone
            pass
        finally:
            signal.signal(signal.SIGTTOU, stops)

    def read(self) -> list[str]:
        """Returns the keys since the last call, without waiting. Raises EOFError if the terminal is gone."""
        now = time.monotonic()
        if select.select([self._descriptor], [], [], 0.0)[0]:
            try:
                data = os.read(self._descriptor, 4096)
            except OSError:
                data = b""
            if not data:
                raise EOFError("the terminal is gone")
            self._last_byte = now
            return self._decoder.feed(data)
        if self._decoder.pending and now - self._last_byte > ESCAPE_TIMEOUT:
            return self._decoder.flush()
        return []
