"""Times several calls in alternation, so that a slow phase of the machine affects all of them alike."""

import gc
import statistics
from collections.abc import Callable, Mapping
from time import perf_counter, process_time
from typing import NamedTuple


class Times(NamedTuple):
    """Seconds per call: medians of wall time and of CPU time over the rounds, and the shortest wall time."""

    wall: float
    cpu: float
    best: float


def side_by_side(calls: Mapping[str, Callable[[], object]], rounds: int, least: float = 0.05) -> dict[str, Times]:
    """Times of each call, measured in `rounds` rounds that run all calls in turn, after a warm-up.

    least: a call is repeated within a round until it takes at least this long, s.
    """
    repeats = {}
    for name, call in calls.items():
        call()
        start = perf_counter()
        call()
        repeats[name] = max(1, int(least / max(perf_counter() - start, 1e-9)))
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    gc.collect()
    gc.disable()
    try:
        for _ in range(rounds):
            for name, call in calls.items():
                wall, cpu = perf_counter(), process_time()
                for _ in range(repeats[name]):
                    call()
                taken[name].append(((perf_counter() - wall) / repeats[name], (process_time() - cpu) / repeats[name]))
    finally:
        gc.enable()
    return {name: Times(statistics.median(wall for wall, _ in times), statistics.median(cpu for _, cpu in times),
                        min(wall for wall, _ in times)) for name, times in taken.items()}
