"""Cost of each feature of the island's picture in ms: the same views with and without it, in alternation."""

import statistics
import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bench.report.results import Row
from drone_engine import Scene
from drone_engine.scene import loading as scenes
from drone_engine.world import World
from drone_render.gl import context
from drone_render.node.markers import read_markers
from drone_render.renderer import Renderer
from drone_sim.wire.markers import Markers

VIEWS = ("chase", "overview", "orbit")
REPEATS = 4  # of all views, per round
SEA, SKY = "sea_view", "sky_view"  # views that show mainly one feature
ALONE = f"""
{SEA}: {{pose: [60, 0, 12, 0, 0.45, 0]}}
{SKY}: {{pose: [0, 0, 12, 0, -0.7, 0]}}
"""
WITHOUT = {
    "sky": {"sky": None}, "water": {"water": None}, "normal maps": {"normal_mapping": None},
    "highlights": {"specular": None}, "smooth edges": {"antialiasing": None},
}


class Camera:
    """A renderer and the pictures that it draws into; options: of the Renderer."""

    def __init__(self, scene: Scene, graphics: Any, views: tuple[str, ...] = VIEWS, **options: float) -> None:
        self._renderer = Renderer(scene, graphics, **options)
        sizes = {name: scene.cameras[name].size for name in views}
        self._pictures = {name: np.empty((height, width, 3), np.uint8) for name, (width, height) in sizes.items()}
        self._count = 0

    def draw(self) -> None:
        """Draws each view once, a little later than the last time."""
        self._count += 1
        for name, picture in self._pictures.items():
            self._renderer.draw_into(picture, name, self._renderer.hierarchy.start, self._count / 60)

    def spread(self) -> float:
        """Smallest standard deviation of the pixels of the last pictures; 0 for a picture of a single color."""
        return min(float(picture.std()) for picture in self._pictures.values())

    @property
    def count(self) -> int:
        """Number of pictures per call of `draw`."""
        return len(self._pictures)


class Debug(Camera):
    """With the debug view, whose lines are updated for each picture."""

    def __init__(self, scene: Scene, graphics: Any) -> None:
        super().__init__(scene, graphics)
        world = World(scene)
        world.step()
        self._shapes = read_markers(Markers(world).message(0))

    def draw(self) -> None:
        """Draws each view once, with updated lines."""
        hierarchy = self._renderer.hierarchy
        self._renderer.show(self._shapes.placed(hierarchy.names, hierarchy.world(hierarchy.start)))
        super().draw()


class Ranges(Camera):
    """Depth and labels instead of colors."""

    def __init__(self, scene: Scene, graphics: Any) -> None:
        super().__init__(scene, graphics)
        sizes = {name: scene.cameras[name].size for name in VIEWS}
        self._images = {name: (np.empty((height, width), np.float32), np.empty((height, width), np.uint16))
                        for name, (width, height) in sizes.items()}

    def draw(self) -> None:
        """Draws depth and labels of each view once."""
        for name, images in self._images.items():
            self._renderer.measure_into(*images, name, self._renderer.hierarchy.start, 0.0)

    def spread(self) -> float:
        """Ten times the smallest number of labels in a picture."""
        return 10.0 * min(len(np.unique(labels)) for _, labels in self._images.values())


def rows(rounds: int) -> Iterator[Row]:
    """The island with all features, and the cost of each feature."""
    island = scenes.load("island").with_cameras(ALONE)
    graphics = context.create()

    def changed(**change: Any) -> Scene:
        return island.model_copy(update={"render": island.render.model_copy(update=change)})

    cameras = {"everything": Camera(island, graphics)}
    for name, change in WITHOUT.items():
        if getattr(island.render, next(iter(change))) is not None:
            cameras[name] = Camera(changed(**change), graphics)
    for light in island.lights:
        lights = {name: value for name, value in island.lights.items() if name != light}
        cameras[f"light '{light}'"] = Camera(island.model_copy(update={"lights": lights}), graphics)
    cameras["the debug view"] = Debug(island, graphics)
    cameras["depth and labels"] = Ranges(island, graphics)
    sky = island.render.sky
    assert sky is not None
    cloudless = sky.model_copy(update={"clouds": None})
    cameras |= {
        "the sea alone": Camera(island, graphics, (SEA,)), "the sky alone": Camera(island, graphics, (SKY,)),
        "the sky alone, without clouds": Camera(changed(sky=cloudless), graphics, (SKY,)),
        "the sky alone, by night": Camera(changed(daylight=0.0), graphics, (SKY,)),
    }
    wall, cpu = _measure(cameras, rounds)
    for name, camera in cameras.items():
        if camera.spread() < 4.0:
            raise SystemExit(f"island, {name}: a picture of a single color")
    cpu_median = {name: statistics.median(times) for name, times in cpu.items()}
    rate = 1e3 / statistics.median(wall["everything"])
    yield Row("island, 640x480, everything on, alone", "1/s", rate, "80", rate >= 80.0,
              cpu={"ours": 1e3 / cpu_median["everything"]}, best={"ours": 1e3 / min(wall["everything"])})
    for name in [name for name in cameras if name != "everything"]:
        # Differences within a round, since the speed of the machine drifts between rounds.
        cost = statistics.median(whole - part for whole, part in zip(cpu["everything"], cpu[name], strict=True))
        if "alone" in name or name.startswith("depth"):
            cost = cpu_median[name]
        elif isinstance(cameras[name], Debug):  # the only camera that draws more than "everything"
            cost = -cost
        what = f"island, 640x480: {name}, CPU time per picture"
        yield Row(what, "ms", cost, *(("at most 3", cost <= 3.0) if name == "smooth edges" else ()))


def _measure(cameras: Mapping[str, Camera], rounds: int) -> tuple[dict[str, list[float]], dict[str, list[float]]]:
    """Wall and CPU time in ms per picture, by camera and round; the first pictures of a round refill the caches."""
    walls: dict[str, list[float]] = {name: [] for name in cameras}
    cpus: dict[str, list[float]] = {name: [] for name in cameras}
    for _ in range(rounds):
        for name, camera in cameras.items():
            camera.draw()
            wall, cpu = time.perf_counter(), time.process_time()
            for _ in range(REPEATS):
                camera.draw()
            walls[name].append(1e3 * (time.perf_counter() - wall) / (REPEATS * camera.count))
            cpus[name].append(1e3 * (time.process_time() - cpu) / (REPEATS * camera.count))
    return walls, cpus
