"""Reads line lists and spheres from a serialized visualization_msgs/MarkerArray, without creating message objects."""

import struct
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from drone_render.arrays import Float32s
from drone_render.frame.lines import Shapes
from drone_render.frame.poses import matrices
from drone_sim.wire.cdr import ENCODING
from drone_sim.wire.layouts import ADD, LINE_LIST, MARKER_TAIL, SPHERE

PIXELS_PER_METER = 200  # of a line's width: other viewers scale it with distance, here it is the same near and far
MAX_WIDTH = 8  # pixels
POSE_SCALE_COLOR = struct.Struct("<10d4f")
NO_COLORS: Float32s = np.empty((0, 4), np.float32)


class Marker(NamedTuple):
    """The fields of a marker that are used."""

    frame: str
    kind: int
    action: int
    pose: tuple[float, ...]  # x y z qx qy qz qw
    scale: tuple[float, ...]  # (3,) m
    color: tuple[float, ...]  # (4,)
    points: npt.NDArray[np.floating]  # (p, 3)
    colors: npt.NDArray[np.floating]  # (p, 4), or (0, 4) if all points have the marker's color


class _Reader:
    """A position in a CDR message; offsets count from behind the four bytes of the encoding."""

    def __init__(self, data: bytes) -> None:
        self._body, self._at = data[len(ENCODING) :], 0

    def skip(self, size: int, count: int = 1) -> int:
        """Skips `count` numbers of `size` bytes; returns the offset of the first one."""
        first = self._at + -self._at % size
        self._at = first + size * count
        if self._at > len(self._body):
            raise ValueError("expected a MarkerArray, got too few bytes")
        return first

    def uint32(self) -> int:
        """The next uint32."""
        at = self.skip(4)
        return int.from_bytes(self._body[at : at + 4], "little")

    def unpack(self, layout: struct.Struct) -> tuple[float, ...]:
        """The next numbers in a layout that is aligned to 8 bytes."""
        self.skip(8, 0)
        return layout.unpack_from(self._body, self.skip(1, layout.size))

    def skip_if(self, data: bytes) -> bool:
        """Whether these bytes come next; if so, skips them."""
        found = self._body.startswith(data, self._at)
        self._at += len(data) if found else 0
        return found

    def floats(self, kind: str, count: int) -> npt.NDArray[np.floating]:
        """The next `count` numbers of the NumPy type `kind`, such as '<f8'."""
        size = int(kind[-1])
        if not count:
            return np.empty(0, kind)
        return np.frombuffer(self._body, kind, count, self.skip(size, count))

    def text(self) -> str:
        """The next string."""
        size = self.uint32()
        at = self.skip(1, size)
        return self._body[at : at + max(size - 1, 0)].decode(errors="replace")


def read_markers(data: bytes) -> Shapes:
    """All line lists and spheres that the message adds. Raises ValueError if it is no MarkerArray."""
    if data[: len(ENCODING)] != ENCODING:
        raise ValueError("expected a little-endian CDR message, got another encoding")
    reader = _Reader(data)
    markers = [marker for _ in range(reader.uint32()) if (marker := _marker(reader)).action == ADD]
    lists = [i for i, m in enumerate(markers) if m.kind == LINE_LIST and len(m.colors) in (0, len(m.points))]
    spheres = [i for i, m in enumerate(markers) if m.kind == SPHERE]
    counts = [len(markers[i].points) // 2 for i in lists]
    ends = [markers[i].points[: 2 * count].reshape(-1, 2, 3) for i, count in zip(lists, counts, strict=True)]
    colors = [m.colors[: 2 * count : 2] if len(m.colors) else np.tile(np.array(m.color), (count, 1))
              for m, count in zip((markers[i] for i in lists), counts, strict=True)]
    widths = np.nan_to_num(PIXELS_PER_METER * np.array([markers[i].scale[0] for i in lists]))
    return Shapes(
        tuple(marker.frame for marker in markers),
        matrices(np.array([marker.pose for marker in markers]).reshape(-1, 7)),
        np.concatenate([np.empty((0, 2, 3)), *ends]).astype(np.float32),
        np.concatenate([np.empty((0, 4)), *colors]).astype(np.float32),
        np.repeat(np.clip(np.round(widths), 1, MAX_WIDTH).astype(np.int64), counts),
        np.repeat(np.array(lists, np.int64), counts),
        np.array(spheres, np.int64),
        np.array([markers[i].scale[0] / 2 for i in spheres], np.float32),
        np.array([markers[i].color for i in spheres], np.float32).reshape(-1, 4),
    )  # fmt: skip


def _marker(reader: _Reader) -> Marker:
    """Reads the next marker."""
    reader.skip(4, 2)  # stamp
    frame = reader.text()
    reader.text()  # namespace
    reader.skip(4)  # id
    kind, action = reader.uint32(), reader.uint32()
    row = reader.unpack(POSE_SCALE_COLOR)
    reader.skip(4, 2)  # lifetime
    reader.skip(1)  # frame locked
    count = reader.uint32()
    points = reader.floats("<f8", 3 * count).reshape(-1, 3)
    read = frame, kind, action, row[:7], row[7:10], row[10:], points
    if reader.skip_if(MARKER_TAIL):  # true for all markers of drone_sim, and fast
        return Marker(*read, NO_COLORS)
    count = reader.uint32()
    colors = reader.floats("<f4", 4 * count).reshape(-1, 4)
    reader.text()  # texture
    reader.skip(4, 2)
    reader.text()
    reader.text()
    reader.skip(1, reader.uint32())
    if coordinates := reader.uint32():
        reader.skip(4, 2 * coordinates)
    reader.text()  # text to show
    reader.text()  # mesh
    reader.text()
    reader.skip(1, reader.uint32())
    reader.skip(1)
    return Marker(*read, colors)
