"""Memory layout of the contact solver.

A contact constraint is a manifold's points 0 to 3, or 4 to 7: a normal impulse at each point, and friction at a single
point, the center of pressure, with a twist impulse (a torque about the normal) beside it. Friction at one point is what
Box3D does, too: it takes a third of the work of friction at each point, and is exact where the distribution of pressure
is known from the step before.

LANES constraints that share no moving body make a group. A group's table has FIELDS rows of LANES float64, one lane per
constraint, so that the compiler turns loops over lanes into SIMD instructions. The names below are offsets into such a
table, in float64: lane k of a row is `t[ROW + k]`, component c of a vector `t[ROW + c * LANES + k]`, and so is point c
of a row per point. Throughout the solver `t` is the table of a group, `v` the gathered motion of its bodies, and `k` a
lane. All vectors are in the world frame; units are SI. Normals point from body a to body b, and impulses act on b, with
the opposite ones on a.
"""

from typing import NamedTuple, Self

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.kernel import inlined

LANES = 8
POINTS = 4  # of a constraint, at most
L2, L3, L4, L5, L6 = 2 * LANES, 3 * LANES, 4 * LANES, 5 * LANES, 6 * LANES

# Set once a step from manifolds and bodies: unit normal and tangents; inverse masses; coefficients of friction and
# restitution; inverse inertia tensors (xx xy xz yy yz zz); per point the anchors from the centers of a and b (x y z
# each), and the separation at the time of detection.
(NORMAL, TANGENT_1, TANGENT_2, INV_MASS_A, INV_MASS_B, FRICTION, RESTITUTION, INV_INERTIA_A, INV_INERTIA_B, ANCHOR,
 BASE_SEPARATION) = (LANES * row for row in (0, 3, 6, 9, 10, 11, 12, 13, 19, 25, 49))
# Derived from it once a step: effective mass of each point along the normal, 0 for a point that does not exist; Kij,
# the change of the normal velocity at point j per impulse at point i; center of pressure from the centers of a and b;
# mean distance of the pressure from it, the lever arm of twist friction; inverse of the 2 x 2 mass matrix of the
# tangents, and of its greatest eigenvalue; effective mass of the twist.
(NORMAL_MASS, K01, K02, K03, K12, K13, K23, CENTER_A, CENTER_B, TWIST_RADIUS, TANGENT_MASS_11, TANGENT_MASS_12,
 TANGENT_MASS_22, SLIDING_MASS, TWIST_MASS) = (
    LANES * row for row in (53, 57, 58, 59, 60, 61, 62, 63, 66, 69, 70, 71, 72, 114, 73))
# Changed by the solver: per point the separation now, the normal impulse of the sub-step and that of the step, and the
# velocity that restitution gives it (see restitution.py); impulses along the tangents and about the normal.
SEPARATION, NORMAL_IMPULSE, TOTAL_IMPULSE, RESTITUTION_VELOCITY, TANGENT_IMPULSE_1, TANGENT_IMPULSE_2, TWIST_IMPULSE = (
    LANES * row for row in (74, 78, 82, 86, 90, 91, 92))
# 1 for a soft constraint, 0 for a rigid one. For the conjugate gradients of rigid ones: the seven impulses (normal,
# tangents, twist) before an iteration, and the search direction.
SOFT, PREVIOUS, DIRECTION = (LANES * row for row in (94, 95, 102))
# Change of the normal velocity at each point per uniform impulse, one that is equal at all points; effective mass of a
# uniform impulse, over the sum of the points' velocities.
UNIFORM_RESPONSE, UNIFORM_MASS = (LANES * row for row in (109, 113))
FIELDS = 115

# The motion of a group's bodies, gathered from their rows into lanes: velocity and angular velocity of a and of b, then
# their displacement since detection; and by how much the changes of a rigid constraint's impulses exceed the tolerance.
VELOCITY_A, VELOCITY_B, DISPLACEMENT_A, DISPLACEMENT_B, RESIDUAL = (LANES * row for row in (0, 6, 12, 19, 26))
GATHERED = 27 * LANES

# A body's row: velocity, angular velocity; displacement since detection: translation, rotation as axis times sine and
# as 1 / (1 + cosine) of its angle; 1 if a contact pushes the body in this sub-step.
ANGULAR_VELOCITY, TRANSLATION, ROTATION, ROTATION_FACTOR, LOADED, BODY_FIELDS = 3, 6, 9, 12, 13, 16
DISPLACEMENT_FIELDS = LOADED - TRANSLATION


