"""Lines on a terminal that others write to, too: what is said stays, the status below it is rewritten in place."""

import os
from typing import TextIO

_CLEAR = "\r\x1b[K"  # back to the first column, and nothing to the right


class Screen:
    """Says lines, and keeps one status line as the last. Where `out` is no terminal there is no status line."""

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._live = out.isatty()
        self._status = ""

    def say(self, text: str) -> None:
        """Prints lines that stay, above the status."""
        self._write(f"{_CLEAR}{text}\n{self._status}" if self._live else f"{text}\n")

    def status(self, text: str) -> None:
        """Rewrites the status line; what does not fit into the width is cut off."""
        if self._live:
            width = os.get_terminal_size(self._out.fileno()).columns or 80
            self._status = text[: width - 1]
            self._write(_CLEAR + self._status)

    def close(self) -> None:
        """Leaves the status where it is and the cursor below it."""
        if self._live:
            self._write("\n")

    def _write(self, text: str) -> None:
        try:
            self._out.write(text)
            self._out.flush()
        except OSError:  # the terminal went away; that is for the keyboard to notice
            self._live = False
