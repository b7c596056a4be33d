"""What each subcommand does, given a node and the parsed arguments. All raise TopicError with one line."""

import argparse
import time
from collections import deque
from collections.abc import Callable
from difflib import get_close_matches
from typing import Any

import rclpy
import yaml
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from drone_sim.wire.message_types import UnknownTypeError, full_name, message_class

from .message_yaml import FieldError, as_data, dump, fill, pick

DISCOVERY = 5.0  # s that a topic has to come into view; publishers announce themselves every 3 s at least
SETTLING = 1.0  # s without news, after which all is in view


class TopicError(Exception):
    """What is wrong with a command, in one line."""


def list_topics(node: Node, arguments: argparse.Namespace) -> None:
    """Prints the names of all topics, when no new one has come up for a while."""
    _spin_until(node, _settled(node), DISCOVERY)
    for name, types in sorted(_topics(node).items()):
        print(f"{name} [{', '.join(types)}]" if arguments.types else name)


def info(node: Node, arguments: argparse.Namespace) -> None:
    """Prints the type of a topic, its publishers and its subscribers."""
    topic = node.resolve_topic_name(arguments.topic)
    print(f"Type: {_type(node, topic)}")
    _spin_until(node, lambda: bool(node.get_publishers_info_by_topic(topic)), DISCOVERY)
    _spin_until(node, lambda: False, SETTLING)
    for what, endpoints in (
        ("Publishers", node.get_publishers_info_by_topic(topic)),
        ("Subscribers", node.get_subscriptions_info_by_topic(topic)),
    ):
        print(f"{what}: {len(endpoints)}")
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

    node.create_subscription(kind, topic, show, _offered_qos(node, topic))
    _spin_until(node, lambda: bool(arguments.count) and printed == arguments.count)


def hz(node: Node, arguments: argparse.Namespace) -> None:
    """Prints once a second how often messages arrive. They are not deserialized, so large ones cost no time."""
    topic = node.resolve_topic_name(arguments.topic)
    kind = _class(_type(node, topic))
    arrivals: deque[float] = deque(maxlen=arguments.window + 1)
    node.create_subscription(
        kind, topic, lambda _: arrivals.append(time.monotonic()), _offered_qos(node, topic), raw=True
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
    """Publishes the message that the YAML describes."""
    kind = _class(arguments.type)
    try:
        values = yaml.safe_load(arguments.message)
    except yaml.YAMLError as error:
        raise TopicError(f"the message is no YAML: {getattr(error, 'problem', None) or error}") from None
    message = kind()
    _checked(lambda: fill(message, {} if values is None else values))
    publisher = node.create_publisher(kind, arguments.topic, 10)
    if arguments.once:
        if not _spin_until(node, lambda: publisher.get_subscription_count() > 0, DISCOVERY):
            raise TopicError(f"nobody listens to {publisher.topic_name}")
        publisher.publish(message)
        publisher.wait_for_all_acked()
        return
    print(f"publishes {publisher.topic_name} at {arguments.rate:g} Hz; Ctrl-C ends it", flush=True)
    node.create_timer(1.0 / arguments.rate, lambda: publisher.publish(message))
    _spin_until(node, lambda: False)


def _topics(node: Node) -> dict[str, list[str]]:
    return dict(node.get_topic_names_and_types())


def _type(node: Node, topic: str) -> str:
    """The type of a topic as the graph knows it."""
    _spin_until(node, lambda: topic in _topics(node), DISCOVERY)
    topics = _topics(node)
    if topic in topics:
        return topics[topic][0]
    similar = get_close_matches(topic, topics, cutoff=0.5) or [name for name in topics if topic.strip("/") in name]
    hint = f"; there are {', '.join(similar[:5])}" if similar else "; `topic list` shows what there is"
    raise TopicError(f"no topic {topic}{hint}")


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


def _offered_qos(node: Node, topic: str) -> QoSProfile:
    """As much as all publishers offer that are in view, so that latched messages come too."""
    offers = [endpoint.qos_profile for endpoint in node.get_publishers_info_by_topic(topic)]
    reliable = offers and all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
    kept = offers and all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
    return QoSProfile(
        depth=100,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
    )


def _settled(node: Node) -> Callable[[], bool]:
    """A condition that holds once others' topics have come into view, and no new one for a while."""
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
    """Lets callbacks run until the condition holds (True) or the time, in s, is over (False)."""
    deadline = time.monotonic() + timeout
    while not condition():
        left = deadline - time.monotonic()
        if left <= 0.0 or not rclpy.ok():
            return False
        rclpy.spin_once(node, timeout_sec=min(left, 0.1))
    return True
