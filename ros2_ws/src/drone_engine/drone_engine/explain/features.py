"""The optional features of the engine, and whether a scene enables them; everything that costs time is listed."""

from collections.abc import Iterator
from typing import NamedTuple, get_args

from drone_engine import effects
from drone_engine.collision_level import LEVELS, TESTED
from drone_engine.scene.picture import Render
from drone_engine.scene.schema import FLIGHT_MODELS, Dynamics
from drone_engine.world import World

USES_AIR = ("drag", "linear_drag", "ground_effect", "rotor drag")  # stages that use the velocity of the air
MAX_NAMES = 4  # more are counted instead of listed


class Feature(NamedTuple):
    """A feature that a scene may enable."""

    group: str
    name: str
    on: bool
    why: str  # reason for being on or off, or details


def features(world: World) -> list[Feature]:
    """All features, enabled or not, by group."""
    return [*_effects(world), *_flight(world), *_collision(world), *_dynamics(world), *_picture(world)]


def _effects(world: World) -> Iterator[Feature]:
    own = [name for name in world.effects if name not in effects.EFFECTS]
    used = bool(own) or any(stage.name in USES_AIR for stage in world.force_program.stages)
    for name in [*effects.EFFECTS, *own]:
        if name not in world.effects:
            yield Feature("effects", name, False, "not in the scene")
        elif idle := world.effects[name].idle:
            yield Feature("effects", name, False, f"in the scene, but {idle}")
        else:
            parameters = world.scene.effects[name]
            why = ", ".join(f"{key} {value}" for key, value in parameters.items()) or "with default parameters"
            if name in effects.AIR and not used:
                why += "; nothing uses the velocity of the air: add drag or linear_drag"
            yield Feature("effects", name, True, why)


def _flight(world: World) -> Iterator[Feature]:
    objects = world.scene.objects
    for kind in FLIGHT_MODELS:
        drones = [name for name, thing in objects.items() if thing.flight and thing.flight.model == kind]
        why = listed(drones) or ("no drone uses it" if world.model.drones.body.size else "no drone in the scene")
        yield Feature("flight", kind, bool(drones), why)
    rotors = len(world.model.rotors.names)
    yield Feature("flight", "rotors", rotors > 0, f"{rotors} rotating objects" if rotors else "no object is a rotor")


def _collision(world: World) -> Iterator[Feature]:
    """The collision levels of all pairs."""
    levels, bodies = world.detection.levels, world.model.bodies
    for level in TESTED:
        used = levels.uses(LEVELS[level])
        default = LEVELS[level] == levels.default
        why = "the scene's default" if default else "of some pairs" if used else "no pair uses it"
        yield Feature("collision", level, used, why)
    floors = [bodies.names[floor.body] for floor in world.model.planes if floor.body != world.model.terrain]
    yield Feature("collision", "floor", bool(floors), listed(floors) or "no object has this level")
    ground = world.model.terrain
    yield Feature("collision", "ground", ground is not None,
                  "no object has this level" if ground is None else f"the surface of {bodies.names[ground]}")
    read = [bodies.names[i] for i in levels.mesh_bodies()]
    yield Feature("collision", "meshes", bool(read),
                  listed(read) or "no mesh is read: no pair uses octree or triangle")


def _dynamics(world: World) -> Iterator[Feature]:
    dynamics = world.scene.dynamics
    for scheme in get_args(Dynamics.model_fields["integrator"].annotation):
        used = scheme == dynamics.integrator
        why = (f"{dynamics.substeps} sub-steps in each of {world.scene.rates.physics:g} steps per s" if used
               else f"the scene uses {dynamics.integrator}")
        yield Feature("dynamics", scheme, used, why)
    unsteady = [name for name in world.effects if effects.unsteady(name, world.scene)]
    why = ("bodies at rest are skipped until something touches them" if world.sleep else
           "the scene has sleep: false" if not dynamics.sleep else
           f"{' and '.join(unsteady)} may move bodies at rest" if unsteady else "nothing can touch anything")
    yield Feature("dynamics", "sleep", world.sleep is not None, why)


def _picture(world: World) -> Iterator[Feature]:
    scene = world.scene
    switches = [name for name, field in Render.model_fields.items() if field.default is None]
    for name in switches:
        on = name in scene.render.features()
        yield Feature("picture", name, on, "in the shaders that need it" if on else "not in the scene")
    yield Feature("picture", "lights", bool(scene.lights), listed(list(scene.lights)) or "only ambient light")
    cameras = listed(list(scene.cameras))
    yield Feature("picture", "cameras", bool(cameras),
                  f"{cameras}; drawn while subscribed to" if cameras else "no camera in the scene")


def listed(names: list[str]) -> str:
    """The names, or the first MAX_NAMES of them and the number of the others."""
    more = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")
