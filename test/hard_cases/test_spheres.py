"""The sphere level gives the exact answers on pairs that rounding gets wrong."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drone_engine.collision.box import sphere
from reference.box_families import directions, nudged
from reference.box_oracle import all_spheres_touch, spheres_touch

COUNT = 20_000
Spheres = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def touching(rng: np.random.Generator, n: int, scale: float = 1.0, shift: float = 0.0) -> Spheres:
    """Touching exactly (integer quadruples x^2 + y^2 + z^2 = r^2) or up to rounding, a third of them +-1 ulp."""
    radius_a, radius_b = rng.integers(0, 9, (2, n)) * rng.choice([0.5, 0.1, 1e-3, 1e3], (2, n))
    m, k, p, q = rng.integers(-3, 4, (4, n))
    whole = np.stack([m * m + k * k - p * p - q * q, 2 * (m * q + k * p), 2 * (k * q - m * p)], -1).astype(np.float64)
    length = (m * m + k * k + p * p + q * q).astype(np.float64)
    exactly = rng.random(n) < 0.5
    radius_a, radius_b = np.where(exactly, 0.25 * length, radius_a), np.where(exactly, 0.75 * length, radius_b)
    offset = np.where(exactly[:, None], whole, directions(rng, n) * (radius_a + radius_b)[:, None])
    center_a = rng.integers(-9, 9, (n, 3)) * 0.25 + shift
    spheres = center_a * scale, radius_a * scale, (center_a + offset) * scale, radius_b * scale
    moved = nudged(rng, *spheres)
    return tuple(np.where((rng.random(n) < 0.3).reshape(-1, *[1] * (x.ndim - 1)), y, x)  # type: ignore[return-value]
                 for x, y in zip(spheres, (moved[0], np.abs(moved[1]), moved[2], np.abs(moved[3])), strict=True))


@pytest.mark.parametrize(("scale", "shift"), [(1.0, 0.0), (1.0, 1e6), (2.0**-1070, 0.0), (2.0**-540, 0.0),
                                            (2.0**1000, 0.0)])
def test_no_answer_differs_from_exact_arithmetic(scale: float, shift: float) -> None:
    spheres = touching(np.random.default_rng(4), COUNT, scale, shift)
    expected = all_spheres_touch(*spheres)
    assert 0.2 < expected.mean() < 0.9
    np.testing.assert_array_equal(sphere.intersects(*spheres), expected)
    np.testing.assert_array_equal(sphere.intersects(*spheres[2:], *spheres[:2]), expected)


number = st.one_of(st.integers(-9, 9).map(float), st.floats(allow_nan=False, allow_infinity=False))


@given(*[number] * 8)
@settings(max_examples=300, deadline=None)
def test_arbitrary_spheres(ax: float, ay: float, az: float, ra: float, bx: float, by: float, bz: float,
                          rb: float) -> None:
    a, b = np.array([ax, ay, az]), np.array([bx, by, bz])
    answer = sphere.intersects(a[None], np.array([abs(ra)]), b[None], np.array([abs(rb)]))[0]
    assert answer == spheres_touch(a, abs(ra), b, abs(rb))
