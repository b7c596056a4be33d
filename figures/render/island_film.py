"""Films the island for 20 s, as island.mp4 and island.gif in docs/figures: python -m figures.render.island_film.

Both drones are simulated: a controller flies the user's drone along a path, the computer's pilot flies the other one.
"""

import math

import numpy as np
from PIL import Image
from rich.progress import track
from scipy.interpolate import CubicSpline

from drone_ai.pilot import Observation, Pilot
from drone_engine import Scene, load
from drone_engine.arrays import Floats
from drone_engine.world import Command, World
from drone_render.film import Film
from drone_render.frame.history import SECOND, History, Moment, State
from drone_render.renderer import Renderer
from figures import DOCS

OUT = DOCS / "figures"
SIZE, RATE = (640, 360), 30  # pixels, pictures per s
GIF_SIZE, GIF_EVERY, GIF_TIMES = (480, 270), 4, (130, 130, 140)  # ms, repeating: GIF has hundredths of a second
COLORS, SAME = 96, 14  # of the palette; of 255, largest difference that counts as no change
CAMERAS = """
takeoff: {pose: [-2.1, -2.3, 0.9, 0, -0.06, 0.68], fov: 1.2}
behind:  {parent: user_drone, pose: [-1.7, 0, 0.55, 0, 0.16, 0], level: true, fov: 1.1}
gallery: {pose: [35.5, 10.1, 10.3], look_at: user_drone, fov: 0.85}
wooden:  {parent: ai_drone, orbit: {radius: 1.8, height: 0.55, period: 20}, fov: 1.1}
pilot:   {parent: person, pose: [0.16, 0, 1.66], look_at: user_drone, fov: 0.75}
around:  {parent: user_drone, orbit: {radius: 1.9, height: 0.6, period: 23.8}, fov: 1.1}
"""
CUTS = ((0.0, "takeoff"), (3.6, "behind"), (8.1, "gallery"), (11.2, "wooden"), (15.8, "pilot"), (18.1, "around"))  # s
DURATION = 20.0  # s
PATH = np.array([  # time in s and position of the user's drone in m: around the lighthouse and back
    (0.0, 0.0, 0.0, .11), (0.5, 0.0, 0.0, .11), (2.1, 0.1, 0.1, 1.7), (3.5, 2.2, 0.5, 2.2), (5.0, 8.5, 2.2, 3.0),
    (6.5, 16.5, 5.5, 4.0), (7.5, 22.5, 7.8, 4.5), (8.3, 27.5, 8.3, 5.6), (9.2, 32.0, 7.0, 7.0), (10.1, 37.8, 8.0, 7.6),
    (10.9, 40.5, 12.5, 7.6), (11.7, 38.0, 17.3, 6.8), (12.6, 31.5, 18.5, 5.8), (13.5, 25.0, 16.2, 5.0),
    (14.4, 18.5, 13.2, 4.4), (15.3, 12.2, 10.2, 3.8), (16.2, 6.0, 7.2, 2.9), (17.0, 1.2, 5.2, 2.3),
    (17.8, -1.3, 3.6, 2.1), (18.8, -1.0, 0.0, 1.9), (20.5, 2.5, -2.0, 2.2)])  # fmt: skip
PLACE = CubicSpline(PATH[:, 0], PATH[:, 1:])
VELOCITY = PLACE.derivative()
AHEAD, GAIN, YAW_GAIN = 0.3, 1.5, 3.0  # s of look-ahead; gains of position and yaw, 1/s


def follow(time: float, position: Floats, yaw: float) -> Command:
    """The command that keeps a drone on the path, heading along it."""
    velocity = VELOCITY(time + AHEAD)
    x, y, z = (float(v) for v in velocity + GAIN * (PLACE(time) - position))
    yaw_error = 0.0
    if math.hypot(velocity[0], velocity[1]) > 0.5:
        yaw_error = math.remainder(math.atan2(velocity[1], velocity[0]) - yaw, math.tau)
    cos, sin = math.cos(yaw), math.sin(yaw)
    return cos * x + sin * y, cos * y - sin * x, z, YAW_GAIN * yaw_error


class Flight:
    """The world of the island with both drones flying."""

    def __init__(self, scene: Scene) -> None:
        self.world = World(scene)
        patrol = scene.objects["ai_drone"].patrol
        assert patrol is not None
        self._pilot = Pilot(patrol.waypoints, patrol.speed)

    def step(self) -> None:
        """Runs one step of the simulation."""
        commands: dict[str, Command] = {"user_drone": follow(self.world.time, *self._place("user_drone"))}
        (x, y, z), yaw = self._place("ai_drone")
        if command := self._pilot.fly(Observation(self.world.time, (x, y, z), yaw, 0.0), held=False):
            commands["ai_drone"] = (*command.velocity_b, command.yaw_rate)
        self.world.step(commands)

    def _place(self, name: str) -> tuple[Floats, float]:
        """Position (3,) and heading in rad."""
        pose = self.world.pose(name)
        x, y, z, w = (float(value) for value in pose[3:])
        return pose[:3], math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def main() -> None:
    """Command line."""
    scene = load("island").with_cameras(CAMERAS)
    user_drone = scene.objects["user_drone"].model_copy(update={"pose": (*PATH[0, 1:], 0.0, 0.0, 0.0)})
    cameras = {name: scene.cameras[name].model_copy(update={"size": SIZE}) for _, name in CUTS}
    scene = scene.model_copy(update={"cameras": cameras, "objects": scene.objects | {"user_drone": user_drone}})
    flight = Flight(scene)
    film = Film(OUT / "island.mp4", SIZE, RATE)
    frames: dict[str, list[Image.Image]] = {}
    try:
        with Renderer(scene) as renderer:
            hierarchy = renderer.hierarchy
            history = History(hierarchy.names, hierarchy.start)
            history.push(0, hierarchy.names, hierarchy.poses(flight.world))
            states: tuple[State, State] | None = None
            for k in track(range(round(DURATION * RATE)), "filming"):
                time = k / RATE
                while flight.world.time < time + 1e-9:
                    flight.step()
                    poses = hierarchy.poses(flight.world)
                    states = history.push(round(flight.world.time * SECOND), hierarchy.names, poses) or states
                assert states is not None
                camera = next(name for start, name in reversed(CUTS) if start <= time)
                picture = renderer.draw(camera, Moment(round(time * SECOND), *states).poses(), time)
                film.add(picture)
                if k % GIF_EVERY == 0:
                    image = Image.fromarray(picture)
                    frames.setdefault(camera, []).append(image.resize(GIF_SIZE, Image.Resampling.LANCZOS))
    finally:
        film.close()
    drawn = [frame for cut in frames.values() for frame in _reduced(cut)]
    times = [GIF_TIMES[i % len(GIF_TIMES)] for i in range(len(drawn))]
    drawn[0].save(OUT / "island.gif", save_all=True, append_images=drawn[1:], duration=times, loop=0)
    print(OUT)


def _reduced(cut: list[Image.Image]) -> list[Image.Image]:
    """The pictures of a cut with one palette; pixels that hardly change are kept, which saves space in a GIF."""
    palette = cut[len(cut) // 2].quantize(COLORS, kmeans=2)
    shown = np.asarray(cut[0]).astype(np.int16)
    drawn = []
    for frame in cut:
        new = np.asarray(frame).astype(np.int16)
        shown = np.where((np.abs(new - shown) > SAME).any(axis=2, keepdims=True), new, shown)
        drawn.append(Image.fromarray(shown.astype(np.uint8)).quantize(palette=palette, dither=Image.Dither.NONE))
    return drawn


if __name__ == "__main__":
    main()
