"""coal and FCL behind the same functions: each prepares its input and returns the calls to time, by library."""

from collections.abc import Callable
from importlib.metadata import version
from itertools import count

import coal
import fcl
import numpy as np

from bench.collision.inputs import Boxes, Frame, Mesh, matrices
from drone_engine.arrays import Booleans, Floats, Integers

NAMES = {"coal": f"coal {version('coal')}", "fcl": f"python-fcl {version('python-fcl')}"}
UNLIMITED = 1_000_000  # contacts

Counts = Callable[[], Integers]  # contacts of each pair


def _collide_coal(shapes_a: list[object], poses_a: list[object], shapes_b: list[object], poses_b: list[object],
                  max_contacts: int) -> Counts:
    """The call that tests each pair in turn; max_contacts: per pair, 0 for an intersection test only."""
    request = coal.CollisionRequest()
    request.enable_contact = max_contacts > 0
    request.num_max_contacts = max(max_contacts, 1)
    result, counts = coal.CollisionResult(), np.zeros(len(shapes_a), np.int64)

    def run() -> Integers:
        collide, clear = coal.collide, result.clear
        for k, (a, pose_a, b, pose_b) in enumerate(zip(shapes_a, poses_a, shapes_b, poses_b, strict=True)):
            clear()
            counts[k] = collide(a, pose_a, b, pose_b, request, result)
        return counts

    return run


def _collide_fcl(objects_a: list[object], objects_b: list[object], max_contacts: int) -> Counts:
    """The call that tests each pair in turn; max_contacts: per pair, 0 for an intersection test only."""
    request = fcl.CollisionRequest(num_max_contacts=max(max_contacts, 1), enable_contact=max_contacts > 0)
    counts = np.zeros(len(objects_a), np.int64)

    def run() -> Integers:
        collide, result = fcl.collide, fcl.CollisionResult
        for k, (a, b) in enumerate(zip(objects_a, objects_b, strict=True)):
            counts[k] = collide(a, b, request, result())
        return counts

    return run


def boxes(a: Boxes, b: Boxes, max_contacts: int = 0) -> dict[str, Counts]:
    """Calls for n pairs of boxes; max_contacts: per pair, 0 for an intersection test only."""
    both = [a, b]
    shapes = [[coal.Box(*side) for side in 2 * box.half] for box in both]
    transforms = [[coal.Transform3s(axes.T, center) for axes, center in zip(box.axes, box.center, strict=True)]
              for box in both]
    objects = [[fcl.CollisionObject(fcl.Box(*side), fcl.Transform(axes.T, center))
                for side, axes, center in zip(2 * box.half, box.axes, box.center, strict=True)] for box in both]
    return {"coal": _collide_coal(shapes[0], transforms[0], shapes[1], transforms[1], max_contacts),
            "fcl": _collide_fcl(objects[0], objects[1], max_contacts)}


def _coal_model(mesh: Mesh) -> object:
    """The mesh as a bounding volume hierarchy of coal."""
    model = coal.BVHModelOBBRSS()
    vertices, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for vertex in mesh.vertices:
        vertices.append(vertex)
    for face in mesh.faces:
        triangles.append(coal.Triangle(*map(int, face)))
    model.beginModel(len(mesh.faces), len(mesh.vertices))
    model.addSubModel(vertices, triangles)
    model.endModel()
    return model


def _fcl_model(mesh: Mesh) -> object:
    """The mesh as a bounding volume hierarchy of FCL."""
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def meshes(mesh: Mesh, poses_a: Floats, poses_b: Floats, max_contacts: int = 0) -> dict[str, Counts]:
    """Calls for a mesh against itself at n pairs of poses (n, 7)."""
    model, shape = _coal_model(mesh), _fcl_model(mesh)
    both = [(matrices(poses[:, 3:]), poses[:, :3]) for poses in (poses_a, poses_b)]
    transforms = [[coal.Transform3s(rotation, center) for rotation, center in zip(*pose, strict=True)]
                  for pose in both]
    objects = [[fcl.CollisionObject(shape, fcl.Transform(rotation, center))
                for rotation, center in zip(*pose, strict=True)]
               for pose in both]
    models = [model] * len(poses_a)
    return {"coal": _collide_coal(models, transforms[0], models, transforms[1], max_contacts),
            "fcl": _collide_fcl(objects[0], objects[1], max_contacts)}


def triangles(a: Floats, b: Floats) -> dict[str, Counts]:
    """Calls for n pairs of triangles, corners (n, 3, 3); each triangle is a mesh."""
    face = np.array([[0, 1, 2]])
    both = [[Mesh(np.ascontiguousarray(corners), face) for corners in corners_of] for corners_of in (a, b)]
    origin = coal.Transform3s(np.eye(3), np.zeros(3))
    transforms = [origin] * len(a)
    models = [[_coal_model(mesh) for mesh in side] for side in both]
    objects = [[fcl.CollisionObject(_fcl_model(mesh), fcl.Transform()) for mesh in side] for side in both]
    return {"coal": _collide_coal(models[0], transforms, models[1], transforms, 0),
            "fcl": _collide_fcl(objects[0], objects[1], 0)}


def frames(scene: Frame) -> dict[str, Callable[[], int]]:
    """Calls that move all boxes to the other state, update the tree and return the number of pairs."""
    centers = [(scene.low + scene.high) / 2, (scene.low_next + scene.high_next) / 2]
    sides = scene.high - scene.low
    boxes_coal = [coal.CollisionObject(coal.Box(*side), coal.Transform3s(np.eye(3), at))
                  for side, at in zip(sides, centers[0], strict=True)]
    tree = coal.DynamicAABBTreeCollisionManager()
    for box in boxes_coal:
        box.computeAABB()
        tree.registerObject(box)
    tree.setup()
    collect = coal.CollisionCallBackCollect(40 * len(sides) + 100)
    boxes_fcl = [fcl.CollisionObject(fcl.Box(*side), fcl.Transform(np.eye(3), at))
                 for side, at in zip(sides, centers[0], strict=True)]
    tree_fcl = fcl.DynamicAABBTreeCollisionManager()
    tree_fcl.registerObjects(boxes_fcl)
    tree_fcl.setup()
    state = {"coal": 0, "fcl": 0}

    def frame_coal() -> int:
        state["coal"] ^= 1
        for box, at in zip(boxes_coal, centers[state["coal"]], strict=True):
            box.setTranslation(at)
            box.computeAABB()
        tree.update()
        collect.init()
        tree.collide(collect)
        return int(collect.numCollisionPairs())

    def frame_fcl() -> int:
        state["fcl"] ^= 1
        for box, at in zip(boxes_fcl, centers[state["fcl"]], strict=True):
            box.setTranslation(at)
        tree_fcl.update()
        calls = count()
        tree_fcl.collide(None, lambda a, b, data: next(calls) < 0)
        return next(calls)

    return {"coal": frame_coal, "fcl": frame_fcl}


def hits(run: Counts) -> Booleans:
    """Whether each pair has a contact."""
    return np.asarray(run() > 0)
