"""Which topics have subscribers, at a bounded cost for a thousand topics."""

from collections.abc import Callable, Mapping
from itertools import cycle, islice

TOPICS_PER_REFRESH = 100  # counting the subscribers of a thousand topics takes as long as a step


class Subscribers:
    """The topics that have subscribers, as of the last time that each topic was checked."""

    def __init__(self, count: Mapping[str, Callable[[], int]]) -> None:
        """count: for each topic a function that returns its number of subscribers."""
        self.topics: set[str] = set()
        self._next = cycle(count.items())
        self._per_refresh = min(TOPICS_PER_REFRESH, len(count))

    def refresh(self) -> None:
        """Checks the next TOPICS_PER_REFRESH topics in turn; all of them if there are fewer."""
        for topic, count in islice(self._next, self._per_refresh):
            if count():
                self.topics.add(topic)
            else:
                self.topics.discard(topic)
