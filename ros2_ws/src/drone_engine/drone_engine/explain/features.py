"""What there is to switch on, and whether a scene does: everything that costs time is named here, on or off."""

from collections.abc import Iterator
from typing import NamedTuple, get_args

from drone_engine import effects
from drone_engine.collision_level import LEVELS, TESTED
from drone_engine.scene.picture import Render
from drone_engine.scene.schema import FLIGHT_MODELS, Dynamics
from drone_engine.world import World

FEEL_THE_AIR = ("drag", "linear_drag", "ground_effect", "rotor drag")  # stages
FEW = 4  # names that are written out


class Feature(NamedTuple):
    """One thing that a scene may call for."""

    group: str
    name: str
    on: bool
    why: str


def features(world: World) -> list[Feature]:
    """All of them, on and off."""
    return [*_effects(world), *_flight(world), *_collision(world), *_dynamics(world), *_picture(world)]


def _effects(world: World) -> Iterator[Feature]:
    felt = any(stage.name in FEEL_THE_AIR for stage in world.force_program.stages)
    for name in effects.EFFECTS:
        if name not in world.effects:
            yield Feature("effects", name, False, "not named by the scene")
        elif idle := world.effects[name].idle:
            yield Feature("effects", name, False, f"named by the scene, but {idle}")
        else:
            words = world.scene.effects[name]
            why = ", ".join(f"{key} {value}" for key, value in words.items()) or "with its defaults"
            if name in effects.AIR and not felt:
                why += "; nothing feels the air: name drag or linear_drag"
            yield Feature("effects", name, True, why)


def _flight(world: World) -> Iterator[Feature]:
    objects = world.scene.objects
    for kind in FLIGHT_MODELS:
        drones = [name for name, thing in objects.items() if thing.flight and thing.flight.model == kind]
        why = few(drones) or ("no drone flies by it" if world.model.drones.body.size else "no drone in the scene")
        yield Feature("flight", kind, bool(drones), why)
    rotors = len(world.model.rotors.names)
    yield Feature("flight", "rotors", rotors > 0, f"{rotors} turn" if rotors else "no object is a rotor")


def _collision(world: World) -> Iterator[Feature]:
    """As the levels say; where nothing can touch anything, there is no detection at all."""
    levels, bodies = world.detection.levels, world.model.bodies
    for level in TESTED:
        used = levels.uses(LEVELS[level])
        default = LEVELS[level] == levels.default
        why = "of all that say nothing of their own" if default else "of some pairs" if used else "no pair asks for it"
        yield Feature("collision", level, used, why)
    floors = [bodies.names[floor.body] for floor in world.model.planes if floor.body != world.model.terrain]
    yield Feature("collision", "floor", bool(floors), few(floors) or "no object is one")
    ground = world.model.terrain
    yield Feature("collision", "ground", ground is not None,
                  "no object is uneven ground" if ground is None else f"the surface of {bodies.names[ground]}")
    read = [bodies.names[i] for i in levels.mesh_bodies()]
    yield Feature("collision", "meshes", bool(read),
                  few(read) or "no mesh is read, as no pair meets at octree or triangle")


def _dynamics(world: World) -> Iterator[Feature]:
    dynamics = world.scene.dynamics
    for scheme in get_args(Dynamics.model_fields["integrator"].annotation):
        used = scheme == dynamics.integrator
        why = (f"{dynamics.substeps} sub-steps in each of {world.scene.rates.physics:g} steps per s" if used
               else f"the scene asks for {dynamics.integrator}")
        yield Feature("dynamics", scheme, used, why)
    unsteady = [name for name in effects.UNSTEADY if name in world.effects]
    why = ("what rests is left out until it is touched" if world.sleep else
           "the scene says sleep: false" if not dynamics.sleep else
           f"{' and '.join(unsteady)} may move what rests" if unsteady else "nothing can touch anything")
    yield Feature("dynamics", "sleep", world.sleep is not None, why)


def _picture(world: World) -> Iterator[Feature]:
    scene = world.scene
    switches = [name for name, field in Render.model_fields.items() if field.default is None]
    for name in switches:
        on = name in scene.render.features()
        yield Feature("picture", name, on, "in the shaders that need it" if on else "not named by the scene")
    yield Feature("picture", "lights", bool(scene.lights), few(list(scene.lights)) or "no light but the ambient")
    cameras = few(list(scene.cameras))
    yield Feature("picture", "cameras", bool(cameras),
                  f"{cameras}; drawn while somebody subscribes" if cameras else "no camera in the scene")


def few(names: list[str]) -> str:
    """The names, or the first of them and how many more."""
    more = len(names) - FEW
    return ", ".join(names[:FEW]) + (f" and {more} more" if more > 0 else "")
