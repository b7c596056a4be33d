"""The hard cases of motion: what each tries, the number that it is held to, and in which settings it runs."""

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
    """run(setting) -> Outcome; known: why a setting is known to miss its numbers."""

    title: str
    tries: str
    held_to: str
    run: Callable[[Setting], Outcome]
    settings: tuple[Setting, ...]
    known: Mapping[Setting, str] = field(default_factory=dict)


CASES = {
    "tumble": Case(
        "A box that tumbles",
        "A free box of 1 x 4 x 9 m, thrown and turning about its unstable axis for 10 s.",
        "measured order of convergence within 0.2 of the integrator's; no position error of g T h / 2",
        free.tumble, SCHEMES),
    "spin": Case(
        "Fast spin about the intermediate axis",
        "The same box turns at 100 rad/s about the axis that it cannot stay on, for 60 s.",
        "energy and angular momentum within 0.1 %, the quaternion's norm within 1e-12",
        free.spin, SCHEMES,
        {Setting(integrator="semi_implicit_euler"): "the scheme damps a spin of a third of a radian a sub-step",
         Setting(integrator="rk4"): "the scheme damps it, too, a little; midpoint does not"}),
    "stack": Case(
        "A stack of ten boxes",
        "Ten crates of 60 cm stand on each other for 60 s.",
        "the top box moves less than 1 mm; the energy never rises",
        contact.stack, BOTH),
    "mass_ratio": Case(
        "A ton on a kilogram",
        "A box of 1000 kg is put on a box of 1 kg of the same size.",
        "penetration below 1 % of the smaller box",
        contact.mass_ratio, BOTH),
    "bounce": Case(
        "Ten bounces",
        "A crate falls flat from a metre, with restitution 1.",
        "energy within 1 % over ten bounces",
        contact.bounce, SCHEMES,
        {Setting(integrator="semi_implicit_euler"): "a scheme of first order gets the height of each bounce wrong"}),
    "plate": Case(
        "Bullets and a thin plate",
        "Cubes of 5 cm are shot at plates of 1 cm from any side, at 1 to 1000 m/s, with 30 steps a second.",
        "none of 10,000 passes through",
        scenes.plate, (PLAIN,)),
    "corner": Case(
        "A drone in a corner",
        "A drone is told to fly at full speed into the corner of two walls, for 60 s.",
        "penetration below 1 mm, speed below 1 cm/s",
        contact.corner, BOTH),
    "corner_quadrotor": Case(
        "A quadrotor in a corner",
        "The same at 1 m/s with the flight model 'quadrotor', which leans against the walls, for 60 s.",
        "penetration below 1 mm, speed below 1 cm/s",
        partial(contact.corner, model="quadrotor", speed=1.0), BOTH),
    "inside": Case(
        "Two bodies in one place",
        "Crates start half inside each other, shifted and turned in 24 ways.",
        "they part, and none is faster than 1 m/s",
        contact.inside, (PLAIN,)),
    "sticks": Case(
        "A slope that just holds",
        "A crate on a slope at 0.99 of the friction angle, for 10 s.",
        "it moves less than 1 mm",
        partial(contact.slope, part=contact.STICKS), BOTH),
    "slides": Case(
        "A slope that just does not",
        "The same at 1.01 of the friction angle.",
        "its acceleration is within 1 % of Coulomb's",
        partial(contact.slope, part=contact.SLIDES), BOTH),
    "island": Case(
        "A million steps of the island",
        "Nine hours on the island with nobody there.",
        "no number that is not finite, nothing at rest drifts more than 1 mm",
        scenes.island, BOTH),
    "repeats": Case(
        "Twice the same",
        "A drone flies into 24 falling crates, three times over.",
        "every state's hash is equal, bit for bit",
        scenes.repeats, BOTH),
    "stall": Case(
        "The clock stalls",
        "The wall clock stands still for 5 s while crates fall.",
        "simulated time neither jumps nor explodes, and the lag is reported",
        scenes.stall, (PLAIN,)),
}
