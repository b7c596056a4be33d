"""Contacts of one pair of bodies before they are reduced to manifolds."""

from typing import NamedTuple

import numpy as np

from drone_engine.arrays import Floats, Integers
from drone_engine.kernel import kernel


class ContactBuffer(NamedTuple):
    """Room for k contacts of bodies a and b; world frame. Kernels that append return the number of contacts including
    those that do not fit, which are not written."""

    normal: Floats  # (k, 3) unit, from a to b
    point: Floats  # (k, 2, 3) m, on a and on b
    separation: Floats  # (k,) m, negative in penetration
    feature: Integers  # (k,) identifier of the features in contact, stable from step to step


def contact_buffer(capacity: int) -> ContactBuffer:
    """A buffer for so many contacts."""
    return ContactBuffer(np.empty((capacity, 3)), np.empty((capacity, 2, 3)), np.empty(capacity),
                         np.empty(capacity, np.int64))


@kernel
def append_contact(nx, ny, nz, x, y, z, separation, feature, out, found):
    """Appends a contact to a ContactBuffer after its first `found`; returns the new number. n: normal; x, y, z: the
    point on body b, m."""
    if found < out.separation.shape[0]:
        normal, point = out.normal, out.point
        normal[found, 0], normal[found, 1], normal[found, 2] = nx, ny, nz
        point[found, 0, 0], point[found, 0, 1] = x - separation * nx, y - separation * ny
        point[found, 0, 2] = z - separation * nz
        point[found, 1, 0], point[found, 1, 1], point[found, 1, 2] = x, y, z
        out.separation[found], out.feature[found] = separation, feature
    return found + 1
