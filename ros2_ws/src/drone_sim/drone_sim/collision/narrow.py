"""Narrow phase of a step for what is not a mesh: boxes, spheres and floors, pair by pair."""

import numpy as np

from drone_sim.collision import floor, obb, sphere
from drone_sim.kernel import kernel
from drone_sim.model import SPHERE
from drone_sim.rotation import matrix

MARGIN = 0.01  # m; pairs this close are contacts already, so that resting ones do not come and go


@kernel
def axes_of(orientation, axes):
    """Writes the boxes' axes in the world, (n, 3, 3), one a row."""
    for i in range(orientation.shape[0]):
        m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
        for k in range(3):
            axes[i, k, 0], axes[i, k, 1], axes[i, k, 2] = m[k], m[3 + k], m[6 + k]


@kernel
def margin_of(velocity, a, b, dt):
    """How far apart two bodies are contacts: the way that they may approach in a step, and MARGIN."""
    square = 0.0
    for c in range(3):
        square += (velocity[b, c] - velocity[a, c]) ** 2
    return MARGIN + dt * np.sqrt(square)


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
def find_contacts(position, axes, half, velocity, dt, pair_a, pair_b, floor_height, level, everything, scratch,
                  pair, points, normal, point, separation, feature, origin, met):
    """Writes the manifolds of pairs at levels SPHERE and OBB and returns how many; a pair whose floor_height is not NaN
    is a body and a floor. The margin grows by the way that two approach in a step, so that none is passed through."""
    found = 0
    for k in range(pair_a.shape[0]):
        if level[k] < SPHERE:
            continue
        a, b = pair_a[k], pair_b[k]
        margin = margin_of(velocity, a, b, dt)
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
            count = obb.contact(position, axes, half, a, position, axes, half, b, margin, n, p, s, f, scratch)
        if count:
            if not everything[k]:
                keep_deepest(p, s, f, count)
                count = 1
            pair[found, 0], pair[found, 1] = a, b
            for c in range(3):
                origin[found, 0, c], origin[found, 1, c] = position[a, c], position[b, c]
            points[found], met[found] = count, level[k]
            found += 1
    return found
