"""The quality of service of topics."""

from collections.abc import Sequence

from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)  # late subscribers get the last message
NEWEST = QoSProfile(depth=1)  # a message replaces one that has not been processed yet
RELIABLE = QoSProfile(depth=100)

# The executor would poll the events of every publisher in every round, which is slow for many publishers. A subscriber
# that asks for more than a publisher offers is warned in its own process anyway.
NO_CALLBACKS = PublisherEventCallbacks(use_default_callbacks=False)


def strongest_common(publishers: Sequence[TopicEndpointInfo]) -> QoSProfile:
    """The strongest QoS that all publishers of a topic offer; best effort and volatile if there are none.

    So a subscriber receives the messages of every publisher, and latched messages if all of them latch.
    """
    offers = [publisher.qos_profile for publisher in publishers]
    reliable = bool(offers) and all(offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers)
    latched = bool(offers) and all(offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers)
    return QoSProfile(
        depth=100 if reliable else 10,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
