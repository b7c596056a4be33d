"""The hard cases of motion: description, criterion and settings of each."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import get_args

from drone_engine.scene.schema import Dynamics
from reference.box_world import Setting
from reference.motion import contact, free, scenes
from reference.motion.outcome import Outcome

INTEGRATORS: tuple[str, ...] = get_args(Dynamics.model_fields["integrator"].annotation)
PLAIN, SLEEPING = Setting(), Setting(sleep=True)
SCHEMES = tuple(Setting(integrator=name) for name in INTEGRATORS)
BOTH = (PLAIN, SLEEPING)


@dataclass(frozen=True)
class Case:
    """A case; run(setting) returns its outcome. known_failures: the reason, for settings known to miss a limit."""

    title: str
    description: str
    criterion: str
    run: Callable[[Setting], Outcome]
    settings: tuple[Setting, ...]
    known_failures: Mapping[Setting, str] = field(default_factory=dict)


CASES = {
    "tumble": Case(
        "A tumbling box",
        "A free box of 1 x 4 x 9 m, thrown, rotates about its unstable axis for 10 s.",
        "measured order of convergence within 0.2 of the integrator's; no position error of g T h / 2",
        free.tumble, SCHEMES),
    "spin": Case(
        "Fast rotation about the intermediate axis",
        "The same box rotates at 100 rad/s about its unstable axis for 60 s.",
        "energy and angular momentum within 0.1 %, the quaternion's norm within 1e-12",
        free.spin, SCHEMES,
        {Setting(integrator="semi_implicit_euler"):
         "the integrator damps a rotation of a third of a radian per sub-step",
         Setting(integrator="rk4"): "the integrator damps the rotation slightly; midpoint does not"}),
    "stack": Case(
        "A stack of ten boxes",
        "Ten crates of 60 cm stand on each other for 60 s.",
        "the top box moves less than 1 mm; the energy never rises",
        contact.stack, BOTH),
    "mass_ratio": Case(
        "Mass ratio of 1000",
        "A box of 1000 kg stands on a box of 1 kg of the same size.",
        "penetration below 1 % of the smaller box",
        contact.mass_ratio, BOTH),
    "bounce": Case(
        "Ten bounces",
        "A crate falls flat from 1 m, with restitution 1.",
        "energy within 1 % over ten bounces",
        contact.bounce, SCHEMES,
        {Setting(integrator="semi_implicit_euler"):
         "a first-order integrator has an error in the height of each bounce"}),
    "plate": Case(
        "Projectiles and a thin plate",
        "Cubes of 5 cm are shot at plates of 1 cm from any side, at 1 to 1000 m/s, with 30 steps per second.",
        "none of 10,000 passes through",
        scenes.plate, (PLAIN,)),
    "corner": Case(
        "A drone in a corner",
        "A drone is commanded at full speed into the corner of two walls, for 60 s.",
        "penetration below 1 mm, speed below 1 cm/s",
        contact.corner, BOTH),
    "corner_quadrotor": Case(
        "A quadrotor in a corner",
        "The same at 1 m/s with the flight model 'quadrotor', which tilts toward the walls, for 60 s.",
        "penetration below 1 mm, speed below 1 cm/s",
        partial(contact.corner, model="quadrotor", speed=1.0), BOTH),
    "inside": Case(
        "Overlapping bodies",
        "Pairs of crates overlap by half at the start, in 24 relative poses.",
        "they separate, and none is faster than 1 m/s",
        contact.inside, (PLAIN,)),
    "sticks": Case(
        "A slope just below the friction angle",
        "A crate on a slope at 0.99 of the friction angle, for 10 s.",
        "it moves less than 1 mm",
        partial(contact.slope, part=contact.STICKS), BOTH),
    "slides": Case(
        "A slope just above the friction angle",
        "The same at 1.01 of the friction angle.",
        "the acceleration is within 1 % of that of Coulomb friction",
        partial(contact.slope, part=contact.SLIDES), BOTH),
    "island": Case(
        "A million steps of the island",
        "Nine simulated hours on the island without any command.",
        "all numbers are finite; no object at rest drifts by more than 1 mm",
        scenes.island, BOTH),
    "repeats": Case(
        "Repeated runs",
        "A drone flies into 24 falling crates, in three runs.",
        "the states of all steps are equal bit for bit",
        scenes.repeats, BOTH),
    "stall": Case(
        "A stalled clock",
        "The process stalls for 5 s while crates fall.",
        "simulated time does not jump, the state is that of a run without stall, and the lag is reported",
        scenes.stall, (PLAIN,)),
}
