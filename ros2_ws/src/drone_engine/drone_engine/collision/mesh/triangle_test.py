"""Two meshes seen from the frame of one of them: where floating point is precise, and when it decides."""

import math

from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix

NOISE = 64.0 * 2.0**-52  # of distances; roundings of a corner on its way into the other's frame are below half
TINY = 1e-300  # what products may lose to underflow is less
YES, NO, UNSURE = 1, 0, -1


@kernel
def relate(pose_a, pose_b, frames):
    """Writes the turns and shifts frames (2, 12) that take points of b into the frame of a, and of a into that of b;
    returns how far the rotation matrices are from orthonormal."""
    a = matrix(pose_a[3], pose_a[4], pose_a[5], pose_a[6])
    b = matrix(pose_b[3], pose_b[4], pose_b[5], pose_b[6])
    d = (pose_b[0] - pose_a[0], pose_b[1] - pose_a[1], pose_b[2] - pose_a[2])
    off = 0.0
    for i in range(3):
        for j in range(3):
            turn = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j]
            frames[0, 3 * i + j] = turn
            frames[1, 3 * j + i] = turn
            one = 1.0 if i == j else 0.0
            off = max(off, abs(a[i] * a[j] + a[3 + i] * a[3 + j] + a[6 + i] * a[6 + j] - one),
                      abs(b[i] * b[j] + b[3 + i] * b[3 + j] + b[6 + i] * b[6 + j] - one))
        frames[0, 9 + i] = a[i] * d[0] + a[3 + i] * d[1] + a[6 + i] * d[2]
        frames[1, 9 + i] = -(b[i] * d[0] + b[3 + i] * d[1] + b[6 + i] * d[2])
    return off


@kernel
def seen(frames, s, x, y, z):
    """A point of the other in the frame of a (s = 0) or b (s = 1)."""
    return (frames[s, 0] * x + frames[s, 1] * y + frames[s, 2] * z + frames[s, 9],
            frames[s, 3] * x + frames[s, 4] * y + frames[s, 5] * z + frames[s, 10],
            frames[s, 6] * x + frames[s, 7] * y + frames[s, 8] * z + frames[s, 11])


@kernel
def turned(frames, s, x, y, z):
    """A direction, as `seen`."""
    return (frames[s, 0] * x + frames[s, 1] * y + frames[s, 2] * z,
            frames[s, 3] * x + frames[s, 4] * y + frames[s, 5] * z,
            frames[s, 6] * x + frames[s, 7] * y + frames[s, 8] * z)


@kernel
def placed(corners, i, turn, pose):
    """Triangle i in the world, nine numbers: the corners that answers are exact for. turn: the pose's matrix."""
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = turn
    px, py, pz = pose[0], pose[1], pose[2]
    x0, y0, z0 = corners[i, 0, 0], corners[i, 0, 1], corners[i, 0, 2]
    x1, y1, z1 = corners[i, 1, 0], corners[i, 1, 1], corners[i, 1, 2]
    x2, y2, z2 = corners[i, 2, 0], corners[i, 2, 1], corners[i, 2, 2]
    return ((r00 * x0 + r01 * y0 + r02 * z0) + px, (r10 * x0 + r11 * y0 + r12 * z0) + py,
            (r20 * x0 + r21 * y0 + r22 * z0) + pz,
            (r00 * x1 + r01 * y1 + r02 * z1) + px, (r10 * x1 + r11 * y1 + r12 * z1) + py,
            (r20 * x1 + r21 * y1 + r22 * z1) + pz,
            (r00 * x2 + r01 * y2 + r02 * z2) + px, (r10 * x2 + r11 * y2 + r12 * z2) + py,
            (r20 * x2 + r21 * y2 + r22 * z2) + pz)


@kernel
def place_box(box, node, turn, pose, pad, out):
    """Writes a node's box in the world, grown by `pad`, into out (15,): centre, axes one by one, half extents."""
    x, y, z = box[node, 0], box[node, 1], box[node, 2]
    for k in range(3):
        out[k] = (turn[3 * k] * x + turn[3 * k + 1] * y + turn[3 * k + 2] * z) + pose[k]
        out[3 + 3 * k], out[4 + 3 * k], out[5 + 3 * k] = turn[k], turn[3 + k], turn[6 + k]
        out[12 + k] = box[node, 3 + k] + pad


