"""Random numbers that are a function of where they are asked for: of a stream and a position in it.

So the order in which bodies are visited, and who sleeps, do not matter, and a run repeats from any state. The n-th
number of a stream is the n-th output of splitmix64 (Steele, Lea, Flood 2014, Fast Splittable Pseudorandom Number
Generators) seeded with the stream; normal numbers come of pairs of them (Box, Muller 1958).
"""

import hashlib
import math
from collections.abc import Iterable

import numpy as np

from drone_engine.arrays import Integers
from drone_engine.kernel import kernel

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
FIRST, SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
S30, S27, S31, S11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)


@kernel
def bits(stream, position):
    """64 random bits, unsigned; stream, position: whole numbers."""
    z = np.uint64(stream) + GOLDEN * np.uint64(position + 1)
    z = (z ^ (z >> S30)) * FIRST
    z = (z ^ (z >> S27)) * SECOND
    return z ^ (z >> S31)


@kernel
def uniform(stream, position):
    """A number from 0 to 1, neither of which it ever is."""
    return (np.float64(bits(stream, position) >> S11) + 0.5) * 2.0**-53


@kernel
def normals(stream, position):
    """Two independent standard normal numbers; the next two are at the next position."""
    radius = math.sqrt(-2.0 * math.log(uniform(stream, 2 * position)))
    angle = 2.0 * math.pi * uniform(stream, 2 * position + 1)
    return radius * math.cos(angle), radius * math.sin(angle)


def streams(seed: int, effect: str, names: Iterable[str]) -> Integers:
    """A stream (n,) for each body. It hangs on the body's name: another body in the scene changes no other's luck."""
    digests = (hashlib.sha256(f"{seed}/{effect}/{name}".encode()).digest() for name in names)
    return np.array([int.from_bytes(digest[:8], "little", signed=True) for digest in digests], np.int64)
