"""Begin, persist and end: how the contacts of a step differ from those of the step before."""

from enum import IntEnum
from typing import NamedTuple

from drone_sim.collision.detection import Detection
from drone_sim.collision.manifold import Manifolds

Vector = tuple[float, float, float]


class Phase(IntEnum):
    """As drone_interfaces/CollisionEvent numbers them."""

    BEGIN = 0
    PERSIST = 1
    END = 2


class Event(NamedTuple):
    """One pair of bodies, by index, a < b. m, N s; the normal points from a to b; world frame."""

    phase: Phase
    a: int
    b: int
    level: int
    point: Vector
    normal: Vector
    depth: float
    impulse: float


class Events:
    """The stage that compares; `current` are the events of the step."""

    def __init__(self, detection: Detection) -> None:
        self._detection = detection
        self._touching: dict[tuple[int, int], Event] = {}
        self.current: list[Event] = []

    def clear(self) -> None:
        """Forgets who touches whom."""
        self._touching, self.current = {}, []

    def __call__(self) -> None:
        now = _touching(self._detection.manifolds)
        before = self._touching
        self.current = [event._replace(phase=Phase.PERSIST if pair in before else Phase.BEGIN)
                        for pair, event in now.items()]
        self.current += [event._replace(phase=Phase.END) for pair, event in before.items() if pair not in now]
        self._touching = now


def _touching(m: Manifolds) -> dict[tuple[int, int], Event]:
    """Pairs that overlap or push each other; being near is not touching."""
    touching: dict[tuple[int, int], Event] = {}
    for i in range(m.count):
        points = int(m.points[i])
        deepest = int(m.separation[i, :points].argmin())
        depth = -float(m.separation[i, deepest])
        impulse = float(m.total[i, :points].sum())
        if depth < 0.0 and impulse <= 0.0:
            continue
        a, b = (int(body) for body in m.pair[i])
        event = Event(Phase.BEGIN, a, b, int(m.level[i]), tuple(m.point_w[i, deepest].tolist()),
                      tuple(m.normal_w[i].tolist()), max(depth, 0.0), impulse)
        if other := touching.get((a, b)):  # meshes touch on several sides
            deeper = event if event.depth > other.depth else other
            event = deeper._replace(impulse=event.impulse + other.impulse)
        touching[a, b] = event
    return touching
