"""Films the island for 20 s from its own cameras: python figures/island_film.py.

Writes island.mp4 and island.gif into docs/figures. Both drones are flown by the program's pilot.
"""

import math
from pathlib import Path

import numpy as np
from PIL import Image
from rich.progress import track

from drone_ai.pilot import Observation, Pilot
from drone_render import context
from drone_render.film import Film
from drone_render.history import History, Moment, State
from drone_render.image import Picture
from drone_render.renderer import Renderer
from drone_sim.arrays import Floats
from drone_sim.cdr import SECOND
from drone_sim.rotation import compose
from drone_sim.scene import Scene, load
from drone_sim.world import Command, World

OUT = Path(__file__).parents[1] / "docs" / "figures"
SIZE, RATE = (640, 360), 30  # pixels, pictures per s
GIF_SIZE, GIF_EVERY, COLOURS = (360, 203), 4, 96
CUTS = ((0.0, "chase"), (6.0, "overview"), (10.0, "eyes"), (13.0, "ai_onboard"), (16.0, "orbit"))  # from s on
DURATION = 20.0  # s
ROUND = ((1.2, -0.8, 1.4), (0.6, -4.5, 2.2), (6.0, -4.0, 2.6), (7.6, 2.5, 2.4), (2.5, 5.0, 1.8), (-1.5, 2.0, 1.5))  # m


class Flight:
    """The island's world with a pilot for each of its drones."""

    def __init__(self, scene: Scene) -> None:
        self.world = World(scene)
        patrol = scene.objects["ai_drone"].patrol
        assert patrol is not None
        self._pilots = {"user_drone": Pilot(ROUND, 2.2, 0.8), "ai_drone": Pilot(patrol.waypoints, patrol.speed)}

    def step(self) -> None:
        """One step of the physics."""
        commands: dict[str, Command] = {}
        for name, pilot in self._pilots.items():
            x, y, z, qx, qy, qz, qw = (float(value) for value in self.world.pose(name))
            yaw = math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
            if told := pilot.fly(Observation(self.world.time, (x, y, z), yaw, 0.0), held=False):
                commands[name] = (*told.velocity_b, told.yaw_rate)
        self.world.step(commands)

    def poses(self) -> tuple[list[str], Floats]:
        """Names and poses (n, 7), in their parents' frames, of all that moves."""
        rotors, angle = self.world.model.rotors, self.world.state.rotor_angle / 2
        turn = np.zeros((len(angle), 7))
        turn[:, 5], turn[:, 6] = np.sin(angle), np.cos(angle)
        names = [*self.world.model.bodies.names, *rotors.names]
        return names, np.vstack([self.world.object_poses(), compose(rotors.pose_p, turn)])


def main() -> None:
    scene = load("island")
    cameras = {name: camera.model_copy(update={"size": SIZE}) for name, camera in scene.cameras.items()}
    scene = scene.model_copy(update={"cameras": cameras})
    flight = Flight(scene)
    film = Film(OUT / "island.mp4", SIZE, RATE)
    frames: list[Image.Image] = []
    graphics = context.create()
    try:
        with Renderer(scene, graphics) as renderer:
            history = History(renderer.hierarchy.names, renderer.hierarchy.start)
            history.push(0, *flight.poses())
            states: tuple[State, State] | None = None
            for k in track(range(round(DURATION * RATE)), "filming"):
                time = k / RATE
                while flight.world.time < time + 1e-9:
                    flight.step()
                    states = history.push(round(flight.world.time * SECOND), *flight.poses()) or states
                assert states is not None
                camera = next(name for start, name in reversed(CUTS) if start <= time)
                picture = Picture(SIZE, camera)
                renderer.draw(camera, Moment(round(time * SECOND), *states).poses(), time, picture)
                film.add(picture.pixels())
                if k % GIF_EVERY == 0:
                    image = Image.frombytes("RGB", SIZE, picture.pixels())
                    frames.append(image.resize(GIF_SIZE, Image.Resampling.LANCZOS))
    finally:
        film.close()
        graphics.release()
    palette = _palette(frames)
    drawn = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    drawn[0].save(OUT / "island.gif", save_all=True, append_images=drawn[1:], duration=1000 * GIF_EVERY / RATE, loop=0)
    print(OUT)


def _palette(frames: list[Image.Image]) -> Image.Image:
    """The colours of a picture from each cut."""
    sheet = Image.new("RGB", (GIF_SIZE[0], len(CUTS) * GIF_SIZE[1]))
    for i, (start, _) in enumerate(CUTS):
        sheet.paste(frames[int((start + 1.5) * RATE / GIF_EVERY)], (0, i * GIF_SIZE[1]))
    return sheet.quantize(COLOURS, kmeans=2)


if __name__ == "__main__":
    main()
