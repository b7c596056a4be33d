"""Sliding over the joints of flat surfaces, and falling on them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drone_engine import parse
from drone_engine.math.rotation import matrix
from drone_engine.world import World
from reference.shapes import flat_sheet, write_box

G = 9.80665


@pytest.fixture
def sliding(tmp_path: Path) -> Callable[..., World]:
    """A crate of 0.6 m that moves over tiles of 0.3 m or over a mesh of triangles."""
    (tmp_path / "models").mkdir()
    (tmp_path / "scenes").mkdir()
    write_box(tmp_path / "models" / "tile.obj", (0.3, 0.3, 0.3), 0.0)
    write_box(tmp_path / "models" / "crate.obj", (0.6, 0.6, 0.6), 0.0)
    vertices, faces = flat_sheet(12)
    (tmp_path / "models" / "net.obj").write_text(
        "".join(f"v {0.4 * x - 1} {0.4 * y - 2} 0\n" for x, y, _ in vertices)
        + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))

    def make(ground: str, level: str, rate: int, substeps: int, friction: float, step: float = 0.0) -> World:
        material = f"friction: {friction}, restitution: 0"
        lines = [f"crate: {{model: crate, mass: 10, {material}, pose: [0, 0, 0.3]}}"]
        if ground == "net":
            lines += [f"net: {{model: net, static: true, {material}}}"]
        else:
            lines += [f"tile_{i}_{j}: {{model: tile, static: true, {material}, "
                      f"pose: [{0.3 * i - 0.45}, {0.3 * j - 0.45}, {-0.15 + (step if i > 5 else 0.0)}]}}"
                      for i in range(12) for j in range(8)]
        text = (f"version: 1\nrates: {{physics: {rate}}}\ndynamics: {{substeps: {substeps}, sleep: false}}\n"
                f"effects: {{gravity: {{}}}}\ncollision: {{level: {level}}}\nobjects:\n  " + "\n  ".join(lines) + "\n")
        return World(parse(text, tmp_path / "scenes" / "sliding.yaml"))

    return make


@pytest.mark.parametrize(("rate", "substeps"), [(30, 8), (240, 1)])
@pytest.mark.parametrize(("ground", "level"), [("tiles", "obb"), ("tiles", "triangle"), ("net", "triangle")])
def test_a_crate_slides_over_joints_as_over_a_plane(sliding: Callable[..., World], ground: str, level: str, rate: int,
                                                    substeps: int) -> None:
    for friction, velocity in ((0.0, (1.7, 0.4)), (0.3, (2.0, 0.3))):
        world = sliding(ground, level, rate, substeps, friction)
        world.state.velocity_w[0, :2] = velocity
        highest = 0.3
        for _ in range(rate):
            world.step()
            highest = max(highest, world.state.position_w[0, 2])
        speed, time = float(np.hypot(*velocity)), 1.0
        time = min(time, speed / (friction * G)) if friction else time
        way = np.linalg.norm(world.state.position_w[0, :2])
        assert way == pytest.approx(speed * time - 0.5 * friction * G * time**2, rel=0.01)
        assert highest < 0.3005


@pytest.mark.parametrize("level", ["obb", "triangle"])
def test_a_step_of_a_millimeter_stops_or_lifts_a_crate(sliding: Callable[..., World], level: str) -> None:
    world = sliding("tiles", level, 240, 1, 0.0, step=0.001)
    world.state.velocity_w[0, 0] = 1.0
    world.run(480)
    assert world.state.position_w[0, 0] < 0.76 or world.state.position_w[0, 2] > 0.3004  # half of it, or all


@pytest.mark.parametrize(("rate", "substeps"), [(30, 8), (240, 1)])
def test_a_block_that_falls_on_another_stays_outside(sliding: Callable[..., World], rate: int, substeps: int) -> None:
    world = sliding("tiles", "triangle", rate, substeps, 0.6)
    for seed in range(4):
        world.reset()
        rng = np.random.default_rng(seed)
        turn = rng.normal(size=4)
        world.state.orientation_w[0] = turn / np.linalg.norm(turn)
        world.state.position_w[0] = (0.6, 0.3, 0.8)
        for step in range(2 * rate):
            world.step()
            lowest = -0.3 * np.abs(matrix(*world.state.orientation_w[0])[6:9]).sum()
            if step > rate // 2:
                assert world.state.position_w[0, 2] + lowest > -0.005
