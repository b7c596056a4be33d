"""Many contacts of one pair become few: groups of like normals, in each the points that are deep and far apart."""

from drone_engine.collision.manifold import POINTS
from drone_engine.kernel import kernel

MOST = 6  # manifolds of a pair; what is concave is touched from a few sides at once
LIKE = 0.97  # cosine of the angle between normals of one group
SAME = 1e-4  # m; points this close are one
DEPTH_WORTH = 1.0  # how many m of distance from the other points one m of depth is worth


@kernel
def deepest(count, separation, free):
    """The index of the free contact with the least separation, -1 if none is free."""
    best = -1
    for i in range(count):
        if free[i] and (best < 0 or separation[i] < separation[best]):
            best = i
    return best


@kernel
def reduce(count, normal, point, separation, feature, most, most_points, free, spread, out_normal, out_point,
           out_separation, out_feature, out_points):
    """Writes at most `most` manifolds of at most `most_points` points each; returns how many.

    normal: (k, 3) unit; point: (k, 2, 3) on both bodies; separation, feature: (k,), k >= count. free, spread: (k,)
    scratch. The outputs are rows of Manifolds, `most` of them or more.
    """
    for i in range(count):
        free[i] = True
    made = 0
    while made < most:
        seed = deepest(count, separation, free)
        if seed < 0:
            break
        out_normal[made] = normal[seed]
        for i in range(count):
            if free[i]:
                like = (normal[i, 0] * normal[seed, 0] + normal[i, 1] * normal[seed, 1]
                        + normal[i, 2] * normal[seed, 2]) >= LIKE
                free[i] = not like
                spread[i] = 1e300 if like else -1e300
            else:
                spread[i] = -1e300
        out_points[made] = pick(count, point, separation, feature, most_points, seed, spread, DEPTH_WORTH,
                                out_point[made], out_separation[made], out_feature[made])
        made += 1
    return made


@kernel
def pick(count, point, separation, feature, most, seed, spread, worth_of_depth, out_point, out_separation,
         out_feature):
    """Writes the points of one group, each the farthest from those before; spread: squared distance from them,
    negative for contacts of other groups; worth_of_depth: of one m of depth, in m from the other points."""
    picked, last = 0, seed
    while True:
        for k in range(3):
            out_point[picked, k] = 0.5 * (point[last, 0, k] + point[last, 1, k])
        out_separation[picked], out_feature[picked] = separation[last], feature[last]
        picked += 1
        if picked == min(most, POINTS):
            return picked
        best, worth = -1, SAME
        for i in range(count):
            if spread[i] < 0.0:
                continue
            square = 0.0
            for k in range(3):
                square += (0.5 * (point[i, 0, k] + point[i, 1, k]) - out_point[picked - 1, k]) ** 2
            spread[i] = min(spread[i], square)
            value = spread[i] ** 0.5 - worth_of_depth * (separation[i] - separation[seed])
            if value > worth and spread[i] > SAME * SAME:
                best, worth = i, value
        if best < 0:
            return picked
        last = best
