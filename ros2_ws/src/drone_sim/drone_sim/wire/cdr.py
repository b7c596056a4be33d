"""Messages as serialized bytes, written from and read into NumPy arrays without a Python loop.

CDR as ROS 2 sends it (OMG DDSI-RTPS 2.3, 10; XCDR1, little endian): four bytes that name the encoding, then the
fields one after the other, each aligned to its size counted from behind those four bytes. In a message whose
strings and lengths are fixed all numbers keep their place, so its bytes are laid out once and then only filled.
"""

import struct
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

ENCODING = b"\x00\x01\x00\x00"
SECOND = 1_000_000_000  # ns


class Layout:
    """Lays out a message field by field, in the order of its definition; `message` then gives the bytes to fill."""

    def __init__(self) -> None:
        self._body = bytearray()
        self._stamps: list[int] = []
        self._numbers: dict[str, tuple[str, list[range]]] = {}  # name: NumPy type, places of its rows

    def _append(self, size: int, data: bytes) -> int:
        self._body += bytes(-len(self._body) % size)
        self._body += data
        return len(self._body) - len(data)

    def string(self, text: str) -> Self:
        data = text.encode() + b"\0"
        self.uint32(len(data))
        self._append(1, data)
        return self

    def uint8(self, value: int) -> Self:
        self._append(1, struct.pack("<B", value))
        return self

    def uint32(self, value: int) -> Self:
        self._append(4, struct.pack("<I", value))
        return self

    def uint64(self, value: int) -> Self:
        self._append(8, struct.pack("<Q", value))
        return self

    def float64(self, name: str, count: int) -> Self:
        """`count` numbers to be filled in; the same name again adds a row to them. ROS aligns even for none."""
        return self._floats(name, count, 8)

    def float32(self, name: str, count: int) -> Self:
        """The same, of half the size."""
        return self._floats(name, count, 4)

    def _floats(self, name: str, count: int, size: int) -> Self:
        first = self._append(size, bytes(size * count)) // size
        if count:
            self._numbers.setdefault(name, (f"<f{size}", []))[1].append(range(first, first + count))
        return self

    def stamp(self) -> Self:
        """A builtin_interfaces/Time; all stamps of a message are the same."""
        self._stamps.append(self._append(4, bytes(8)) // 4)
        return self

    def header(self, frame: str) -> Self:
        """A std_msgs/Header."""
        return self.stamp().string(frame)

    def message(self) -> "Message":
        """The finished message."""
        return Message(bytes(self._body), self._stamps, self._numbers)


class Message:
    """One message of fixed strings and lengths. Fill it with `stamp` and `write`, publish `bytes(message)`."""

    def __init__(self, body: bytes, stamps: list[int], numbers: dict[str, tuple[str, list[range]]]) -> None:
        # Four unused bytes in front put the body, which follows the encoding, on an address that float64 may have.
        self._buffer = np.zeros(8 + len(body) + -len(body) % 8, np.uint8)
        self._buffer[4:8] = np.frombuffer(ENCODING, np.uint8)
        self._buffer[8 : 8 + len(body)] = np.frombuffer(body, np.uint8)
        self._bytes = self._buffer[4 : 8 + len(body)]
        self._uint32 = self._buffer[8:].view("<u4")
        self._stamps = np.array(stamps, np.intp)
        self._numbers = {name: (self._buffer[8:].view(kind), np.array(rows, np.intp))
                         for name, (kind, rows) in numbers.items()}

    def stamp(self, time_ns: int) -> None:
        """Sets every stamp, in ns since the start of time."""
        self._uint32[self._stamps] = time_ns // SECOND
        self._uint32[self._stamps + 1] = time_ns % SECOND

    def write(self, name: str, values: ArrayLike) -> None:
        """Fills the numbers called `name`; values: (rows, count), or whatever NumPy broadcasts to it."""
        view, places = self._numbers[name]
        view[places] = values

    def __bytes__(self) -> bytes:
        return self._bytes.tobytes()


class Transforms(NamedTuple):
    """A tf2_msgs/TFMessage. poses: (n, 7) float64, x y z in m and a quaternion x y z w, child in parent."""

    stamp_ns: int
    parents: tuple[str, ...]
    children: tuple[str, ...]
    poses: NDArray[np.float64]


class _Shape(NamedTuple):
    """Where the numbers of a TFMessage stand, and where its strings; the padding between may be anything."""

    fixed: NDArray[np.bool_]
    template: NDArray[np.uint8]
    numbers: NDArray[np.intp]
    parents: tuple[str, ...]
    children: tuple[str, ...]


_shapes: dict[int, _Shape] = {}  # by length of the message; a publisher keeps to one or two


def read_transforms(data: bytes) -> Transforms:
    """Parses a serialized TFMessage. Its stamp is the first transform's. Raises ValueError for other bytes."""
    if data[:4] != ENCODING or len(data) < 8:
        raise ValueError("not a little-endian CDR message")
    raw = np.frombuffer(data, np.uint8)
    shape = _shapes.get(len(data))
    if shape is None or not np.array_equal(raw[shape.fixed], shape.template):
        shape = _shapes[len(data)] = _measure(data)
        if len(_shapes) > 64:
            _shapes.pop(next(iter(_shapes)))
    seconds, nanoseconds = struct.unpack_from("<iI", data, 8) if shape.children else (0, 0)
    body = np.frombuffer(data, "<f8", count=(len(data) - 4) // 8, offset=4)
    return Transforms(seconds * SECOND + nanoseconds, shape.parents, shape.children, body[shape.numbers])


def _measure(data: bytes) -> _Shape:
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
        raise ValueError(f"not a TFMessage: {error}") from None
    template = np.frombuffer(data, np.uint8)[fixed]
    parents, children = zip(*names, strict=True) if names else ((), ())
    return _Shape(fixed, template, np.array(numbers, np.intp).reshape(-1, 7), parents, children)
