"""Contacts of boxes and spheres with the half-space below a horizontal plane."""

from drone_engine.kernel import kernel


@kernel
def contact(position, axes, half, i, height, margin, point, separation, feature):
    """Writes the corners of box i at most `margin` m above the plane; returns how many there are, 0 to 8.

    position, half: (n, 3); axes: (n, 3, 3), one a row; height: of the plane, m. Out: point (8, 3) m in the world,
    midway between corner and plane; separation (8,) m, negative below the plane; feature (8,), the corner.
    """
    found = 0
    for corner in range(8):
        su = half[i, 0] if corner & 1 else -half[i, 0]
        sv = half[i, 1] if corner & 2 else -half[i, 1]
        sw = half[i, 2] if corner & 4 else -half[i, 2]
        z = position[i, 2] + su * axes[i, 0, 2] + sv * axes[i, 1, 2] + sw * axes[i, 2, 2]
        if z - height > margin:
            continue
        for k in range(2):
            point[found, k] = position[i, k] + su * axes[i, 0, k] + sv * axes[i, 1, k] + sw * axes[i, 2, k]
        point[found, 2] = 0.5 * (z + height)
        separation[found] = z - height
        feature[found] = corner
        found += 1
    return found


@kernel
def contact_sphere(position, half, i, height, margin, point, separation, feature):
    """Writes the lowest point of the bounding sphere of box i, if it is at most `margin` m above the plane; returns the
    number of points, 0 or 1. Parameters as in `contact`."""
    radius = (half[i, 0] * half[i, 0] + half[i, 1] * half[i, 1] + half[i, 2] * half[i, 2]) ** 0.5
    s = position[i, 2] - radius - height
    if s > margin:
        return 0
    point[0, 0], point[0, 1], point[0, 2] = position[i, 0], position[i, 1], height + 0.5 * s
    separation[0], feature[0] = s, 0
    return 1
