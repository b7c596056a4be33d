"""Counter-based random numbers: each is a function of a stream and a position in it.

Their values depend neither on the order of the bodies nor on which bodies sleep, and a run repeats from any state. The
n-th number of a stream is the n-th output of splitmix64 (Steele, Lea, Flood 2014, Fast Splittable Pseudorandom Number
Generators) seeded with the stream; pairs of them give normal numbers (Box, Muller 1958).
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
    """64 random bits, unsigned; stream, position: int64."""
    z = np.uint64(stream) + GOLDEN * np.uint64(position + 1)
    z = (z ^ (z >> S30)) * FIRST
    z = (z ^ (z >> S27)) * SECOND
    return z ^ (z >> S31)


@kernel
def uniform(stream, position):
    """Uniform on the open interval (0, 1)."""
    return (np.float64(bits(stream, position) >> S11) + 0.5) * 2.0**-53


@kernel
def normals(stream, position):
    """Two independent standard normal numbers; the next two are at the next position."""
    radius = math.sqrt(-2.0 * math.log(uniform(stream, 2 * position)))
    angle = 2.0 * math.pi * uniform(stream, 2 * position + 1)
    return radius * math.cos(angle), radius * math.sin(angle)


def streams(seed: int, effect: str, names: Iterable[str]) -> Integers:
    """A stream for each of n names, (n,). It is seeded by the name, so that adding a body does not change the random
    stream of any other."""
    digests = (hashlib.sha256(f"{seed}/{effect}/{name}".encode()).digest() for name in names)
    return np.array([int.from_bytes(digest[:8], "little", signed=True) for digest in digests], np.int64)
