"""The page about the accuracy of collision, written from what bench.accuracy.collision has measured."""

from textwrap import fill
from typing import Any

LINE = 120  # characters
PAGE = """# What accuracy costs in collision

{summary}

![Error over time per query of the four levels](collision.png)

`make accuracy` measures it anew and writes this page, [the numbers](collision.json) and the pictures. Here:
{processor}, one thread, CPU time; other machines differ in microseconds, not in meters.

## All poses

{samples}

- **false**: the level says that two bodies touch, and their surfaces do not, in % of all poses. **missed**: it says no,
  and a finer level says yes. Levels are nested, so this is 0, or `make accuracy` fails.
- **gap**: how far the surfaces are apart when the level begins to say that they touch, the mean and what 95 % stay
  below. It is how far before a thing a drone stops that collides at this level.
- **depth** and **normal**: of the deepest contact that a solver gets, how far its depth and the direction of its normal
  are from those of the triangle level, which are the reference, where the surfaces meet; the median and what 95 % stay
  below. **none**: how often a solver gets no contact there that pushes them apart.
- **yes or no**: what the question costs per pose. **contacts**: what those for a solver cost where the surfaces meet.

## By model, on flights

![How far before a thing each level says that the drone touches it](collision_models.png)

{models}

## In a running scene

What broad phase and contacts of one step cost if all bodies meet at one level, in µs, over the states of the flights:

{steps}

## What was measured

**Flights**: a drone flies {flights} without a picture, in each at the nearest thing of each model, {passes} times
in turn: through its middle, then past it at random offsets, along and across, at {speed:g} m/s; it pushes on for a
second where something stops it. The bodies meet at the triangle level. A pose is that of the drone and of another body,
in each step in which the broad phase finds their bounding spheres' boxes within 0.1 m: {flight_poses} of them.

**Random**: a drone comes at each of {count} models along {lines} random lines, both turned at random. Gaps are those of
the lines, 1 cm from one pose to the next. All else is from {each} poses on each line that ends in a touch: half of them
{deep} mm past it, half {apart} m before it, as many in each decade: {random_poses} of them.

The moment at which a level begins to say yes is found by halving the step {halvings} times; a second has to pass
without a hit before the next one counts. Gaps are distances of the triangles, by branch and bound over both octrees.
The exact answer of two surfaces is that of [the triangle level](../hard_cases/README.md); a body wholly inside
another's surface does not touch it at the levels octree and triangle. Floors are planes, the same at each level, and
left out. Times are medians of {repeats} runs, after one to warm up, of batches of at least {questions} questions or
{contacts} poses with contacts of one pair of models; the tables weigh models by their poses. The seed is {seed}: poses
and errors repeat, times vary.
"""


def text(result: dict[str, Any], halvings: int) -> str:
    """The page, as Markdown."""
    settings, samples = result["settings"], result["samples"]
    scenes = list(settings["passes"])
    page = PAGE.format(
        summary=summary(samples, len(result["models"]["flights"])), processor=result["machine"]["processor"],
        samples=_samples(samples),
        models=_models(result["models"]["flights"]), steps=_steps(result["detection_us"]),
        flights=" and ".join([", ".join(f"the {scene}" for scene in scenes[:-1])] * (len(scenes) > 1)
                             + [f"the {scenes[-1]}"]),
        passes=" or ".join(str(n) for n in sorted(set(settings["passes"].values()))), speed=settings["speed"],
        flight_poses=f"{samples['flights']['triangle']['poses']:,}", count=len(settings["models"]),
        lines=settings["lines"], each=settings["poses_each"], deep=_range(settings["deep"], 1000.0),
        apart=_range(settings["apart"]), random_poses=f"{samples['random']['triangle']['poses']:,}", halvings=halvings,
        **{name: settings[name] for name in ("repeats", "contacts", "questions", "seed")})
    return "\n\n".join(part if part[0] in "#!|-" else _wrapped(part) for part in page.strip().split("\n\n")) + "\n"


def summary(samples: dict[str, Any], things: int) -> str:
    """Two sentences."""
    n = samples["flights"]
    gaps = {level: _meters(numbers["gap_mean"]) for level, numbers in n.items()}
    costs = {level: f"{numbers['question_us']:.2g}" for level, numbers in n.items()}
    return (f"On flights past {things} models, one ball around each body says that the drone touches something "
            f"while the surfaces are still {gaps['sphere']} apart on average, one box at {gaps['obb']}, small "
            f"boxes around the surface at {gaps['octree']}; the triangles themselves are exact. Asking costs "
            f"{costs['sphere']}, {costs['obb']}, {costs['octree']} and {costs['triangle']} µs of one core, and no "
            "level misses what a finer one finds.")


def _wrapped(paragraph: str) -> str:
    return fill(" ".join(paragraph.split()), LINE, break_on_hyphens=False)


def _samples(samples: dict[str, Any]) -> str:
    titles = ("poses", "level", "yes or no", "contacts", "false", "missed", "gap (95 %)", "depth off (95 %)",
              "normal off (95 %)", "none")
    lines = [f"| {' | '.join(titles)} |", "|---|---|" + "--:|" * 8]
    for sample, levels in samples.items():
        for name, n in levels.items():
            lines.append(f"| {sample} | {name} | {n['question_us']:.2f} µs | {n['answer_us']:.1f} µs "
                         f"| {100 * n['false'] / n['poses']:.1f} % | {n['missed']} "
                         f"| {_meters(n['gap_mean'])} ({_meters(n['gap_95'])}) "
                         f"| {_meters(n['depth_median'])} ({_meters(n['depth_95'])}) "
                         f"| {_degrees(n['normal_median'])} ({_degrees(n['normal_95'])}) "
                         f"| {100 * n['silent'] / n['contacts']:.1f} % |")
    return "\n".join(lines)


def _models(models: dict[str, Any]) -> str:
    lines = ["| | gap: sphere | obb | octree | yes or no: sphere | obb | octree | triangle | poses |",
             "|---|--:|--:|--:|--:|--:|--:|--:|--:|"]
    for model, n in sorted(models.items(), key=lambda item: -(item[1]["obb"]["gap_mean"] or 0.0)):
        gaps = " | ".join(_meters(n[level]["gap_mean"]) for level in ("sphere", "obb", "octree"))
        times = " | ".join(f"{n[level]['question_us']:.2f} µs" for level in n)
        lines.append(f"| {model.replace('_', ' ')} | {gaps} | {times} | {n['obb']['poses']:,} |")
    return "\n".join(lines)


def _steps(costs: dict[str, dict[str, float]]) -> str:
    levels = list(next(iter(costs.values())))
    rows = [f"| {scene} | {' | '.join(f'{us:.0f}' for us in by.values())} |" for scene, by in costs.items()]
    return "\n".join([f"| | {' | '.join(levels)} |", "|---|" + "--:|" * len(levels), *rows])


def _range(ends: tuple[float, float], scale: float = 1.0) -> str:
    return f"{scale * ends[0]:g} to {scale * ends[1]:g}"


def _meters(value: float | None) -> str:
    if value is None:
        return "–"
    if value == 0.0:
        return "0"
    scaled, unit = (value, "m") if value >= 1.0 else (100 * value, "cm") if value >= 0.01 else (1000 * value, "mm")
    return f"{scaled:.1f} {unit}" if scaled < 10.0 else f"{scaled:.0f} {unit}"


def _degrees(value: float | None) -> str:
    return "–" if value is None else f"{value:.0f}°"
