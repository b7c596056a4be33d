"""What each part of the island's picture costs, in ms: the same views with it and without it, in turns."""

import statistics
import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from report import Row

from drone_render import context
from drone_render.image import Picture
from drone_render.renderer import Renderer
from drone_sim import scene as scenes
from drone_sim.scene import Scene

VIEWS = ("chase", "overview", "orbit")
REPEATS = 4  # of all views in a round
WITHOUT = {
    "the sky": {"sky": None}, "the water": {"water": None}, "normal maps": {"normal_mapping": None},
    "highlights": {"specular": None}, "smooth edges": {"antialiasing": None},
}


class Camera:
    """A renderer and what it draws into."""

    def __init__(self, scene: Scene, graphics: Any, tolerance: float | None = None) -> None:
        self._renderer = Renderer(scene, graphics, *([] if tolerance is None else [tolerance]))
        self._pictures = {name: Picture(scene.cameras[name].size, name) for name in VIEWS}
        self._count = 0

    def draw(self) -> None:
        """Every view once, a little later than before."""
        self._count += 1
        for name, picture in self._pictures.items():
            self._renderer.draw(name, self._renderer.hierarchy.start, self._count / 60, picture)

    def spread(self) -> float:
        """How far the pixels of the last pictures are from one grey, at least."""
        return min(float(np.frombuffer(picture.pixels(), np.uint8).std()) for picture in self._pictures.values())


def rows(rounds: int) -> Iterator[Row]:
    """The island whole, and what it costs more than without each of its parts."""
    island = scenes.load("island")
    graphics = context.create()
    cameras = {"everything": Camera(island, graphics), "levels of detail": Camera(island, graphics, 0.0)}
    for name, change in WITHOUT.items():
        if getattr(island.render, next(iter(change))) is not None:
            render = island.render.model_copy(update=change)
            cameras[name] = Camera(island.model_copy(update={"render": render}), graphics)
    for light in island.lights:
        lights = {name: thing for name, thing in island.lights.items() if name != light}
        cameras[f"light '{light}'"] = Camera(island.model_copy(update={"lights": lights}), graphics)
    wall, cpu = _measure(cameras, rounds)
    for name, camera in cameras.items():
        if camera.spread() < 10.0:
            raise SystemExit(f"island without {name}: a picture of one colour")
    whole, rate = 1e3 / min(cpu["everything"]), 1e3 / statistics.median(wall["everything"])
    yield Row("island, 640x480, everything on, alone", "1/s", rate, "80", rate >= 80.0, cpu={"ours": whole},
              best={"ours": 1e3 / min(wall["everything"])})
    for name in [name for name in cameras if name != "everything"]:
        cost = min(cpu["everything"]) - min(cpu[name])  # of the best rounds: others may be at work, too
        what = f"island, 640x480: {name}, CPU time a picture"
        yield Row(what, "ms", cost, *(("at most 3", cost <= 3.0) if name == "smooth edges" else ()))


def _measure(cameras: Mapping[str, Camera], rounds: int) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """ms of wall and of CPU time a picture, in each round."""
    walls: dict[str, list[float]] = {name: [] for name in cameras}
    cpus: dict[str, list[float]] = {name: [] for name in cameras}
    for camera in cameras.values():
        camera.draw()
    pictures = REPEATS * len(VIEWS)
    for _ in range(rounds):
        for name, camera in cameras.items():
            wall, cpu = time.perf_counter(), time.process_time()
            for _ in range(REPEATS):
                camera.draw()
            walls[name].append(1e3 * (time.perf_counter() - wall) / pictures)
            cpus[name].append(1e3 * (time.process_time() - cpu) / pictures)
    return walls, cpus
