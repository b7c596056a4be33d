"""Bodies at given poses: positions, orientations and the world axes of their boxes."""

from typing import NamedTuple

from drone_engine.arrays import Floats, Integers
from drone_engine.kernel import kernel
from drone_engine.math.rotation import matrix


class PlacedBodies(NamedTuple):
    """n bodies at given poses; SI units, world frame."""

    body: Integers  # (n,) index of each in the scene
    position: Floats  # (n, 3) centers of the boxes
    orientation: Floats  # (n, 4) unit quaternions x y z w
    axes: Floats  # (n, 3, 3) unit axes of the boxes, one a row
    half: Floats  # (n, 3) half extents of the boxes; inf marks a floor


@kernel
def set_axes(i, orientation, axes):
    """Writes the axes of box i in the world to axes (n, 3, 3), one a row; orientation: (n, 4) unit quaternions."""
    m = matrix(orientation[i, 0], orientation[i, 1], orientation[i, 2], orientation[i, 3])
    for k in range(3):
        axes[i, k, 0], axes[i, k, 1], axes[i, k, 2] = m[k], m[3 + k], m[6 + k]


@kernel
def set_all_axes(orientation, axes):
    """Writes the axes of all n boxes in the world to axes (n, 3, 3), one a row; orientation: (n, 4)."""
    for i in range(orientation.shape[0]):
        set_axes(i, orientation, axes)
