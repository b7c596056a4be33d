"""Bounding spheres."""

from drone_sim.kernel import kernel


@kernel
def contact(position, half, a, b, margin, normal, point, separation, feature):
    """The contact of the bounding spheres of boxes a and b."""
    ra = (half[a, 0] ** 2 + half[a, 1] ** 2 + half[a, 2] ** 2) ** 0.5
    rb = (half[b, 0] ** 2 + half[b, 1] ** 2 + half[b, 2] ** 2) ** 0.5
    dx, dy, dz = position[b, 0] - position[a, 0], position[b, 1] - position[a, 1], position[b, 2] - position[a, 2]
    d = (dx * dx + dy * dy + dz * dz) ** 0.5
    s = d - ra - rb
    if s > margin:
        return 0
    if d > 0.0:
        normal[0], normal[1], normal[2] = dx / d, dy / d, dz / d
    else:
        normal[0], normal[1], normal[2] = 0.0, 0.0, 1.0
    for k in range(3):
        point[0, k] = position[a, k] + (ra + 0.5 * s) * normal[k]
    separation[0], feature[0] = s, 0
    return 1
