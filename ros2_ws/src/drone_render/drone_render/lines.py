"""Lines and balls of a serialized visualization_msgs/MarkerArray, read without an object for every point, and put where
the things are that they hang on."""

import struct
from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from drone_render.view import Array, matrices
from drone_sim.wire.cdr import ENCODING
from drone_sim.wire.layouts import ADD, BALL, LINE_LIST, NO_MORE

WORLD = "world"
METRE = 200  # pixels of a line's width: its metres are for viewers that scale it, here it is the same near and far
WIDEST = 8  # pixels
POSE_SCALE_COLOUR = struct.Struct("<10d4f")
Floats = npt.NDArray[np.float32]
NO_COLOURS: Floats = np.empty((0, 4), np.float32)


class Lines(NamedTuple):
    """n lines and k balls in the world, m; colours red, green, blue, alpha from 0 to 1."""

    ends: Floats  # (n, 2, 3)
    colours: Floats  # (n, 4)
    widths: npt.NDArray[np.int64]  # (n,) pixels
    centres: Floats  # (k, 3)
    radii: Floats  # (k,)
    ball_colours: Floats  # (k, 4)

    @classmethod
    def of(cls, ends: npt.ArrayLike, colours: npt.ArrayLike, width: int = 2) -> Self:
        """Lines of one width, and no balls."""
        lines, none = np.asarray(ends, np.float32), np.empty((0, 4), np.float32)
        widths = np.full(len(lines), width, np.int64)
        return cls(lines, np.asarray(colours, np.float32), widths, none[:, :3], none[:, 0], none)


class Shapes(NamedTuple):
    """n lines and k balls, each in the frame of its marker; m markers."""

    frames: tuple[str, ...]  # (m,) names
    poses: Array  # (m, 4, 4) of the markers in them
    ends: Floats  # (n, 2, 3)
    colours: Floats  # (n, 4)
    widths: npt.NDArray[np.int64]  # (n,) pixels
    marker: npt.NDArray[np.int64]  # (n,) of each line
    balls: npt.NDArray[np.int64]  # (k,) marker of each ball
    radii: Floats  # (k,) m
    ball_colours: Floats  # (k, 4)

    def placed(self, names: Sequence[str], world: Array) -> Lines:
        """Where they are while the objects of these names have the matrices (o, 4, 4) in the world; what hangs on
        something else is left out."""
        row = {name: i for i, name in enumerate(names, 1)} | {WORLD: 0}
        rows = np.array([row.get(frame, -1) for frame in self.frames], np.int64)
        known = rows >= 0
        place = (np.concatenate([np.eye(4)[None], world])[rows] @ self.poses).astype(np.float32)
        here, there = known[self.marker], known[self.balls]
        mine = place[self.marker[here]]
        ends = self.ends[here] @ mine[:, :3, :3].transpose(0, 2, 1) + mine[:, None, :3, 3]
        return Lines(ends, self.colours[here], self.widths[here], place[self.balls[there], :3, 3], self.radii[there],
                     self.ball_colours[there])


class Marker(NamedTuple):
    """What is read of one."""

    frame: str
    kind: int
    action: int
    pose: tuple[float, ...]  # x y z qx qy qz qw
    scale: tuple[float, ...]  # (3,) m
    colour: tuple[float, ...]  # (4,)
    points: npt.NDArray[np.floating]  # (p, 3)
    colours: npt.NDArray[np.floating]  # (p, 4), or (0, 4) where all have the marker's


class _Reader:
    """Walks through CDR; offsets count from behind the four bytes of the encoding."""

    def __init__(self, data: bytes) -> None:
        self._body, self._at = data[len(ENCODING) :], 0

    def skip(self, size: int, count: int = 1) -> int:
        """Passes numbers of a size; returns where they begin."""
        first = self._at + -self._at % size
        self._at = first + size * count
        if self._at > len(self._body):
            raise ValueError("not a MarkerArray: it ends too early")
        return first

    def uint32(self) -> int:
        at = self.skip(4)
        return int.from_bytes(self._body[at : at + 4], "little")

    def numbers(self, layout: struct.Struct) -> tuple[float, ...]:
        """Those of a layout that begins at a multiple of 8."""
        self.skip(8, 0)
        return layout.unpack_from(self._body, self.skip(1, layout.size))

    def passed(self, data: bytes) -> bool:
        """Whether these bytes come next, which are passed then."""
        found = self._body.startswith(data, self._at)
        self._at += len(data) if found else 0
        return found

    def floats(self, kind: str, count: int) -> npt.NDArray[np.floating]:
        size = int(kind[-1])
        if not count:
            return np.empty(0, kind)
        return np.frombuffer(self._body, kind, count, self.skip(size, count))

    def text(self) -> str:
        size = self.uint32()
        at = self.skip(1, size)
        return self._body[at : at + max(size - 1, 0)].decode(errors="replace")


def read_markers(data: bytes) -> Shapes:
    """All lists of lines and all balls that the message adds. Raises ValueError for other bytes."""
    if data[: len(ENCODING)] != ENCODING:
        raise ValueError("not a little-endian CDR message")
    reader = _Reader(data)
    markers = [marker for _ in range(reader.uint32()) if (marker := _marker(reader)).action == ADD]
    lined = [i for i, m in enumerate(markers) if m.kind == LINE_LIST and len(m.colours) in (0, len(m.points))]
    balls = [i for i, m in enumerate(markers) if m.kind == BALL]
    counts = [len(markers[i].points) // 2 for i in lined]
    ends = [markers[i].points[: 2 * count].reshape(-1, 2, 3) for i, count in zip(lined, counts, strict=True)]
    shades = [m.colours[: 2 * count : 2] if len(m.colours) else np.tile(np.array(m.colour), (count, 1))
              for m, count in zip((markers[i] for i in lined), counts, strict=True)]
    widths = np.nan_to_num(METRE * np.array([markers[i].scale[0] for i in lined]))
    return Shapes(
        tuple(marker.frame for marker in markers),
        matrices(np.array([marker.pose for marker in markers]).reshape(-1, 7)),
        np.concatenate([np.empty((0, 2, 3)), *ends]).astype(np.float32),
        np.concatenate([np.empty((0, 4)), *shades]).astype(np.float32),
        np.repeat(np.clip(np.round(widths), 1, WIDEST).astype(np.int64), counts),
        np.repeat(np.array(lined, np.int64), counts),
        np.array(balls, np.int64),
        np.array([markers[i].scale[0] / 2 for i in balls], np.float32),
        np.array([markers[i].colour for i in balls], np.float32).reshape(-1, 4),
    )  # fmt: skip


def _marker(reader: _Reader) -> Marker:
    """The next one."""
    reader.skip(4, 2)  # stamp
    frame = reader.text()
    reader.text()  # namespace
    reader.skip(4)  # id
    kind, action = reader.uint32(), reader.uint32()
    row = reader.numbers(POSE_SCALE_COLOUR)
    reader.skip(4, 2)  # lifetime
    reader.skip(1)  # frame locked
    count = reader.uint32()
    points = reader.floats("<f8", 3 * count).reshape(-1, 3)
    read = frame, kind, action, row[:7], row[7:10], row[10:], points
    if reader.passed(NO_MORE):  # which is all that drone_sim's have, and fast
        return Marker(*read, NO_COLOURS)
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
    return Marker(*read, colours)
