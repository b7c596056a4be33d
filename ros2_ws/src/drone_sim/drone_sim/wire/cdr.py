"""Serialized messages, written from NumPy arrays and read into them without a Python loop.

CDR as ROS 2 sends it (OMG DDSI-RTPS 2.3, section 10; XCDR1, little endian): four bytes for the encoding, then the
fields in order, each aligned to its size, counted from the end of those four bytes. In a message with fixed strings
and lengths every number has a fixed offset, so its bytes are laid out once and then only filled.
"""

import struct
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

ENCODING = b"\x00\x01\x00\x00"
SECOND = 1_000_000_000  # ns


class Layout:
    """Lays out a message field by field, in the order of its definition; `message` returns the bytes to fill.

    Every method but `message` returns the layout itself, so that calls can be chained.
    """

    def __init__(self) -> None:
        self._body = bytearray()
        self._stamps: list[int] = []
        self._numbers: dict[str, tuple[str, list[range]]] = {}  # name: NumPy type, indices of the numbers in each row

    def _append(self, size: int, data: bytes) -> int:
        self._body += bytes(-len(self._body) % size)
        self._body += data
        return len(self._body) - len(data)

    def string(self, text: str) -> Self:
        """A string with this value."""
        data = text.encode() + b"\0"
        self.uint32(len(data))
        self._append(1, data)
        return self

    def uint8(self, value: int) -> Self:
        """A uint8, bool or octet with this value."""
        self._append(1, struct.pack("<B", value))
        return self

    def uint32(self, value: int) -> Self:
        """A uint32 with this value, or the length of a sequence."""
        self._append(4, struct.pack("<I", value))
        return self

    def uint64(self, value: int) -> Self:
        """A uint64 with this value."""
        self._append(8, struct.pack("<Q", value))
        return self

    def float64(self, name: str, count: int) -> Self:
        """`count` float64 to be filled in by `name`; using a name again adds a row. ROS aligns even if count is 0."""
        return self._floats(name, count, 8)

    def float32(self, name: str, count: int) -> Self:
        """`count` float32 to be filled in by `name`; using a name again adds a row."""
        return self._floats(name, count, 4)

    def _floats(self, name: str, count: int, size: int) -> Self:
        first = self._append(size, bytes(size * count)) // size
        if count:
            self._numbers.setdefault(name, (f"<f{size}", []))[1].append(range(first, first + count))
        return self

    def stamp(self) -> Self:
        """A builtin_interfaces/Time; all stamps of a message get the same value."""
        self._stamps.append(self._append(4, bytes(8)) // 4)
        return self

    def header(self, frame: str) -> Self:
        """A std_msgs/Header with this frame."""
        return self.stamp().string(frame)

    def message(self) -> "Message":
        """The message, with all numbers and stamps 0."""
        return Message(bytes(self._body), self._stamps, self._numbers)


class Message:
    """A message with fixed strings and lengths. Fill it with `stamp` and `write`, publish `bytes(message)`."""

    def __init__(self, body: bytes, stamps: list[int], numbers: dict[str, tuple[str, list[range]]]) -> None:
        # Four unused bytes in front align the body, which follows the encoding, for float64.
        self._buffer = np.zeros(8 + len(body) + -len(body) % 8, np.uint8)
        self._buffer[4:8] = np.frombuffer(ENCODING, np.uint8)
        self._buffer[8 : 8 + len(body)] = np.frombuffer(body, np.uint8)
        self._bytes = self._buffer[4 : 8 + len(body)]
        self._uint32 = self._buffer[8:].view("<u4")
        self._stamps = np.array(stamps, np.intp)
        self._numbers = {name: (self._buffer[8:].view(kind), np.array(rows, np.intp))
                         for name, (kind, rows) in numbers.items()}

    def stamp(self, time_ns: int) -> None:
        """Sets every stamp to a time in ns."""
        self._uint32[self._stamps] = time_ns // SECOND
        self._uint32[self._stamps + 1] = time_ns % SECOND

    def write(self, name: str, values: ArrayLike) -> None:
        """Fills the numbers called `name`; values: (rows, count) or an array that broadcasts to it."""
        view, indices = self._numbers[name]
        view[indices] = values

    def __bytes__(self) -> bytes:
        return self._bytes.tobytes()


class Transforms(NamedTuple):
    """A tf2_msgs/TFMessage. poses: (n, 7) float64, x y z in m and a quaternion x y z w, of the child in the parent."""

    stamp_ns: int
    parents: tuple[str, ...]
    children: tuple[str, ...]
    poses: NDArray[np.float64]


class _TransformsLayout(NamedTuple):
    """Offsets of the numbers and strings of a TFMessage; the padding bytes between them are arbitrary.

    fixed: mask of the bytes that have the values `template`; numbers: (n, 7) indices of float64.
    """

    fixed: NDArray[np.bool_]
    template: NDArray[np.uint8]
    numbers: NDArray[np.intp]
    parents: tuple[str, ...]
    children: tuple[str, ...]


_layouts: dict[int, _TransformsLayout] = {}  # by length of the message; a publisher uses one or two


def read_transforms(data: bytes) -> Transforms:
    """Parses a serialized TFMessage; the stamp is that of the first transform. Raises ValueError for other bytes."""
    if data[:4] != ENCODING or len(data) < 8:
        raise ValueError(f"expected a little-endian CDR message, got {len(data)} bytes, first {data[:4].hex()}")
    raw = np.frombuffer(data, np.uint8)
    layout = _layouts.get(len(data))
    if layout is None or not np.array_equal(raw[layout.fixed], layout.template):
        layout = _layouts[len(data)] = _transforms_layout(data)
        if len(_layouts) > 64:
            _layouts.pop(next(iter(_layouts)))
    seconds, nanoseconds = struct.unpack_from("<iI", data, 8) if layout.children else (0, 0)
    body = np.frombuffer(data, "<f8", count=(len(data) - 4) // 8, offset=4)
    return Transforms(seconds * SECOND + nanoseconds, layout.parents, layout.children, body[layout.numbers])


def _transforms_layout(data: bytes) -> _TransformsLayout:
    fixed = np.zeros(len(data), bool)
    fixed[4:8] = True
    numbers: list[range] = []
    names: list[tuple[str, str]] = []

    def string(at: int) -> tuple[str, int]:
        at += -(at - 4) % 4
        (length,) = struct.unpack_from("<I", data, at)
        fixed[at : at + 4 + length] = True
        return data[at + 4 : at + 3 + length].decode(), at + 4 + length

    try:
        (count,) = struct.unpack_from("<I", data, 4)
        at = 8
        for _ in range(count):
            at += -(at - 4) % 4
            parent, at = string(at + 8)
            child, at = string(at)
            at += -(at - 4) % 8
            struct.unpack_from("<7d", data, at)
            numbers.append(range((at - 4) // 8, (at - 4) // 8 + 7))
            names.append((parent, child))
            at += 56
    except (struct.error, UnicodeDecodeError) as error:
        raise ValueError(f"expected a TFMessage, got other bytes: {error}") from None
    template = np.frombuffer(data, np.uint8)[fixed]
    parents, children = zip(*names, strict=True) if names else ((), ())
    return _TransformsLayout(fixed, template, np.array(numbers, np.intp).reshape(-1, 7), parents, children)
