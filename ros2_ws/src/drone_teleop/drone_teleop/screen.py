"""A terminal that other programs write to as well: lines that stay, above a status line that is rewritten in place."""

import os
from typing import TextIO

_CLEAR = "\r\x1b[K"  # back to the first column, and nothing to the right


class Screen:
    """Prints lines and keeps a status line below them. There is no status line if `out` is not a terminal."""

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._live = out.isatty()
        self._status = ""

    def print(self, text: str) -> None:
        """Prints lines that stay, above the status line."""
        self._write(f"{_CLEAR}{text}\n{self._status}" if self._live else f"{text}\n")

    def status(self, text: str) -> None:
        """Rewrites the status line; text beyond the width of the terminal is cut off."""
        if self._live:
            width = os.get_terminal_size(self._out.fileno()).columns or 80
            self._status = text[: width - 1]
            self._write(_CLEAR + self._status)

    def close(self) -> None:
        """Moves the cursor below the status line, which stays."""
        if self._live:
            self._write("\n")

    def _write(self, text: str) -> None:
        try:
            self._out.write(text)
            self._out.flush()
        except OSError:  # the terminal is gone; the keyboard reports that
            self._live = False