class SolverArrays(NamedTuple):
    """The arrays of the contact solver, with room for g groups and for n bodies and one more, which never moves."""

    constraint: Integers  # (g, LANES) twice the number of the manifold, and 1 for its points 4 to 7; -1: empty lane
    body: Integers  # (g, 2, LANES) bodies a and b; n in empty lanes
    table: Floats  # (g, FIELDS * LANES) as above
    motion: Floats  # (n + 1, BODY_FIELDS) as above
    gathered: Floats  # (GATHERED,) scratch

    @classmethod
    def allocate(cls, bodies: int, groups: int) -> Self:
        """Arrays for so many bodies and groups; no body has moved."""
        motion = np.zeros((bodies + 1, BODY_FIELDS))
        motion[:, ROTATION_FACTOR] = 0.5
        return cls(*_group_arrays(groups), motion, np.zeros(GATHERED))

    def with_groups(self, groups: int) -> Self:
        """The same with new, empty arrays for so many groups."""
        constraint, body, table = _group_arrays(groups)
        return self._replace(constraint=constraint, body=body, table=table)


def _group_arrays(groups: int) -> tuple[Integers, Integers, Floats]:
    """constraint, body and table of SolverArrays. Tables start as 0, since unused lanes take part in the arithmetic."""
    return (np.empty((groups, LANES), np.int64), np.empty((groups, 2, LANES), np.int64),
            np.zeros((groups, FIELDS * LANES)))


@inlined
def lane_count(table):
    """LANES, from the shape of the tables (g, FIELDS * LANES). The compiler unrolls a loop over a constant number of
    lanes instead of vectorizing it."""
    return table.shape[1] // FIELDS


@inlined
def vector(t, row, k):
    """The three components of a vector in lane k."""
    return t[row + k], t[row + LANES + k], t[row + L2 + k]


@inlined
def set_vector(t, row, k, x, y, z):
    """Writes the three components of a vector in lane k."""
    t[row + k], t[row + LANES + k], t[row + L2 + k] = x, y, z


@inlined
def per_point(t, row, k):
    """The four numbers of a row per point in lane k."""
    return t[row + k], t[row + LANES + k], t[row + L2 + k], t[row + L3 + k]


@inlined
def set_per_point(t, row, k, s0, s1, s2, s3):
    """Writes the four numbers of a row per point in lane k."""
    t[row + k], t[row + LANES + k], t[row + L2 + k], t[row + L3 + k] = s0, s1, s2, s3


@inlined
def inverse_inertia_times(t, row, k, x, y, z):
    """The change of angular velocity, rad/s, by the angular impulse (x, y, z), N m s; row: INV_INERTIA_A or _B."""
    return (t[row + k] * x + t[row + LANES + k] * y + t[row + L2 + k] * z,
            t[row + LANES + k] * x + t[row + L3 + k] * y + t[row + L4 + k] * z,
            t[row + L2 + k] * x + t[row + L4 + k] * y + t[row + L5 + k] * z)


@inlined
def cross(ax, ay, az, bx, by, bz):
    """The cross product a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@inlined
def at_anchors(t, row, k, q0, q1, q2, q3):
    """The sum of the anchors of all points, times q: a vector; row: ANCHOR for body a, ANCHOR + L3 for body b."""
    return (_over_points(t, row + k, q0, q1, q2, q3), _over_points(t, row + LANES + k, q0, q1, q2, q3),
            _over_points(t, row + L2 + k, q0, q1, q2, q3))


@inlined
def _over_points(t, at, q0, q1, q2, q3):
    """The sum of q0 to q3 times a field of the four points, whose values are L6 apart from `at` on."""
    return q0 * t[at] + q1 * t[at + L6] + q2 * t[at + 2 * L6] + q3 * t[at + 3 * L6]


@inlined
def point_velocity(t, k, p, center, ax, ay, az, bx, by, bz):
    """Separation velocity at point p along the normal, m/s. center: that of the bodies' centers; a, b: cross products
    of the normal with the bodies' angular velocities, as n . (w x r) = (n x w) . r."""
    at = ANCHOR + L6 * p + k
    return (center + (bx * t[at + L3] + by * t[at + L4] + bz * t[at + L5])
            - (ax * t[at] + ay * t[at + LANES] + az * t[at + L2]))
