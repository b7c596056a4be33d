"""The page about the accuracy of motion, written from what bench.accuracy.motion has measured."""

from textwrap import fill
from typing import Any

LINE = 120  # characters
PAGE = """# What accuracy costs in motion

{summary}

![Error after a while over CPU time per simulated second, for six problems](dynamics.png)

`make accuracy` measures it anew and writes this page, [the numbers](dynamics.json) and the pictures. Here:
{processor}, one core, CPU time; other machines differ in milliseconds, not in meters.

## Integrators, steps and sub-steps

Error of the position, and CPU time per simulated second, at {row_rates} Hz:

{table}

- **free flight**: a box of 1 x 4 x 9 m, thrown and tumbling about its unstable axis for 10 s, as in the benchmark
  'boxes' of Gazebo. The path is a parabola; the attitude is known by Jacobi's elliptic functions.
- **quadrotor with motor lag**: from hovering into a curve, 2 s. The reference is our own at {reference}. Its controller
  is asked once a sub-step, so that what is left is of first order with any integrator: it is the controller's, which is
  another one at another rate.
- **bounce**: a crate falls flat from 1 m and loses nothing, 4 s.{bounce}
- **incline**: a crate slides down a slope that is half as steep again as its friction would hold, 4 s.
- **stack**: ten crates of 60 cm stand on each other for 10 s. Here the error is how far the top one has moved.

**sub-steps** are those of a step of 1/{substepped:g} s: contacts are found once a step, and solved once a sub-step.
With contacts, the other lines of ours have {in_contact} sub-steps a step. MuJoCo {mujoco} and PyBullet {pybullet} run
beside ours with friction set alike and without damping. MuJoCo's contacts are springs, so that its bounce and its
stack have an error that no step makes smaller. The published figures are those of 'boxes' at its authors' machine:
{published}.

{attitude}

## Effects

![What each effect costs, and how far off a flight is without it](dynamics_effects.png)

What a scene pays for an effect that it names, per step and for the bodies of a reference flight; and how far that
flight ends from where it does without the effect. An effect that a scene does not name costs nothing.

{effects}
"""
LEAST = 0.05  # us: less is the clock's noise
KEPT_RATES = (60.0, 240.0, 960.0)


def text(result: dict[str, Any]) -> str:
    """The page, as Markdown."""
    settings = result["settings"]
    published = "; ".join(f"{engine} {_meters(error)} off in {cost / 1000:g} s per simulated second at {step:g} ms"
                          for engine, step, error, cost in result["published"])
    page = PAGE.format(
        summary=_summary(result), processor=result["machine"]["processor"],
        row_rates=_listed(KEPT_RATES), table=_table(result["problems"]),
        reference=f"{settings['reference'][0]:g} Hz with {settings['reference'][1]} sub-steps of rk4",
        substepped=settings["substepped_rate"], in_contact=settings["in_contact"], published=published,
        bounce=_bounce(result["problems"]["bounce"]["lines"]["midpoint"]),
        attitude=_attitude(result["problems"]["flight"]), effects=_effects(result["effects"]), **settings["versions"])
    parts = page.strip().split("\n\n")
    return "\n\n".join(map(_laid_out, parts)) + "\n"


def _laid_out(part: str) -> str:
    """Paragraphs and lists within LINE."""
    if part[0] in "#!|":
        return part
    if part[0] != "-":
        return fill(" ".join(part.split()), LINE, break_on_hyphens=False)
    items = part.removeprefix("- ").split("\n- ")
    return "\n".join(fill(" ".join(item.split()), LINE, initial_indent="- ", subsequent_indent="  ",
                          break_on_hyphens=False) for item in items)


def _bounce(points: list[dict[str, Any]]) -> str:
    """What there is to say where smaller steps do not help."""
    if points[-1]["position"] < 0.1:
        return ""
    return (" Smaller steps do not help: corners that do not land in the same sub-step set it spinning, a "
            "[known failure](../hard_cases/README.md#motion).")


def _summary(result: dict[str, Any]) -> str:
    """Three sentences."""
    flight, stack = (result["problems"][name]["lines"] for name in ("flight", "stack"))
    first, second = (_at(flight[name], 240.0) for name in ("semi implicit euler", "midpoint"))
    peer, ours, theirs = _at(flight["MuJoCo"], 240.0), _at(stack["midpoint"], 240.0), _at(stack["MuJoCo"], 240.0)
    return (f"After 10 s of free flight with 240 steps a second, semi-implicit Euler is {_meters(first['position'])} "
            f"off, as MuJoCo ({_meters(peer['position'])}) and PyBullet are; the midpoint rule, our default, is off "
            f"by {_meters(second['position'])} at {second['cost_ms'] / first['cost_ms']:.2f} times the cost. "
            f"The top of a stack of ten crates moves by {_meters(ours['position'])}, in MuJoCo by "
            f"{_meters(theirs['position'])}.")


def _table(problems: dict[str, Any]) -> str:
    lines = [f"| problem | engine | {' | '.join(f'{rate:g} Hz' for rate in KEPT_RATES)} |",
             "|---|---|" + "--:|" * len(KEPT_RATES)]
    for problem in problems.values():
        for name, points in problem["lines"].items():
            if name == "sub-steps":
                continue
            cells = [f"{_meters(p['position'])}, {_ms(p['cost_ms'])}" for rate in KEPT_RATES
                     for p in points if p["rate"] == rate]
            lines.append(f"| {problem['title']} | {name} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _attitude(flight: dict[str, Any]) -> str:
    found = [f"{name} {_degrees(_at(points, 240.0)['attitude'])}" for name, points in flight["lines"].items()
             if name != "sub-steps"]
    return (f"The attitude of the tumbling box, after 10 s with 240 steps a second, is off by: {', '.join(found)}. Its "
            "axis is unstable: what a step gets wrong grows from turn to turn.")


def _effects(effects: dict[str, Any]) -> str:
    lines = ["| effect | µs a step | bodies | flight | without it, the end is off by |", "|---|--:|--:|---|--:|"]
    for name, cost in effects.items():
        lines.append(f"| {name} | {_us(cost['us'])} | {cost['bodies']} | {cost['flight']}, {cost['seconds']:g} s "
                     f"| {_meters(cost['off_m'])} |")
    return "\n".join(lines)


def _at(points: list[dict[str, Any]], rate: float) -> dict[str, Any]:
    return next(point for point in points if point["rate"] == rate)


def _listed(numbers: tuple[float, ...]) -> str:
    return ", ".join(f"{number:g}" for number in numbers[:-1]) + f" and {numbers[-1]:g}"


def _meters(value: float) -> str:
    for factor, unit in ((1.0, "m"), (1e2, "cm"), (1e3, "mm"), (1e6, "µm"), (1e9, "nm")):
        if value * factor >= 1.0:
            return f"{value * factor:.2g} {unit}" if value * factor < 100.0 else f"{value * factor:.0f} {unit}"
    return "< 1 nm"


def _us(value: float) -> str:
    return f"{value:.2f}" if value >= LEAST else f"< {LEAST}"


def _ms(value: float) -> str:
    return f"{value:.2g} ms" if value < 10.0 else f"{value:.0f} ms"


def _degrees(radians: float) -> str:
    degrees = radians * 57.29577951308232
    return f"{degrees:.0f}°" if degrees >= 10.0 else f"{degrees:.1g}°"
