"""The page docs/accuracy/collision.md, written from the measured numbers."""

from textwrap import fill
from typing import Any

LINE = 120  # characters
PAGE = """# Cost of accuracy in collision

{summary}

![Error over time per query of the four levels](collision.png)

`make accuracy` measures and writes this page, [the numbers](collision.json) and the pictures. Measured on:
{processor}, one thread, CPU time. On other machines the microseconds differ, the meters do not.

## All poses

{samples}

- **false**: the level reports a hit although the surfaces do not intersect, in % of all poses. **missed**: the level
  reports no hit although a finer level does. Levels are nested, so this is 0; otherwise `make accuracy` fails.
- **gap**: the distance of the surfaces when the level first reports a hit, mean and 95th percentile. A drone that
  collides at this level stops that far before an object.
- **depth** and **normal**: error of the depth and the normal of the deepest contact, relative to the triangle level, at
  poses where the surfaces intersect; median and 95th percentile. **none**: how often the level gives no contact there.
- **test**: CPU time of an intersection test per pose. **contacts**: CPU time of the contacts per pose, where the
  surfaces intersect.

## By model, on flights

![Distance from an object at which each level first reports a hit](collision_models.png)

{models}

## In a running scene

CPU time of broad phase and contacts per step if all bodies collide at one level, in µs, mean over the states of the
flights:

{steps}

## Method

**Flights**: a drone flies {flights} without rendering, in each toward the nearest object of each model, {passes} times:
through its center, then past it at random offsets, lengthwise and crosswise, at {speed:g} m/s; if something stops it,
it keeps pushing for a second. The bodies collide at the triangle level. The sample has the poses of the drone and of
another body in each step in which the broad phase finds the bounds of their spheres within 0.1 m of each other:
{flight_poses} poses.

**Random**: a drone approaches each of {count} models along {lines} random lines, both in random orientations. Gaps are
measured along the lines, with 1 cm between poses. All other numbers are from {each} poses on each line that ends in a
touch: half of them {deep} mm past it, half {apart} m before it, log-uniform: {random_poses} poses.

The first hit of a level is found by bisecting the step {halvings} times; it counts again only after a second without
hits. Gaps are distances of the triangle meshes, by branch and bound over both octrees. The exact answer is that of [the
triangle level](../hard_cases/README.md); a body that lies completely inside another's surface does not touch it at the
levels octree and triangle. Floors are planes, the same at each level, and left out. Times are medians of {repeats} runs
after a warm-up, of batches of at least {questions} intersection tests or {contacts} poses with contacts per pair of
models; the tables weight models by their number of poses. With the seed {seed}, poses and errors are reproducible;
times vary.
"""


def text(result: dict[str, Any], halvings: int) -> str:
    """The page as Markdown; result: contents of collision.json, halvings: bisections per first hit."""
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
    return "\n\n".join(part if part[0] in "#!|-" else _filled(part) for part in page.strip().split("\n\n")) + "\n"


def summary(samples: dict[str, Any], model_count: int) -> str:
    """Two sentences with the main results on flights past `model_count` models."""
    n = samples["flights"]
    gaps = {level: _meters(numbers["gap_mean"]) for level, numbers in n.items()}
    costs = {level: f"{numbers['question_us']:.2g}" for level, numbers in n.items()}
    return (f"On flights past {model_count} models, bounding spheres report a hit when the surfaces are still "
            f"{gaps['sphere']} apart on average, bounding boxes at {gaps['obb']}, the octree's boxes at "
            f"{gaps['octree']}; the triangle level is exact. An intersection test takes {costs['sphere']}, "
            f"{costs['obb']}, {costs['octree']} and {costs['triangle']} µs on one core, and no level misses a "
            "hit of a finer one.")


def _filled(paragraph: str) -> str:
    return fill(" ".join(paragraph.split()), LINE, break_on_hyphens=False)


def _samples(samples: dict[str, Any]) -> str:
    titles = ("poses", "level", "test", "contacts", "false", "missed", "gap (95 %)", "depth error (95 %)",
              "normal error (95 %)", "none")
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
    lines = ["| | gap: sphere | obb | octree | test: sphere | obb | octree | triangle | poses |",
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
