"""Triangles taken from arrays of corners, and their normals."""

from drone_engine.kernel import kernel


@kernel
def triangle_at(corners, i):
    """Triangle i of corners (n, 3, 3) as a tuple of nine numbers: x y z of each corner in turn."""
    return (corners[i, 0, 0], corners[i, 0, 1], corners[i, 0, 2], corners[i, 1, 0], corners[i, 1, 1], corners[i, 1, 2],
            corners[i, 2, 0], corners[i, 2, 1], corners[i, 2, 2])


@kernel
def triangle_normal(corners, i):
    """The normal (x, y, z) of triangle i of corners (n, 3, 3), with the length of twice its area; it points to the side
    from which the corners run counter-clockwise."""
    ux, uy, uz = (corners[i, 1, 0] - corners[i, 0, 0], corners[i, 1, 1] - corners[i, 0, 1],
                  corners[i, 1, 2] - corners[i, 0, 2])
    vx, vy, vz = (corners[i, 2, 0] - corners[i, 0, 0], corners[i, 2, 1] - corners[i, 0, 1],
                  corners[i, 2, 2] - corners[i, 0, 2])
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
