"""Narrow phase of a step for what is not a mesh: boxes, spheres and floors, pair by pair."""

from typing import NamedTuple

import numpy as np

from drone_sim.arrays import Floats, Integers
from drone_sim.collision import floor, obb, sphere
from drone_sim.kernel import kernel
from drone_sim.model import SPHERE
from drone_sim.rotation import matrix

MARGIN = 0.01  # m; pairs this close are contacts already, so that resting ones do not come and go


class Placed(NamedTuple):
    """Bodies where they are; SI units, frame of the world."""

    body: Integers  # (n,) which of the scene's
    position: Floats  # (n, 3) of the boxes' centres
    orientation: Floats  # (n, 4) x y z w
    axes: Floats  # (n, 3, 3) of the boxes, one a row
    half: Floats  # (n, 3) of the boxes; inf: a floor


@kernel
def axes_of(orientation, axes):
    """Writes the boxes' axes in the world, (n, 3, 3), one a row."""
    for i in range(orientation.shape[0]):
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for k in range(3):
            axes[i, k, 0], axes[i, k, 1], axes[i, k, 2] = m[k], m[3 + k], m[6 + k]


@kernel
def margins(pair_a, pair_b, floor_height, velocity, dt, quick, margin, swept):
    """Writes how far apart the bodies of each pair are contacts: MARGIN and the way that they may approach in a step.
    Without that way where one is quick and neither a floor: these are marked as swept. Returns how many are."""
    count = 0
    for k in range(pair_a.shape[0]):
        a, b = pair_a[k], pair_b[k]
        margin[k] = MARGIN
        swept[k] = (quick[a] or quick[b]) and np.isnan(floor_height[k])
        count += swept[k]
        if not swept[k]:
            square = 0.0
            for c in range(3):
                square += (velocity[b, c] - velocity[a, c]) ** 2
            margin[k] += dt * np.sqrt(square)
    return count


@kernel
def keep_deepest(point, separation, feature, count):
    """Makes the deepest of the points the first."""
    best = 0
    for k in range(1, count):
        if separation[k] < separation[best]:
            best = k
    separation[0], feature[0] = separation[best], feature[best]
    for c in range(3):
        point[0, c] = point[best, c]


@kernel
def find_contacts(position, axes, half, pair_a, pair_b, floor_height, level, everything, margins, scratch,
                  pair, points, normal, point, separation, feature, met, found):
    """Appends the manifolds of pairs at levels SPHERE and OBB after the first `found`, returns how many there are then;
    a pair whose floor_height is not NaN is a body and a floor."""
    for k in range(pair_a.shape[0]):
        if level[k] < SPHERE:
            continue
        a, b = pair_a[k], pair_b[k]
        margin = margins[k]
        n, p, s, f = normal[found], point[found], separation[found], feature[found]
        if not np.isnan(floor_height[k]):
            body, up = (b, 1.0) if half[a, 0] == np.inf else (a, -1.0)
            n[0], n[1], n[2] = 0.0, 0.0, up
            if level[k] == SPHERE:
                count = floor.contact_sphere(position, half, body, floor_height[k], margin, p, s, f)
            else:
                count = floor.contact(position, axes, half, body, floor_height[k], margin, p, s, f)
        elif level[k] == SPHERE:
            count = sphere.contact(position, half, a, b, margin, n, p, s, f)
        else:
            count = obb.contact(position, axes, half, a, position, axes, half, b, margin, found, points, normal, point,
                                separation, feature, *scratch)
        if count:
            if not everything[k]:
                keep_deepest(p, s, f, count)
                count = 1
            pair[found, 0], pair[found, 1] = a, b
            points[found], met[found] = count, level[k]
            found += 1
    return found
