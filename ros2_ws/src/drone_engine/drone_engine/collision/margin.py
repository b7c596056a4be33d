"""Speculative margin: how far apart two bodies may be and still get a contact."""

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.kernel import kernel

MARGIN = 0.01  # m; pairs this close are in contact already, so that resting contacts do not come and go


@kernel
def contact_margins(count, pair_a, pair_b, floor_height, velocity, angular_velocity, bounding_radius, dt, ccd, margin,
                    swept):
    """Writes the margin of the first `count` pairs, m: MARGIN, plus how far the two may approach within dt.

    A pair with a body of `ccd` (n,) and without a floor gets MARGIN alone and is marked in `swept` (count,), as its
    contacts are found by a sweep; with a floor, rotation counts as well. Returns how many pairs are swept.
    floor_height: (count,) m, NaN without a floor; velocity, angular_velocity: (n, 3) m/s and rad/s, world;
    bounding_radius: (n,) m; dt: s.
    """
    swept_count = 0
    for k in range(count):
        a, b = pair_a[k], pair_b[k]
        margin[k] = MARGIN
        swept[k] = (ccd[a] or ccd[b]) and np.isnan(floor_height[k])
        swept_count += swept[k]
        if not swept[k]:
            relative, angular_a, angular_b = 0.0, 0.0, 0.0  # squares
            for c in range(3):
                relative += (velocity[b, c] - velocity[a, c]) ** 2
                angular_a, angular_b = (angular_a + angular_velocity[a, c] ** 2,
                                        angular_b + angular_velocity[b, c] ** 2)
            margin[k] += dt * np.sqrt(relative)
            if not np.isnan(floor_height[k]):
                margin[k] += dt * (np.sqrt(angular_a) * bounding_radius[a] + np.sqrt(angular_b) * bounding_radius[b])
    return swept_count


def largest_approach(velocity: Floats, angular_velocity: Floats, bounding_radius: Floats, a: Integers, b: Integers,
                     dt: float) -> Floats:
    """How far pairs of bodies a and b (k,) may approach anywhere within dt s, (k,) m: what swings round reaches at most
    the far side of the smaller body.

    velocity, angular_velocity: (n, 3) m/s and rad/s, world; bounding_radius: (n,) m.
    """
    linear = np.linalg.norm(velocity[b] - velocity[a], axis=1)
    swing = np.linalg.norm(angular_velocity, axis=1) * bounding_radius
    approach: Floats = dt * (linear + swing[a] + swing[b])
    return np.minimum(approach, 2.0 * np.minimum(bounding_radius[a], bounding_radius[b]))
