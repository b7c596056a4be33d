"""Reduction of many contacts of a pair to few manifolds: groups of similar normals, in each group the points that are
deep and far apart."""

from drone_engine.collision.manifold import POINTS
from drone_engine.kernel import kernel

MAX_MANIFOLDS = 6  # of a pair; concave bodies touch on several sides
SAME_GROUP_COSINE = 0.97  # of the angle between normals of one group
SAME_POINT_DISTANCE = 1e-4  # m; points closer than this count as one
DEPTH_WEIGHT = 1.0  # distance from the other points, m, that counts as much as 1 m of depth


@kernel
def deepest(count, separation, free):
    """The index of the contact with the smallest separation among those of the first `count` that are not in a group
    yet, -1 if there is none."""
    best = -1
    for i in range(count):
        if free[i] and (best < 0 or separation[i] < separation[best]):
            best = i
    return best


@kernel
def reduce_contacts(count, found, max_manifolds, max_points, free, spread, out, first):
    """Writes at most max_manifolds manifolds of at most max_points points each to rows `first` on of `out`; returns
    their number.

    found: ContactBuffer with `count` contacts. free, spread: (k,) scratch, k >= count. out: ContactArrays; point,
    normal, separation, feature and points are written.
    """
    normal, separation = found.normal, found.separation
    for i in range(count):
        free[i] = True
    made = 0
    while made < max_manifolds:
        seed = deepest(count, separation, free)
        if seed < 0:
            break
        for c in range(3):
            out.normal[first + made, c] = normal[seed, c]
        for i in range(count):
            if free[i]:
                similar = (normal[i, 0] * normal[seed, 0] + normal[i, 1] * normal[seed, 1]
                           + normal[i, 2] * normal[seed, 2]) >= SAME_GROUP_COSINE
                free[i] = not similar
                spread[i] = 1e300 if similar else -1e300
            else:
                spread[i] = -1e300
        out.points[first + made] = select_points(count, found, max_points, seed, spread, DEPTH_WEIGHT, out,
                                                 first + made)
        made += 1
    return made


@kernel
def select_points(count, found, max_points, seed, spread, depth_weight, out, row):
    """Writes the points of one group to manifold `row` of `out`: contact `seed` first, then each time the point that is
    best by depth and by distance from those before. Returns their number.

    found: ContactBuffer. spread: (k,) squared distance from the points before, m^2: on input large for the group and
    negative for other contacts; overwritten. depth_weight: distance, m, that counts as much as 1 m of depth. out:
    ContactArrays.
    """
    point, separation = found.point, found.separation
    out_point = out.point[row]
    selected, last = 0, seed
    while True:
        for k in range(3):
            out_point[selected, k] = 0.5 * (point[last, 0, k] + point[last, 1, k])
        out.separation[row, selected], out.feature[row, selected] = separation[last], found.feature[last]
        selected += 1
        if selected == min(max_points, POINTS):
            return selected
        best, most = -1, SAME_POINT_DISTANCE
        for i in range(count):
            if spread[i] < 0.0:
                continue
            square = 0.0
            for k in range(3):
                square += (0.5 * (point[i, 0, k] + point[i, 1, k]) - out_point[selected - 1, k]) ** 2
            spread[i] = min(spread[i], square)
            value = spread[i] ** 0.5 - depth_weight * (separation[i] - separation[seed])
            if value > most and spread[i] > SAME_POINT_DISTANCE * SAME_POINT_DISTANCE:
                best, most = i, value
        if best < 0:
            return selected
        last = best
