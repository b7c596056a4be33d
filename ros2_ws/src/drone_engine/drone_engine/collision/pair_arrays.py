"""The arrays that the stages of collision detection pass on: bounds of bodies, pairs of bodies, counts."""

from typing import NamedTuple

from drone_engine.arrays import Booleans, Floats, Integers


class BodyBounds(NamedTuple):
    """Bounds of n bodies, m, world."""

    axes: Floats  # (n, 3, 3) axes of the boxes, one a row
    low: Floats  # (n, 3) AABB, with margin and motion of the step
    high: Floats  # (n, 3)
    half: Floats  # (n, 3) half extents; inf for planes
    bounding_radius: Floats  # (n,) of the box
    reach: Floats  # (n,) least half size of the AABB: the bounding radius if any pair meets at level sphere, else 0
    plane_height: Floats  # (n,) of planes, else NaN
    planes: Integers  # (p,) bodies that are planes or terrain


class PairArrays(NamedTuple):
    """The pairs that the broad phase found, with room for k."""

    floor_height: Floats  # (k,) m, where one of the two is a plane, else NaN
    level: Integers  # (k,) collision level
    all_contacts: Integers  # (k,) 1: all contacts; 0: the deepest point alone
    margin: Floats  # (k,) m, speculative margin: points closer than this are contacts
    swept: Booleans  # (k,) continuous collision detection


class Counts(NamedTuple):
    """Numbers that the stages of a step pass on, each (1,)."""

    pairs: Integers  # of the broad phase
    swept: Integers  # pairs with continuous collision detection, if any body needs it
    fine: Integers  # pairs at level octree or triangle
    needed: Integers  # room that was missing, where the broad phase returns a code other than 0
