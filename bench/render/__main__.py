"""Frame rates without a GPU, beside other renderers: the same scene, read-back included.

A hill of 32,768 triangles and 40 balls of 1,008, at three picture sizes; each renderer in its own process, all in
alternation. Ours lights per pixel with four lights and normal maps; a plain loop that draws all of it in full detail
is the reference. The other renderers light per vertex, with one to three lights and without normal maps. pyrender and
pygfx are not included: the former needs its own PyOpenGL, the latter a Vulkan driver; on this scene both reach a fifth
of the others' rates. Then the island: its frame rate with all features, and the cost of each feature.
"""

import argparse
import statistics
import tempfile
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import numpy as np
from PIL import Image

from bench.render import features
from bench.render.scene import SIZES
from bench.render.workers import PEERS, Worker
from bench.report.results import Row, report

ASKED = {(320, 240): 200.0, (640, 480): 90.0, (1280, 720): 45.0}  # pictures per s, targets
PLAIN = {(320, 240): 89.0, (640, 480): 49.0, (1280, 720): 28.0}  # the plain loop, on the machine of these targets
DIFFERENCE = 2.0  # of 255, mean over a picture
FULL = "plain moderngl loop"
SMOOTH = "ours, edges smoothed"
VIEWS = (0, 60, 111, 170, 222)  # numbers of the compared pictures


def start() -> tuple[dict[str, Worker], dict[str, str]]:
    """All renderers that work on this machine, and a description of how each draws."""
    workers, about = {name: Worker(name) for name in PEERS}, {}
    for name in PEERS:
        try:
            about[name] = workers[name].about()
            print(f"{name}: {about[name]}", flush=True)
        except RuntimeError as error:
            workers.pop(name).close()
            print(f"{name}: left out: {error}", flush=True)
    return workers, about


def speeds(workers: dict[str, Worker], size: tuple[int, int], rounds: int, pictures: int) -> Iterator[Row]:
    """Rows of pictures per second at a size, and the cost of smooth edges."""
    for worker in workers.values():
        if worker.ask(size=size) < 10.0:
            raise SystemExit(f"{worker.name} draws a picture of a single color")
        worker.draw(3, 0)
    taken: dict[str, list[tuple[float, float]]] = {name: [] for name in workers}
    for k in range(rounds):
        for name, worker in workers.items():
            taken[name].append(worker.draw(pictures, k * pictures))
    wall, cpu = ({name: statistics.median(times[i] for times in all_) / pictures for name, all_ in taken.items()}
                 for i in (0, 1))
    rates = {name: 1 / value for name, value in wall.items()}
    best = {name: pictures / min(times[0] for times in all_) for name, all_ in taken.items()}
    ours, smooth = rates.pop("ours"), rates.pop(SMOOTH)
    what = f"{size[0]}x{size[1]}"
    yield Row(what, "1/s", ours, f"{ASKED[size]:g}", ours >= ASKED[size], rates, ours / max(rates.values()),
              {name: 1 / value for name, value in cpu.items()}, best)
    factor, target = ours / rates[FULL], ASKED[size] / PLAIN[size]
    yield Row(f"{what}, over the plain loop", "times", factor, f"at least {target:.3g}", factor >= target)
    yield Row(f"{what}, edges smoothed", "1/s", smooth, cpu={"ours": 1 / cpu[SMOOTH]}, best={"ours": best[SMOOTH]})
    cost = 1e3 * (cpu[SMOOTH] - cpu["ours"])
    yield Row(f"{what}: smooth edges, CPU time per picture", "ms", cost, *(("at most 3", cost <= 3.0)
                                                                         if size == (640, 480) else ()))


def difference(workers: dict[str, Worker], size: tuple[int, int], folder: Path) -> Row:
    """Row of the mean difference between our pictures and those of the plain loop."""
    off = []
    for view in VIEWS:
        for name in ("ours", FULL):
            workers[name].ask(save=view, path=str(folder / f"{name}.png"))
        ours, full = (np.asarray(Image.open(folder / f"{name}.png"), np.float64) for name in ("ours", FULL))
        off.append(float(np.abs(ours - full).mean()))
    mean = statistics.mean(off)
    return Row(f"{size[0]}x{size[1]}: difference from full detail", "of 255", mean, f"at most {DIFFERENCE:g}",
               mean <= DIFFERENCE)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer rounds, under a minute")
    rounds, pictures = (3, 5) if parser.parse_args().quick else (9, 15)
    workers, about = start()
    rows = []
    try:
        with tempfile.TemporaryDirectory() as folder:
            for size in SIZES:
                rows += [*speeds(workers, size, rounds, pictures), difference(workers, size, Path(folder))]
                done = next(row for row in reversed(rows) if row.unit == "1/s" and row.peers)
                print(f"{done.work}: ours {done.ours:.4g} pictures a second", flush=True)
    finally:
        for worker in workers.values():
            worker.close()
    rows += features.rows(rounds)
    versions = {name: version(name) for name in ("moderngl", "panda3d", "mujoco", "pybullet")}
    report("render", {"numbers": f"medians over {rounds} rounds of {pictures} pictures, renderers in alternation",
                      "renderers": about, **versions}, rows)


if __name__ == "__main__":
    main()
