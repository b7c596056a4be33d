"""Contacts of the pairs of a step that need no mesh: boxes, spheres and planes.

Kernels take pair_a, pair_b (k,), floor_height (k,) in m, NaN without a plane, collision level (k,), all_contacts (k,),
0 for the deepest point alone, and margin (k,) in m of the pairs, and write rows of ContactArrays.
"""

import numpy as np

from drone_engine.collision.box import plane, sphere
from drone_engine.collision.box.clipping import write_edge_manifolds, write_face_manifolds
from drone_engine.collision.box.obb import load_ordered
from drone_engine.collision.box.sat import (
    AXIS,
    BLOCK,
    GAP,
    MARGIN,
    SPEED_TIE,
    STEP_HEIGHT,
    SWAPPED,
    WIDEST,
    find_contact_axes,
    flush_axis,
)
from drone_engine.collision_level import OBB, SPHERE
from drone_engine.kernel import kernel


@kernel
def keep_deepest(point, separation, feature, count):
    """Moves the deepest of the first `count` points to the first place; point (8, 3), separation (8,), feature (8,)."""
    best = 0
    for k in range(1, count):
        if separation[k] < separation[best]:
            best = k
    separation[0], feature[0] = separation[best], feature[best]
    for c in range(3):
        point[0, c] = point[best, c]


@kernel
def move_manifold(i, j, contacts):
    """Copies manifold i of ContactArrays to row j."""
    pair, points, normal, point = contacts.pair, contacts.points, contacts.normal, contacts.point
    separation, feature = contacts.separation, contacts.feature
    pair[j, 0], pair[j, 1], points[j], contacts.level[j] = pair[i, 0], pair[i, 1], points[i], contacts.level[i]
    for c in range(3):
        normal[j, c] = normal[i, c]
    for k in range(points[i]):
        separation[j, k], feature[j, k] = separation[i, k], feature[i, k]
        for c in range(3):
            point[j, k, c] = point[i, k, c]


@kernel
def find_box_contacts(count, boxes, velocity, pair_a, pair_b, floor_height, level, all_contacts, margin, scratch,
                      contacts, found):
    """Appends the manifolds of those of the first `count` pairs that are two boxes at level OBB after the first `found`
    rows; returns how many rows there are then.

    boxes: Boxes; velocity: (n, 3) m/s, world; scratch: BoxScratch. Handles BLOCK pairs at a time.
    """
    table, cut, box_a, box_b, row = scratch.table, scratch.cut, scratch.box_a, scratch.box_b, scratch.row
    pair, points, normal, point = contacts.pair, contacts.points, contacts.normal, contacts.point
    separation, feature, contact_level = contacts.separation, contacts.feature, contacts.level
    k = 0
    while k < count:
        size = 0
        while k < count and size < BLOCK:
            if level[k] == OBB and np.isnan(floor_height[k]):
                box_a[size], box_b[size], row[size] = pair_a[k], pair_b[k], k
                size += 1
            k += 1
        load_ordered(table, size, boxes, box_a, boxes, box_b)
        find_contact_axes(table, size)
        first = found
        for m in range(size):
            table[MARGIN + m] = margin[row[m]]
            near = table[WIDEST + m] <= table[MARGIN + m]
            if near and table[WIDEST + m] > -STEP_HEIGHT:
                _prefer_flush_axis(table, m, velocity, box_a[m], box_b[m])
            pair[found, 0], pair[found, 1], contact_level[found] = box_a[m], box_b[m], OBB
            box_a[m] = row[m]  # from here on the pair
            row[m] = found if near else -1
            found += near
        write_edge_manifolds(table, size, row, points, normal, point, separation, feature)
        write_face_manifolds(table, size, row, points, normal, point, separation, feature, cut)
        found = first
        for m in range(size):  # near pairs may have no point within the margin
            i = row[m]
            if i < 0 or points[i] == 0:
                continue
            if not all_contacts[box_a[m]]:
                keep_deepest(point[i], separation[i], feature[i], points[i])
                points[i] = 1
            if i != found:
                move_manifold(i, found, contacts)
            found += 1
    return found


@kernel
def _prefer_flush_axis(table, k, velocity, a, b):
    """Makes the axis along which the boxes of column k lie flush their contact axis, if they move past each other."""
    sign = -1.0 if table[SWAPPED + k] > 0.0 else 1.0
    x, y, z = (sign * (velocity[b, 0] - velocity[a, 0]), sign * (velocity[b, 1] - velocity[a, 1]),
               sign * (velocity[b, 2] - velocity[a, 2]))
    if x * x + y * y + z * z > SPEED_TIE * SPEED_TIE:
        axis = flush_axis(table, k, x, y, z)
        if axis >= 0:
            # The gap is that beside the common area, if there is any: none is no contact.
            table[AXIS + k], table[GAP + k] = axis, max(table[WIDEST + k], STEP_HEIGHT)


@kernel
def find_sphere_and_plane_contacts(count, boxes, pair_a, pair_b, floor_height, level, all_contacts, margin, contacts,
                                   found):
    """Appends the manifolds of those of the first `count` pairs that are two spheres, or a plane and a sphere or box,
    after the first `found` rows; returns how many rows there are then.

    boxes: Boxes; half extents are inf for planes. A sphere is the bounding sphere of a box.
    """
    position, axes, half = boxes
    pair, points, normal, point = contacts.pair, contacts.points, contacts.normal, contacts.point
    separation, feature, contact_level = contacts.separation, contacts.feature, contacts.level
    for k in range(count):
        on_plane = not np.isnan(floor_height[k])
        if level[k] != SPHERE and not (level[k] == OBB and on_plane):
            continue
        a, b = pair_a[k], pair_b[k]
        n, p, s, f = normal[found], point[found], separation[found], feature[found]
        if on_plane:
            body, up = (b, 1.0) if half[a, 0] == np.inf else (a, -1.0)
            n[0], n[1], n[2] = 0.0, 0.0, up
            if level[k] == SPHERE:
                points[found] = plane.contact_sphere(position, half, body, floor_height[k], margin[k], p, s, f)
            else:
                points[found] = plane.contact(position, axes, half, body, floor_height[k], margin[k], p, s, f)
        else:
            points[found] = sphere.contact(position, half, a, b, margin[k], n, p, s, f)
        if points[found]:
            if not all_contacts[k]:
                keep_deepest(p, s, f, points[found])
                points[found] = 1
            pair[found, 0], pair[found, 1], contact_level[found] = a, b, level[k]
            found += 1
    return found
