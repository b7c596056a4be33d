"""`drone_engine explain SCENE`: what a scene enables and why, and the cost of each stage of a step."""

import argparse
import json
import sys

from rich import box
from rich.console import Console
from rich.table import Table

from drone_engine.explain.costs import Costs, measure
from drone_engine.explain.features import Feature, features, listed
from drone_engine.geometry.mesh import MeshError
from drone_engine.scene.errors import SceneError
from drone_engine.scene.loading import load
from drone_engine.scene.schema import Scene
from drone_engine.world import World

BAR = 15  # characters of the bar of a whole step


def as_json(scene: Scene, found: list[Feature], costs: Costs) -> str:
    """Features, costs and kernels as JSON, for programs."""
    return json.dumps({
        "scene": scene.name, "path": str(scene.path), "hash": scene.hash,
        "features": [feature._asdict() for feature in found],
        "stages": [cost._asdict() for cost in costs.stages],
        "step_us": costs.step_us, "real_time_factor": costs.real_time_factor, "kernels": costs.kernels}, indent=1)


def feature_table(found: list[Feature]) -> Table:
    """Features by group, on or off, with the reasons."""
    table = Table(box=box.SIMPLE_HEAD, title="Features", title_justify="left", title_style="bold")
    for heading in ("", "", "", "why"):
        table.add_column(heading)
    last = ""
    for group, name, on, why in found:
        if group != last and last:
            table.add_section()
        style = "" if on else "dim"
        table.add_row("" if group == last else f"[bold]{group}[/]", f"[{style or 'default'}]{name}[/]",
                      "[green]on[/]" if on else "[dim]off[/]", f"[{style or 'default'}]{why}[/]")
        last = group
    return table


def stage_table(costs: Costs) -> Table:
    """Stages of a step in order, with their kernels and costs."""
    table = Table(box=box.SIMPLE_HEAD, title="Stages of a step, in order", title_justify="left", title_style="bold")
    for heading, where in (("stage", "left"), ("kernel", "left"), ("µs", "right"), ("share", "right"), ("", "left")):
        table.add_column(heading, justify=where, no_wrap=True)  # type: ignore[arg-type]
    total = sum(cost.us for cost in costs.stages) or 1.0
    for stage, kernel, us in costs.stages:
        name = "  " + stage.removeprefix("motion: ") if stage.startswith("motion: ") else stage
        table.add_row(name, kernel or "[yellow]in Python[/]", f"{us:.2f}", f"{100 * us / total:.0f} %",
                      f"[blue]{'█' * round(BAR * us / total)}[/]")
    table.add_section()
    table.add_row("[bold]step[/]", "", f"[bold]{costs.step_us:.2f}[/]", "", "")
    return table


def explain(scene: Scene, console: Console) -> None:
    """Prints the features of a scene, the cost of its stages and its kernels; measuring takes seconds."""
    world = World(scene)
    bodies = world.model.bodies
    moving = [name for name, moves in zip(bodies.names, bodies.movable, strict=True) if moves]
    console.print(f"[bold]{scene.name}[/]  {scene.description}\n{bodies.count} bodies, of which {len(moving)} move"
                  f"{': ' if moving else ''}{listed(moving)}\n", highlight=False)
    console.print(feature_table(features(world)))
    with console.status("measuring; the first time, kernels compile"):
        costs = measure(scene)
    console.print(stage_table(costs))
    console.print(f"{costs.real_time_factor:,.0f} times real time at {scene.rates.physics:g} steps per s, on one "
                  "thread, without commands. Indented: run by motion in its sub-steps.\n",
                  highlight=False)
    count = sum(map(len, costs.kernels.values()))
    console.print(f"[bold]{count} kernels compiled[/] for this scene", highlight=False)
    for module, names in costs.kernels.items():
        console.print(f"  {module}: [dim]{', '.join(names)}[/]", highlight=False)


def main(args: list[str] | None = None) -> int:
    """The command; returns its exit status: 1, after one line on stderr, for a scene that is not valid."""
    parser = argparse.ArgumentParser(
        prog="drone_engine explain", description="Lists what a scene enables and what it costs.")
    parser.add_argument("scene", metavar="SCENE", help="a scene file, or the name of a shipped scene")
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")
    options = parser.parse_args(args)
    try:
        scene = load(options.scene)
        if options.json:
            print(as_json(scene, features(World(scene)), measure(scene)))
        else:
            explain(scene, Console())
    except (SceneError, MeshError) as error:
        print(f"drone_engine explain: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
