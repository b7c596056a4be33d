"""Graph coloring of the contact constraints: constraints of one color share no moving body and are solved together."""

from drone_engine.dynamics.contact_table import LANES, POINTS
from drone_engine.kernel import inlined, kernel

COLORS = 64  # as many as an int64 has bits
HALF = COLORS // 2  # colors from here on are of constraints with one moving body


@kernel
def assign_colors(count, pair, points, inverse_mass, used, size, color):
    """Gives both constraints of each manifold a color, greedily: the lowest that no constraint of its bodies has.

    Constraints of two moving bodies get the colors up to HALF, those of one moving body the others, which are solved
    last, so that bodies on the ground end an iteration without penetrating it. The last color of each half has no
    guarantee: its constraints may share bodies.

    count: of manifolds; pair: (m, 2) bodies; points: (m,) of each manifold; inverse_mass: (n,) 1/kg. used: (n, 2)
    int64 scratch, all 0 before and after. Out: size, (COLORS,) constraints of each color; color, (m, 2), -1 for a
    constraint that has no points.
    """
    size[:] = 0
    for i in range(count):
        a, b = pair[i, 0], pair[i, 1]
        moves_a, moves_b = inverse_mass[a] > 0.0, inverse_mass[b] > 0.0
        half = 0 if moves_a and moves_b else 1
        for constraint in range(2):
            color[i, constraint] = -1
            if constraint == 0 or points[i] > POINTS:
                taken = (used[a, half] if moves_a else 0) | (used[b, half] if moves_b else 0)
                free = 0
                while free < HALF - 1 and taken >> free & 1:
                    free += 1
                if moves_a:
                    used[a, half] |= 1 << free
                if moves_b:
                    used[b, half] |= 1 << free
                color[i, constraint] = half * HALF + free
                size[half * HALF + free] += 1
    for i in range(count):
        for side in range(2):
            used[pair[i, side], 0] = used[pair[i, side], 1] = 0


@inlined
def _may_share_bodies(color):
    """Whether a color is the last of its half, so that each of its constraints needs a group of its own."""
    return color % HALF == HALF - 1


@kernel
def assign_lanes(count, color, size, place, constraint):
    """Fills groups of LANES lanes with constraints of one color each. Returns the number of groups; if constraint has
    room for fewer, nothing else is written.

    count: of manifolds; color: (m, 2), size: (COLORS,) from assign_colors; place: (COLORS,) int64 scratch. Out:
    constraint, (g, LANES) as in SolverArrays.
    """
    groups = 0
    for c in range(COLORS):
        place[c] = groups * LANES
        groups += size[c] if _may_share_bodies(c) else (size[c] + LANES - 1) // LANES
    if groups > constraint.shape[0]:
        return groups
    constraint[:groups] = -1
    for i in range(count):
        for half in range(2):
            c = color[i, half]
            if c >= 0:
                constraint[place[c] // LANES, place[c] % LANES] = 2 * i + half
                place[c] += LANES if _may_share_bodies(c) else 1
    return groups
