"""The subcommands. Each takes a node and the parsed arguments, and raises TopicError for a mistake of the user."""

import argparse
import time
from collections import deque
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any

import rclpy
import yaml
from rclpy.node import Node

from drone_sim.node.qos import strongest_common
from drone_sim.topic.message_yaml import FieldError, as_data, dump, fill, pick
from drone_sim.wire.message_types import UnknownTypeError, full_name, message_class

DISCOVERY = 5.0  # s within which a topic has to be discovered; publishers announce themselves at least every 3 s
SETTLING = 1.0  # s without a new topic after which discovery counts as complete


class TopicError(Exception):
    """A mistake in a command, in one line."""


def list_topics(node: Node, arguments: argparse.Namespace) -> None:
    """Prints the names of all topics once discovery is complete."""
    _spin_until(node, _settled(node), DISCOVERY)
    for name, types in sorted(_topics(node).items()):
        print(f"{name} [{', '.join(types)}]" if arguments.types else name)


def info(node: Node, arguments: argparse.Namespace) -> None:
    """Prints the type of a topic, its publishers and its subscribers."""
    topic = node.resolve_topic_name(arguments.topic)
    print(f"Type: {_type(node, topic)}")
    _spin_until(node, lambda: bool(node.get_publishers_info_by_topic(topic)), DISCOVERY)
    _spin_until(node, lambda: False, SETTLING)
    for title, endpoints in (
        ("Publishers", node.get_publishers_info_by_topic(topic)),
        ("Subscribers", node.get_subscriptions_info_by_topic(topic)),
    ):
        print(f"{title}: {len(endpoints)}")
        for endpoint in endpoints:
            qos = endpoint.qos_profile
            name = f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"
            print(f"  {name} ({qos.reliability.name.lower()}, {qos.durability.name.lower()})")


def echo(node: Node, arguments: argparse.Namespace) -> None:
    """Prints messages as YAML, with '---' after each."""
    topic = node.resolve_topic_name(arguments.topic)
    kind = _class(arguments.type or _type(node, topic))
    if arguments.field:
        _checked(lambda: pick(kind(), arguments.field))
    printed = 0

    def show(message: Any) -> None:
        nonlocal printed
        if arguments.count and printed == arguments.count:
            return
        value = pick(message, arguments.field) if arguments.field else message
        print(dump(as_data(value, full=arguments.full)) + "---", flush=True)
        printed += 1

    node.create_subscription(kind, topic, show, strongest_common(node.get_publishers_info_by_topic(topic)))
    _spin_until(node, lambda: bool(arguments.count) and printed == arguments.count)


def hz(node: Node, arguments: argparse.Namespace) -> None:
    """Prints the rate of a topic once a second. Messages are not deserialized, so that large ones cost no time."""
    topic = node.resolve_topic_name(arguments.topic)
    kind = _class(_type(node, topic))
    arrivals: deque[float] = deque(maxlen=arguments.window + 1)
    node.create_subscription(
        kind, topic, lambda _: arrivals.append(time.monotonic()),
        strongest_common(node.get_publishers_info_by_topic(topic)), raw=True,
    )
    while True:
        before = arrivals[-1] if arrivals else 0.0
        _spin_until(node, lambda: False, 1.0)
        if len(arrivals) < 2 or arrivals[-1] == before:
            print("no new messages", flush=True)
            continue
        gaps = [later - earlier for earlier, later in zip(arrivals, list(arrivals)[1:], strict=False)]
        rate = len(gaps) / (arrivals[-1] - arrivals[0])
        print(f"average rate: {rate:.3f}\n\tmin: {min(gaps):.3f}s max: {max(gaps):.3f}s window: {len(gaps)}",
              flush=True)


def pub(node: Node, arguments: argparse.Namespace) -> None:
    """Publishes a message given as YAML, once or at a rate in Hz."""
    kind = _class(arguments.type)
    try:
        values = yaml.safe_load(arguments.message)
    except yaml.YAMLError as error:
        raise TopicError(f"message: expected YAML: {getattr(error, 'problem', None) or error}") from None
    message = kind()
    _checked(lambda: fill(message, {} if values is None else values))
    publisher = node.create_publisher(kind, arguments.topic, 10)
    if arguments.once:
        if not _spin_until(node, lambda: publisher.get_subscription_count() > 0, DISCOVERY):
            raise TopicError(f"{publisher.topic_name}: expected a subscriber within {DISCOVERY:g} s, got none")
        publisher.publish(message)
        publisher.wait_for_all_acked()
        return
    print(f"publishing {publisher.topic_name} at {arguments.rate:g} Hz; Ctrl-C to stop", flush=True)
    node.create_timer(1.0 / arguments.rate, lambda: publisher.publish(message))
    _spin_until(node, lambda: False)


def _topics(node: Node) -> dict[str, list[str]]:
    return dict(node.get_topic_names_and_types())


def _type(node: Node, topic: str) -> str:
    """The type of a topic in the graph."""
    _spin_until(node, lambda: topic in _topics(node), DISCOVERY)
    topics = _topics(node)
    if topic in topics:
        return topics[topic][0]
    similar = get_close_matches(topic, topics, cutoff=0.5) or [name for name in topics if topic.strip("/") in name]
    hint = f"similar: {', '.join(similar[:5])}" if similar else "see `topic list`"
    raise TopicError(f"no topic {topic}; {hint}")


def _class(name: str) -> type[Any]:
    try:
        return message_class(full_name(name))
    except UnknownTypeError as error:
        raise TopicError(str(error)) from None


def _checked(action: Callable[[], object]) -> None:
    try:
        action()
    except FieldError as error:
        raise TopicError(str(error)) from None


def _settled(node: Node) -> Callable[[], bool]:
    """A condition that becomes true when other nodes' topics are known and no new one has appeared for SETTLING."""
    own = seen = _topics(node)
    since = time.monotonic()

    def settled() -> bool:
        nonlocal seen, since
        topics = _topics(node)
        if topics != seen:
            seen, since = topics, time.monotonic()
        return seen != own and time.monotonic() - since > SETTLING

    return settled


def _spin_until(node: Node, condition: Callable[[], bool], timeout: float = float("inf")) -> bool:
    """Runs callbacks until the condition holds (returns True) or the timeout, in s, is over (returns False)."""
    deadline = time.monotonic() + timeout
    while not condition():
        left = deadline - time.monotonic()
        if left <= 0.0 or not rclpy.ok():
            return False
        rclpy.spin_once(node, timeout_sec=min(left, 0.1))
    return True
