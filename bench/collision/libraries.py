"""Coal and FCL behind one face: each function prepares what may be prepared, and returns the call that is timed."""

from collections.abc import Callable
from importlib.metadata import version
from itertools import count

import coal
import fcl
import numpy as np

from bench.collision.inputs import Boxes, Frame, Mesh, matrices
from drone_engine.arrays import Booleans, Floats, Integers

NAMES = {"coal": f"coal {version('coal')}", "fcl": f"python-fcl {version('python-fcl')}"}
EVERYTHING = 1_000_000  # contacts

Counts = Callable[[], Integers]  # contacts of each pair


def _collide_coal(shapes_a: list[object], at_a: list[object], shapes_b: list[object], at_b: list[object],
                  most: int) -> Counts:
    """most: contacts of a pair that are looked for; 0 only asks whether there is one."""
    request = coal.CollisionRequest()
    request.enable_contact = most > 0
    request.num_max_contacts = max(most, 1)
    result, counts = coal.CollisionResult(), np.zeros(len(shapes_a), np.int64)

    def run() -> Integers:
        collide, clear = coal.collide, result.clear
        for k, (a, where_a, b, where_b) in enumerate(zip(shapes_a, at_a, shapes_b, at_b, strict=True)):
            clear()
            counts[k] = collide(a, where_a, b, where_b, request, result)
        return counts

    return run


def _collide_fcl(objects_a: list[object], objects_b: list[object], most: int) -> Counts:
    request = fcl.CollisionRequest(num_max_contacts=max(most, 1), enable_contact=most > 0)
    counts = np.zeros(len(objects_a), np.int64)

    def run() -> Integers:
        collide, result = fcl.collide, fcl.CollisionResult
        for k, (a, b) in enumerate(zip(objects_a, objects_b, strict=True)):
            counts[k] = collide(a, b, request, result())
        return counts

    return run


def boxes(a: Boxes, b: Boxes, most: int = 0) -> dict[str, Counts]:
    """Box against box, in pairs."""
    both = [a, b]
    shapes = [[coal.Box(*side) for side in 2 * box.half] for box in both]
    places = [[coal.Transform3s(turn.T, center) for turn, center in zip(box.axes, box.center, strict=True)]
              for box in both]
    objects = [[fcl.CollisionObject(fcl.Box(*side), fcl.Transform(turn.T, center))
                for side, turn, center in zip(2 * box.half, box.axes, box.center, strict=True)] for box in both]
    return {"coal": _collide_coal(shapes[0], places[0], shapes[1], places[1], most),
            "fcl": _collide_fcl(objects[0], objects[1], most)}


def _coal_model(mesh: Mesh) -> object:
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
    model = fcl.BVHModel()
    model.beginModel(len(mesh.vertices), len(mesh.faces))
    model.addSubModel(mesh.vertices, mesh.faces)
    model.endModel()
    return model


def meshes(mesh: Mesh, poses_a: Floats, poses_b: Floats, most: int = 0) -> dict[str, Counts]:
    """A mesh against itself, at poses (n, 7)."""
    model, shape = _coal_model(mesh), _fcl_model(mesh)
    both = [(matrices(poses[:, 3:]), poses[:, :3]) for poses in (poses_a, poses_b)]
    places = [[coal.Transform3s(turn, center) for turn, center in zip(*pose, strict=True)] for pose in both]
    objects = [[fcl.CollisionObject(shape, fcl.Transform(turn, center)) for turn, center in zip(*pose, strict=True)]
               for pose in both]
    models = [model] * len(poses_a)
    return {"coal": _collide_coal(models, places[0], models, places[1], most),
            "fcl": _collide_fcl(objects[0], objects[1], most)}


def triangles(a: Floats, b: Floats) -> dict[str, Counts]:
    """Triangle against triangle, corners (n, 3, 3), each a mesh of its own."""
    alone = np.array([[0, 1, 2]])
    both = [[Mesh(np.ascontiguousarray(corners), alone) for corners in corners_of] for corners_of in (a, b)]
    origin = coal.Transform3s(np.eye(3), np.zeros(3))
    places = [origin] * len(a)
    models = [[_coal_model(mesh) for mesh in side] for side in both]
    objects = [[fcl.CollisionObject(_fcl_model(mesh), fcl.Transform()) for mesh in side] for side in both]
    return {"coal": _collide_coal(models[0], places, models[1], places, 0),
            "fcl": _collide_fcl(objects[0], objects[1], 0)}


def frames(scene: Frame) -> dict[str, Callable[[], int]]:
    """Moves every box to the other moment, renews the tree, finds all pairs and returns how many there are."""
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
    moment = {"coal": 0, "fcl": 0}

    def frame_coal() -> int:
        moment["coal"] ^= 1
        for box, at in zip(boxes_coal, centers[moment["coal"]], strict=True):
            box.setTranslation(at)
            box.computeAABB()
        tree.update()
        collect.init()
        tree.collide(collect)
        return int(collect.numCollisionPairs())

    def frame_fcl() -> int:
        moment["fcl"] ^= 1
        for box, at in zip(boxes_fcl, centers[moment["fcl"]], strict=True):
            box.setTranslation(at)
        tree_fcl.update()
        calls = count()
        tree_fcl.collide(None, lambda a, b, data: next(calls) < 0)
        return next(calls)

    return {"coal": frame_coal, "fcl": frame_fcl}


def hits(run: Counts) -> Booleans:
    """Whether each pair touches."""
    return np.asarray(run() > 0)
