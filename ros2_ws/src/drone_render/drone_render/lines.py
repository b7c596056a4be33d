"""Lines of a serialized visualization_msgs/MarkerArray, read without an object for every point."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from drone_sim.cdr import ENCODING

LINE_LIST = 5  # of visualization_msgs/Marker: points two by two
Floats = npt.NDArray[np.float32]


class Lines(NamedTuple):
    """n lines: ends (n, 2, 3) in m in the world, colours (n, 4) red, green, blue, alpha from 0 to 1."""

    ends: Floats
    colours: Floats


class _Reader:
    """Walks through CDR; offsets count from behind the four bytes of the encoding."""

    def __init__(self, data: bytes) -> None:
        self._body, self._at = data[4:], 0

    def skip(self, size: int, count: int = 1) -> int:
        """Passes numbers of a size; returns where they begin."""
        first = self._at + -self._at % size
        self._at = first + size * count
        if self._at > len(self._body):
            raise ValueError("not a MarkerArray: it ends too early")
        return first

    def uint32(self) -> int:
        return int.from_bytes(self._body[self.skip(4) : self._at], "little")

    def floats(self, kind: str, count: int) -> npt.NDArray[np.floating]:
        size = int(kind[-1])
        if not count:
            return np.empty(0, kind)
        return np.frombuffer(self._body, kind, count, self.skip(size, count))

    def text(self) -> None:
        self.skip(1, self.uint32())


def read_lines(data: bytes) -> Lines:
    """All lists of lines in the message, in the world's frame. Raises ValueError for other bytes."""
    if data[:4] != ENCODING:
        raise ValueError("not a little-endian CDR message")
    reader = _Reader(data)
    ends, colours = [np.empty((0, 2, 3), np.float32)], [np.empty((0, 4), np.float32)]
    for _ in range(reader.uint32()):
        kind, points, shades = _marker(reader)
        if kind == LINE_LIST and len(points) and len(points) == len(shades):
            pairs = len(points) // 2
            ends.append(points[: 2 * pairs].reshape(pairs, 2, 3).astype(np.float32))
            colours.append(shades[: 2 * pairs : 2].astype(np.float32))
    return Lines(np.vstack(ends), np.vstack(colours))


def _marker(reader: _Reader) -> tuple[int, npt.NDArray[np.floating], npt.NDArray[np.floating]]:
    """Type, points (n, 3) and colours (n, 4) of the next marker."""
    reader.skip(4, 2)  # stamp
    reader.text()  # frame
    reader.text()  # namespace
    reader.skip(4)  # id
    kind = reader.uint32()
    reader.skip(4)  # action
    reader.skip(8, 10)  # pose, scale
    reader.skip(4, 6)  # colour, lifetime
    reader.skip(1)  # frame locked
    count = reader.uint32()
    points = reader.floats("<f8", 3 * count).reshape(-1, 3)
    count = reader.uint32()
    colours = reader.floats("<f4", 4 * count).reshape(-1, 4)
    reader.text()  # texture
    reader.skip(4, 2)
    reader.text()
    reader.text()
    reader.skip(1, reader.uint32())
    if coordinates := reader.uint32():
        reader.skip(4, 2 * coordinates)
    reader.text()  # words to show
    reader.text()  # mesh
    reader.text()
    reader.skip(1, reader.uint32())
    reader.skip(1)
    return kind, points, colours
