"""Rigid transforms of corners and boxes, from body frames to the world and from one body's frame to the other's.

A rotation is a matrix as a tuple of nine numbers, row by row. Every kernel that places a corner in the world uses
`transform_point`: exact answers hold for the corners as it rounds them.
"""

from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix

RELATIVE_ERROR = 64.0 * 2.0**-52  # of distances: more than twice the error of a corner in the other body's frame


@kernel
def pose_rotation(pose):
    """The rotation of a pose (7,): x y z, then a unit quaternion x y z w."""
    return matrix(pose[3], pose[4], pose[5], pose[6])


@kernel
def axes_rotation(axes, i):
    """The rotation of body i from its axes, axes (n, 3, 3), one a row."""
    return (axes[i, 0, 0], axes[i, 1, 0], axes[i, 2, 0], axes[i, 0, 1], axes[i, 1, 1], axes[i, 2, 1],
            axes[i, 0, 2], axes[i, 1, 2], axes[i, 2, 2])


@kernel
def transform_point(r, px, py, pz, x, y, z):
    """Point (x, y, z) of a body in the world, with the body's rotation r and position p."""
    return ((r[0] * x + r[1] * y + r[2] * z) + px, (r[3] * x + r[4] * y + r[5] * z) + py,
            (r[6] * x + r[7] * y + r[8] * z) + pz)


@kernel
def transform_triangle(corners, i, r, px, py, pz):
    """Triangle i of corners (m, 3, 3) in the world, as a tuple of nine numbers."""
    return (transform_point(r, px, py, pz, corners[i, 0, 0], corners[i, 0, 1], corners[i, 0, 2])
            + transform_point(r, px, py, pz, corners[i, 1, 0], corners[i, 1, 1], corners[i, 1, 2])
            + transform_point(r, px, py, pz, corners[i, 2, 0], corners[i, 2, 1], corners[i, 2, 2]))


@kernel
def transform_box(box, node, r, pose, pad, out):
    """Writes the box of a node, box (k, 6), in the world to out (15,): center, the three axes, half extents grown by
    `pad` m. r: rotation of the pose (7,)."""
    x, y, z = box[node, 0], box[node, 1], box[node, 2]
    for k in range(3):
        out[k] = (r[3 * k] * x + r[3 * k + 1] * y + r[3 * k + 2] * z) + pose[k]
        out[3 + 3 * k], out[4 + 3 * k], out[5 + 3 * k] = r[k], r[3 + k], r[6 + k]
        out[12 + k] = box[node, 3 + k] + pad


@kernel
def relative_transforms(pose_a, pose_b, transforms):
    """Writes the transforms from b's frame to a's and from a's to b's to rows 0 and 1 of transforms (2, 12): rotation
    row by row, then translation. Returns how far the matrices of the two poses are from orthonormal."""
    a = pose_rotation(pose_a)
    b = pose_rotation(pose_b)
    d = (pose_b[0] - pose_a[0], pose_b[1] - pose_a[1], pose_b[2] - pose_a[2])
    error = 0.0
    for i in range(3):
        for j in range(3):
            product = a[i] * b[j] + a[3 + i] * b[3 + j] + a[6 + i] * b[6 + j]
            transforms[0, 3 * i + j] = product
            transforms[1, 3 * j + i] = product
            one = 1.0 if i == j else 0.0
            error = max(error, abs(a[i] * a[j] + a[3 + i] * a[3 + j] + a[6 + i] * a[6 + j] - one),
                        abs(b[i] * b[j] + b[3 + i] * b[3 + j] + b[6 + i] * b[6 + j] - one))
        transforms[0, 9 + i] = a[i] * d[0] + a[3 + i] * d[1] + a[6 + i] * d[2]
        transforms[1, 9 + i] = -(b[i] * d[0] + b[3 + i] * d[1] + b[6 + i] * d[2])
    return error


@kernel
def point_to_frame(transforms, s, x, y, z):
    """A point of b in the frame of a (s = 0), or a point of a in the frame of b (s = 1)."""
    return (transforms[s, 0] * x + transforms[s, 1] * y + transforms[s, 2] * z + transforms[s, 9],
            transforms[s, 3] * x + transforms[s, 4] * y + transforms[s, 5] * z + transforms[s, 10],
            transforms[s, 6] * x + transforms[s, 7] * y + transforms[s, 8] * z + transforms[s, 11])


@kernel
def direction_to_frame(transforms, s, x, y, z):
    """A direction of b in the frame of a (s = 0), or a direction of a in the frame of b (s = 1)."""
    return (transforms[s, 0] * x + transforms[s, 1] * y + transforms[s, 2] * z,
            transforms[s, 3] * x + transforms[s, 4] * y + transforms[s, 5] * z,
            transforms[s, 6] * x + transforms[s, 7] * y + transforms[s, 8] * z)