@kernel
def meet(a, i, b, nx, ny, nz, bound):
    """Whether triangle a[i] and triangle b (1, 3, 3), of normal (nx, ny, nz), meet: YES, NO or UNSURE.

    bound: what rounding may change of a determinant of differences of their corners; less is UNSURE.
    The signs to look at: Guigue and Devillers 2003, Fast and Robust Triangle-Triangle Overlap Test.
    """
    a0, a1, a2 = _sides(nx, ny, nz, b[0, 0, 0], b[0, 0, 1], b[0, 0, 2], a, i)
    if _least(a0, a1, a2) > bound or _most(a0, a1, a2) < -bound:
        return NO
    mx, my, mz = normal(a, i)
    b0, b1, b2 = _sides(mx, my, mz, a[i, 0, 0], a[i, 0, 1], a[i, 0, 2], b, 0)
    if _least(b0, b1, b2) > bound or _most(b0, b1, b2) < -bound:
        return NO
    if not _least(_least(abs(a0), abs(a1), abs(a2)), _least(abs(b0), abs(b1), abs(b2)), math.inf) > bound:
        return UNSURE
    p, q, r, above_b = _alone(a0 > 0.0, a1 > 0.0, a2 > 0.0)
    u, v, w, above_a = _alone(b0 > 0.0, b1 > 0.0, b2 > 0.0)
    if not above_b:
        v, w = w, v
    if not above_a:
        q, r = r, q
    s, t = _turn(a, i, p, q, b, u, v), _turn(a, i, p, r, b, w, u)
    if s > bound or t > bound:
        return NO
    return YES if s < -bound and t < -bound else UNSURE


@kernel
def outside(t, box, node, margin):
    """Whether a triangle (1, 3, 3) is more than `margin` m outside of a node's box: centre, half extents."""
    for k in range(3):
        reach = box[node, 3 + k] + margin
        if (_least(t[0, 0, k], t[0, 1, k], t[0, 2, k]) - box[node, k] > reach
                or box[node, k] - _most(t[0, 0, k], t[0, 1, k], t[0, 2, k]) > reach):
            return True
    return False


@kernel
def apart(a, i, b, nx, ny, nz, margin, bound):
    """Whether triangle a[i] and triangle b (1, 3, 3) are surely over `margin` m apart, by their boxes and planes."""
    for k in range(3):
        if (_least(b[0, 0, k], b[0, 1, k], b[0, 2, k]) - _most(a[i, 0, k], a[i, 1, k], a[i, 2, k]) > margin
                or _least(a[i, 0, k], a[i, 1, k], a[i, 2, k]) - _most(b[0, 0, k], b[0, 1, k], b[0, 2, k]) > margin):
            return True
    far = bound + 1.000001 * margin * math.sqrt(nx * nx + ny * ny + nz * nz)
    a0, a1, a2 = _sides(nx, ny, nz, b[0, 0, 0], b[0, 0, 1], b[0, 0, 2], a, i)
    if _least(a0, a1, a2) > far or _most(a0, a1, a2) < -far:
        return True
    mx, my, mz = normal(a, i)
    far = bound + 1.000001 * margin * math.sqrt(mx * mx + my * my + mz * mz)
    b0, b1, b2 = _sides(mx, my, mz, a[i, 0, 0], a[i, 0, 1], a[i, 0, 2], b, 0)
    return _least(b0, b1, b2) > far or _most(b0, b1, b2) < -far


@kernel
def normal(t, i):
    """The normal of triangle t[i], as long as twice its area."""
    ux, uy, uz = t[i, 1, 0] - t[i, 0, 0], t[i, 1, 1] - t[i, 0, 1], t[i, 1, 2] - t[i, 0, 2]
    vx, vy, vz = t[i, 2, 0] - t[i, 0, 0], t[i, 2, 1] - t[i, 0, 1], t[i, 2, 2] - t[i, 0, 2]
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


@kernel
def _sides(nx, ny, nz, x, y, z, t, i):
    """Heights of a triangle's corners above the plane through (x, y, z), times the length of its normal."""
    return (nx * (t[i, 0, 0] - x) + ny * (t[i, 0, 1] - y) + nz * (t[i, 0, 2] - z),
            nx * (t[i, 1, 0] - x) + ny * (t[i, 1, 1] - y) + nz * (t[i, 1, 2] - z),
            nx * (t[i, 2, 0] - x) + ny * (t[i, 2, 1] - y) + nz * (t[i, 2, 2] - z))


@kernel
def _alone(s0, s1, s2):
    """The corner on the other side of the plane than both others, these two in order, and whether it is above."""
    if s0 == s1:
        return 2, 0, 1, s2
    if s0 == s2:
        return 1, 2, 0, s1
    return 0, 1, 2, s0


@kernel
def _turn(a, i, p, q, b, u, v):
    """det[q - p, u - p, v - p] of corners p, q of a[i] and u, v of b."""
    x, y, z = a[i, p, 0], a[i, p, 1], a[i, p, 2]
    qx, qy, qz = a[i, q, 0] - x, a[i, q, 1] - y, a[i, q, 2] - z
    ux, uy, uz = b[0, u, 0] - x, b[0, u, 1] - y, b[0, u, 2] - z
    vx, vy, vz = b[0, v, 0] - x, b[0, v, 1] - y, b[0, v, 2] - z
    return qx * (uy * vz - uz * vy) + qy * (uz * vx - ux * vz) + qz * (ux * vy - uy * vx)


@kernel
def _least(x, y, z):
    least = x if x < y else y
    return least if least < z else z


@kernel
def _most(x, y, z):
    most = x if x > y else y
    return most if most > z else z
