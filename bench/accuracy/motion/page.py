"""The page docs/accuracy/dynamics.md, written from the measured numbers."""

from textwrap import fill
from typing import Any

LINE = 120  # characters
PAGE = """# Cost of accuracy in motion

{summary}

![Error at the end over CPU time per simulated second, for six problems](dynamics.png)

`make accuracy` measures and writes this page, [the numbers](dynamics.json) and the pictures. Measured on:
{processor}, one core, CPU time. On other machines the milliseconds differ, the meters do not.

## Integrators, steps and sub-steps

Position error, and CPU time per simulated second, at {row_rates} Hz:

{table}

- **free flight**: a box of 1 x 4 x 9 m, thrown and tumbling about its unstable axis for 10 s, as in Gazebo's benchmark
  'boxes'. The path is a parabola; Jacobi's elliptic functions give the attitude.
- **quadrotor with motor lag**: from hovering into a curve, 2 s. The reference is our own run at {reference}. The
  controller runs once per sub-step, so the error is of first order with any integrator: a controller at another rate is
  a different controller.
- **bounce**: a crate falls flat from 1 m with restitution 1, 4 s.{bounce}
- **incline**: a crate slides down a slope at 1.5 times the friction angle, 4 s.
- **stack**: ten crates of 60 cm stand on each other for 10 s. The error is the motion of the top crate.

**sub-steps** divide a step of 1/{substepped:g} s: contacts are detected once per step and solved once per sub-step.
With contacts, our other curves have {in_contact} sub-steps per step. MuJoCo {mujoco} and PyBullet {pybullet} run with
equal friction and without damping. MuJoCo's contacts are springs, so smaller steps do not remove the error of its
bounce and stack. The published figures are results of 'boxes' on its authors' machine: {published}.

{attitude}

## Effects

![CPU time of each effect, and its influence on a flight](dynamics_effects.png)

CPU time that an effect adds to a step, for the bodies of a reference flight, and the distance between the ends of that
flight with and without the effect. An effect that a scene does not use costs nothing.

{effects}
"""
LEAST = 0.05  # us, resolution of the measurement
KEPT_RATES = (60.0, 240.0, 960.0)


def text(result: dict[str, Any]) -> str:
    """The page as Markdown; result: contents of dynamics.json."""
    settings = result["settings"]
    published = "; ".join(f"{engine} {_meters(error)} error, {cost / 1000:g} s per simulated second at {step:g} ms"
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
    """Paragraphs and lists, filled to LINE characters."""
    if part[0] in "#!|":
        return part
    if part[0] != "-":
        return fill(" ".join(part.split()), LINE, break_on_hyphens=False)
    items = part.removeprefix("- ").split("\n- ")
    return "\n".join(fill(" ".join(item.split()), LINE, initial_indent="- ", subsequent_indent="  ",
                          break_on_hyphens=False) for item in items)


def _bounce(points: list[dict[str, Any]]) -> str:
    """A sentence about bounces, if smaller steps do not reduce their error."""
    if points[-1]["position"] < 0.1:
        return ""
    return (" Smaller steps do not help: corners that do not land in the same sub-step cause a rotation, a "
            "[known failure](../hard_cases/README.md#motion).")


def _summary(result: dict[str, Any]) -> str:
    """Three sentences with the main results."""
    flight, stack = (result["problems"][name]["lines"] for name in ("flight", "stack"))
    first, second = (_at(flight[name], 240.0) for name in ("semi implicit euler", "midpoint"))
    peer, ours, theirs = _at(flight["MuJoCo"], 240.0), _at(stack["midpoint"], 240.0), _at(stack["MuJoCo"], 240.0)
    return (f"After 10 s of free flight with 240 steps per second, semi-implicit Euler has a position error of "
            f"{_meters(first['position'])}, like MuJoCo ({_meters(peer['position'])}) and PyBullet; the midpoint rule, "
            f"the default, one of {_meters(second['position'])} at {second['cost_ms'] / first['cost_ms']:.2f} times "
            f"the cost. The top of a stack of ten crates moves by {_meters(ours['position'])}, in MuJoCo by "
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
    return (f"Attitude error of the tumbling box after 10 s with 240 steps per second: {', '.join(found)}. The "
            "rotation axis is unstable, so the error of a step grows with each revolution.")


def _effects(effects: dict[str, Any]) -> str:
    lines = ["| effect | µs per step | bodies | flight | change of the end without it |", "|---|--:|--:|---|--:|"]
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
