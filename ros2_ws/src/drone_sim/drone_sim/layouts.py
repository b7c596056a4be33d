"""The layouts of what the simulation publishes every step; each function's message is written with the names given."""

import struct
from collections.abc import Iterable, Sequence

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.cdr import ENCODING, Layout, Message


def clock() -> Message:
    """rosgraph_msgs/Clock."""
    return Layout().stamp().message()


def pose_stamped(frame: str) -> Message:
    """geometry_msgs/PoseStamped; 'pose': x y z qx qy qz qw."""
    return Layout().header(frame).float64("pose", 7).message()


def odometry(frame: str, child: str) -> Message:
    """nav_msgs/Odometry; 'pose': x y z qx qy qz qw; 'twist': linear, angular, in the child's frame; no covariance."""
    layout = Layout().header(frame).string(child)
    return layout.float64("pose", 7).float64("pose_covariance", 36).float64("twist", 6).float64(
        "twist_covariance", 36).message()


def transforms(parents: Sequence[str], children: Sequence[str]) -> Message:
    """tf2_msgs/TFMessage; 'pose': (n, 7) x y z qx qy qz qw."""
    layout = Layout().uint32(len(children))
    for parent, child in zip(parents, children, strict=True):
        layout.header(parent).string(child).float64("pose", 7)
    return layout.message()


def joint_state(names: Sequence[str]) -> Message:
    """sensor_msgs/JointState; 'position' (1, n) in rad, 'velocity' (1, n) in rad/s."""
    layout = Layout().header("").uint32(len(names))
    for name in names:
        layout.string(name)
    layout.uint32(len(names)).float64("position", len(names))
    layout.uint32(len(names)).float64("velocity", len(names))
    return layout.uint32(0).float64("effort", 0).message()


LINE_LIST = 5  # of visualization_msgs/Marker: points two by two


def line_markers(frame: str, lines: Iterable[tuple[str, int]]) -> Message:
    """visualization_msgs/MarkerArray with one marker of lines for each (name, number of end points).

    '<name>/points': (1, 3 n) m in the frame; '<name>/colours': (1, 4 n) red, green, blue, alpha, from 0 to 1.
    """
    lines = list(lines)
    layout = Layout().uint32(len(lines))
    for name, count in lines:
        layout.header(frame).string(name).uint32(0).uint32(LINE_LIST).uint32(0)  # id, type, action: add
        layout.float64("identity", 7).float64("width", 3).float32("colour", 4).uint32(0).uint32(0).uint8(0)
        layout.uint32(count).float64(f"{name}/points", 3 * count)
        layout.uint32(count).float32(f"{name}/colours", 4 * count)
        layout.string("").header("").string("").uint32(0).uint32(0)  # no texture, no uv coordinates
        layout.string("").string("").string("").uint32(0).uint8(0)  # no text, no mesh
    message = layout.message()
    if lines:
        message.write("identity", (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
        message.write("width", (0.01, 0.0, 0.0))
        message.write("colour", 1.0)
    return message


class CollisionEvents:
    """drone_interfaces/CollisionEvents among bodies of these names, laid out anew for the events of each step.

    An event is a phase, two names, a level and eight float64, so that the next one starts at a multiple of 8.
    """

    def __init__(self, names: Sequence[str], frame: str = "world") -> None:
        texts = [name.encode() + b"\0" for name in names]
        padded = [struct.pack("<I", len(text)) + text + bytes(-len(text) % 4) for text in texts]
        self._names = np.frombuffer(b"".join(padded), "<u4")
        self._words = np.array([len(name) // 4 for name in padded], np.int64)  # of each name, with its length
        self._begin = np.cumsum(self._words) - self._words
        self._bare = np.array([4 + len(text) for text in texts], np.int64)  # bytes of each name without its padding
        self._frame = frame

    def message(self, time_ns: int, step: int, phase: Integers, pairs: Integers, level: Integers,
                numbers: Floats) -> bytes:
        """phase, level: (n,). pairs: (n, 2) bodies. numbers: (n, 8) point, normal, depth, impulse."""
        top = Layout().header(self._frame).uint64(step).uint32(len(phase)).message()
        top.stamp(time_ns)
        head = bytes(top)[len(ENCODING) :]
        a, b = pairs.T
        shift = np.zeros(len(phase), np.int64)
        shift[:1] = len(head) % 8  # the first event alone starts at no multiple of 8
        level_at = shift + 4 + 4 * self._words[a] + self._bare[b]  # from the multiple of 8
        numbers_at = level_at + 1 + -(level_at + 1) % 8
        size = numbers_at + 8 * numbers.shape[1]
        at = len(head) // 8 * 8 + np.cumsum(size) - size

        body = np.zeros(8 + len(head) // 8 * 8 + int(size.sum()), np.uint8)
        body[: len(head)] = np.frombuffer(head, np.uint8)
        body[at + shift] = phase
        body.view("<f8")[(at + numbers_at)[:, None] // 8 + np.arange(numbers.shape[1])] = numbers
        first = (at + shift + 4) // 4
        for name, place in ((a, first), (b, first + self._words[a])):
            words = self._words[name]
            nth = np.arange(words.sum()) - np.repeat(np.cumsum(words) - words, words)  # word of its name
            body.view("<u4")[np.repeat(place, words) + nth] = self._names[np.repeat(self._begin[name], words) + nth]
        body[at + level_at] = level  # last, as it may stand within a name's last word
        return ENCODING + body[: int(at[-1] + size[-1]) if len(at) else len(head)].tobytes()
