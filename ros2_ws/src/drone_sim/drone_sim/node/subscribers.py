"""Which topics somebody listens to, where there may be a thousand of them."""

from collections.abc import Callable, Mapping
from itertools import cycle, islice

AT_ONCE = 100  # topics asked about in a step; asking for a thousand takes as long as the step itself


class Audience:
    """The topics that are heard, by what was found when each was asked about last."""

    def __init__(self, count: Mapping[str, Callable[[], int]]) -> None:
        """count: by topic, what tells how many listen to it."""
        self.heard: set[str] = set()
        self._turn = cycle(count.items())
        self._share = min(AT_ONCE, len(count))

    def look(self) -> None:
        """Asks about the topics whose turn it is: about all where there are few."""
        for topic, count in islice(self._turn, self._share):
            if count():
                self.heard.add(topic)
            else:
                self.heard.discard(topic)
