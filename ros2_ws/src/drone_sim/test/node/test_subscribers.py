"""What nobody listens to is found out, a share of the topics at a time; and is not said."""

from collections import Counter
from collections.abc import Callable

from drone_engine.world import World
from drone_sim.node.subscribers import TOPICS_PER_REFRESH, Subscribers
from drone_sim.wire.telemetry import Telemetry


def test_few_topics_are_known_at_once() -> None:
    listeners = {"a": 0, "b": 0}
    subscribers = Subscribers({topic: lambda topic=topic: listeners[topic] for topic in listeners})
    subscribers.refresh()
    assert subscribers.topics == set()
    listeners["b"] = 2
    subscribers.refresh()
    assert subscribers.topics == {"b"}
    listeners["b"] = 0
    subscribers.refresh()
    assert subscribers.topics == set()


def test_many_topics_have_their_turn() -> None:
    asked: Counter[int] = Counter()
    subscribers = Subscribers({str(i): lambda i=i: asked.update([i]) or i % 2 for i in range(3 * TOPICS_PER_REFRESH)})
    subscribers.refresh()
    assert asked.total() == TOPICS_PER_REFRESH
    subscribers.refresh()
    subscribers.refresh()
    assert set(asked.values()) == {1}
    assert subscribers.topics == {str(i) for i in range(1, 3 * TOPICS_PER_REFRESH, 2)}


def test_no_topics_are_no_error() -> None:
    Subscribers({}).refresh()


def test_only_what_is_heard_is_said(world: Callable[..., World]) -> None:
    w = world("crate: {model: crate, mass: 1, poses: [[0, 0, 0], [2, 0, 0]]}\n"
              "drone: {model: drone, mass: 1, pose: [5, 0, 2], flight: {}}\n"
              "floor: {model: floor, static: true, collision: {level: floor}}")
    telemetry = Telemetry(w)
    w.step()
    everything = [topic for topic, _ in telemetry.messages(telemetry.topics)]
    assert sorted(everything) == sorted(telemetry.topics)
    assert [topic for topic, _ in telemetry.messages(set())] == ["/clock", "tf"]
    some = {"crate_1/pose", "collisions"}
    assert [topic for topic, _ in telemetry.messages(some)] == ["/clock", "tf", "crate_1/pose", "collisions"]
