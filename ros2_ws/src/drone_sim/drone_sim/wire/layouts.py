"""Layouts of the messages that the simulation publishes every step. Quoted names are those for `Message.write`."""

import struct
from collections.abc import Iterable, Sequence

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_sim.wire.cdr import ENCODING, SECOND, Layout, Message


def clock() -> Message:
    """rosgraph_msgs/Clock."""
    return Layout().stamp().message()


def pose_stamped(frame: str) -> Message:
    """geometry_msgs/PoseStamped; 'pose': x y z qx qy qz qw."""
    return Layout().header(frame).float64("pose", 7).message()


def odometry(frame: str, child: str) -> Message:
    """nav_msgs/Odometry; 'pose': x y z qx qy qz qw; 'twist': linear, angular, in the child's frame; covariances 0."""
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


SPHERE, LINE_LIST = 2, 5  # Marker.SPHERE and Marker.LINE_LIST
ADD = 0  # Marker.ADD
LIFETIME = 500_000_000  # ns after which a marker that is not published again disappears
# The fields after a marker's color, which ends at a multiple of 8: lifetime, frame_locked, number of points.
_MIDDLE = struct.Struct("<IIBxxxI")
# The fields after its points, all empty: colors, texture, texture coordinates, text and mesh. The next marker starts
# at an odd multiple of 4, as the first one does.
MARKER_TAIL = bytes(Layout().uint32(0).string("").header("").string("").uint32(0).uint32(0).string("").string("")
                    .string("").uint32(0).uint8(0).message())[len(ENCODING) :]
_PADDED_TAIL = MARKER_TAIL + bytes((4 - len(MARKER_TAIL)) % 8)


class MarkerLayout:
    """A visualization_msgs/Marker of one color; its color and points may differ in each message.

    pose: x y z qx qy qz qw in the frame, m. scale: (3,) m, the width of lines or the diameters of an ellipsoid.
    """

    def __init__(self, frame: str, name: str, number: int, kind: int, pose: Floats, scale: Sequence[float]) -> None:
        layout = Layout().uint32(0).header(frame).string(name).uint32(number).uint32(kind).uint32(ADD)
        message = layout.float64("pose", 7).float64("scale", 3).message()
        message.write("pose", pose)
        message.write("scale", scale)
        self.head = bytes(message)[len(ENCODING) + 12 :]
        """The bytes between the stamp and the color."""


def marker_array(time_ns: int, markers: Iterable[tuple[MarkerLayout, bytes, bytes]]) -> bytes:
    """visualization_msgs/MarkerArray at a time in ns.

    markers: layout; color as float32 red, green, blue, alpha; points as float64 x, y, z, m.
    """
    stamp, life = struct.pack("<II", *divmod(time_ns, SECOND)), divmod(LIFETIME, SECOND)
    parts = [part for marker, color, points in markers
             for part in (stamp, marker.head, color, _MIDDLE.pack(*life, 1, len(points) // 24), points, _PADDED_TAIL)]
    body = b"".join(parts)
    return ENCODING + struct.pack("<I", len(parts) // 6) + body[: len(body) - len(_PADDED_TAIL) + len(MARKER_TAIL)]


class CollisionEvents:
    """drone_interfaces/CollisionEvents among bodies with these names, laid out for the events of each step.

    An event is a phase, two names, a level and eight float64; so the next event starts at a multiple of 8.
    """

    def __init__(self, names: Sequence[str], frame: str = "world") -> None:
        texts = [name.encode() + b"\0" for name in names]
        padded = [struct.pack("<I", len(text)) + text + bytes(-len(text) % 4) for text in texts]
        self._names = np.frombuffer(b"".join(padded), "<u4")
        self._words = np.array([len(name) // 4 for name in padded], np.int64)  # uint32 of each name and its length
        self._begin = np.cumsum(self._words) - self._words
        self._bare = np.array([4 + len(text) for text in texts], np.int64)  # bytes of each name without padding
        self._frame = frame

    def message(self, time_ns: int, step: int, phase: Integers, pairs: Integers, level: Integers,
                numbers: Floats) -> bytes:
        """The serialized message of n events at a time in ns.

        phase, level: (n,). pairs: (n, 2) bodies. numbers: (n, 8) point, normal, depth, impulse, SI units.
        """
        top = Layout().header(self._frame).uint64(step).uint32(len(phase)).message()
        top.stamp(time_ns)
        head = bytes(top)[len(ENCODING) :]
        a, b = pairs.T
        shift = np.zeros(len(phase), np.int64)
        shift[:1] = len(head) % 8  # the first event may start between two multiples of 8
        level_at = shift + 4 + 4 * self._words[a] + self._bare[b]  # relative to the multiple of 8
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
            nth = np.arange(words.sum()) - np.repeat(np.cumsum(words) - words, words)  # index of the word in its name
            body.view("<u4")[np.repeat(place, words) + nth] = self._names[np.repeat(self._begin[name], words) + nth]
        body[at + level_at] = level  # last, because it may be in the last word of a name
        return ENCODING + body[: int(at[-1] + size[-1]) if len(at) else len(head)].tobytes()
