"""Bodies under gravity and contacts: they fall, rest, slide, push and are pushed as mechanics says."""

from collections.abc import Callable

import numpy as np
import pytest

from drone_engine.collision.events import Phase
from drone_engine.world import World

G = 9.80665
FLOOR = "floor: {model: floor, static: true, collision: {level: floor}}\n"
Make = Callable[..., World]


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / world.dt)):
        world.step()


@pytest.mark.parametrize("rate", [30, 60, 240])
@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "midpoint", "rk4"])
def test_free_fall_is_that_of_the_integrator(world: Make, rate: int, integrator: str) -> None:
    fall = world("crate: {model: crate, mass: 5}", f"rates: {{physics: {rate}}}\neffects: {{gravity: {{}}}}\n"
                                                   f"dynamics: {{integrator: {integrator}}}")
    run(fall, 1.0)
    h = fall.dt / fall.scene.dynamics.substeps if integrator == "semi_implicit_euler" else 0.0
    assert fall.pose("crate")[2] == pytest.approx(-0.5 * G * (1 + h), abs=1e-9)  # only the first is off, by g t h / 2
    assert fall.state.velocity_w[0, 2] == pytest.approx(-G)


def test_without_gravity_nothing_moves(world: Make) -> None:
    still = world("crate: {model: crate, mass: 5, pose: [0, 0, 1]}", "effects: {}")
    start = still.state.position_w.copy()
    run(still, 2.0)
    np.testing.assert_array_equal(still.state.position_w, start)


def test_a_crate_rests_on_the_floor(world: Make) -> None:
    rest = world(FLOOR + "crate: {model: crate, mass: 5, pose: [0, 0, 0.5]}")
    run(rest, 5.0)
    assert abs(rest.pose("crate")[2]) < 0.001
    assert np.abs(rest.state.velocity_w).max() < 0.001
    assert [event.phase for event in rest.events] == [Phase.PERSIST]
    assert rest.events[0].impulse == pytest.approx(5 * G * rest.dt, rel=0.02)
    assert rest.events[0].normal == (0.0, 0.0, 1.0)


def test_a_stack_stands(world: Make) -> None:
    stack = world(FLOOR + "crate: {model: crate, mass: 5, poses: [[0, 0, 0], [0, 0, 0.6], [0, 0, 1.2], [0, 0, 1.8]]}")
    run(stack, 10.0)
    np.testing.assert_allclose(stack.pose("crate_3")[:3], [0, 0, 1.8], atol=0.005)


@pytest.mark.parametrize("friction", [0.2, 0.5])
def test_friction_stops_a_slide_after_the_distance_of_coulomb(world: Make, friction: float) -> None:
    slide = world(FLOOR.replace("static", f"friction: {friction}, static")
                  + f"crate: {{model: crate, mass: 5, friction: {friction}}}")
    slide.step()
    slide.state.velocity_w[1, 0] = 2.0
    before = slide.pose("crate")[0]
    run(slide, 4.0)
    assert slide.pose("crate")[0] - before == pytest.approx(2.0**2 / (2 * friction * G), rel=0.05)


@pytest.mark.parametrize(("rate", "substeps"), [(30, 8), (240, 1)])
@pytest.mark.parametrize("heading", [0.4, 0.785, 1.9])
def test_friction_opposes_the_sliding_of_an_oblong_body(world: Make, rate: int, substeps: int, heading: float) -> None:
    slide = world(FLOOR.replace("static", "friction: 0.2, static") + "wall: {model: wall, mass: 5, friction: 0.2}",
                  f"rates: {{physics: {rate}}}\neffects: {{gravity: {{}}}}\ndynamics: {{substeps: {substeps}}}")
    slide.step()
    before, along = slide.pose("wall")[:2], np.array([np.cos(heading), np.sin(heading)])
    slide.state.velocity_w[1, :2] = 3.0 * along
    run(slide, 2.0)
    way, expected = slide.pose("wall")[:2] - before, 3.0**2 / (2 * 0.2 * G)
    assert way @ along == pytest.approx(expected, rel=0.01)
    assert abs(along[0] * way[1] - along[1] * way[0]) < 0.01 * expected


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_bounce_returns_the_speed_of_restitution(world: Make, restitution: float) -> None:
    drop = world(FLOOR.replace("static", "restitution: 0, static")
                 + f"crate: {{model: crate, mass: 5, restitution: {restitution}, pose: [0, 0, 1]}}",
                 "rates: {physics: 240}\neffects: {gravity: {}}")
    while drop.state.velocity_w[1, 2] <= 0.0 and drop.time < 1.0:
        lowest = drop.state.velocity_w[1, 2]
        drop.step()
    assert drop.state.velocity_w[1, 2] == pytest.approx(-restitution * lowest, abs=0.1)


def test_a_moving_crate_pushes_another_and_momentum_stays(world: Make) -> None:
    pair = world("crate: {model: crate, mass: 5, poses: [[0, 0, 0], [1, 0, 0]]}", "effects: {}")
    pair.state.velocity_w[0, 0] = 3.0
    run(pair, 1.0)
    assert pair.state.velocity_w[1, 0] > 1.0
    assert 5 * pair.state.velocity_w[:, 0].sum() == pytest.approx(15.0)


def test_a_static_thing_does_not_move_and_is_not_passed(world: Make) -> None:
    hit = world("crate: {model: crate, mass: 50, pose: [0, 0, 2]}\nwall: {model: wall, static: true, pose: [5, 0, 0]}",
                "effects: {}")
    before = hit.pose("wall")
    hit.state.velocity_w[0, 0] = 25.0  # more than its own size a step
    run(hit, 2.0)
    np.testing.assert_array_equal(hit.pose("wall"), before)
    assert hit.pose("crate")[0] < 4.21


def test_spawned_inside_each_other_they_part_slowly(world: Make) -> None:
    inside = world("crate: {model: crate, mass: 5, poses: [[0, 0, 0], [0.3, 0, 0]]}", "effects: {}")
    fastest = 0.0
    for _ in range(60):
        inside.step()
        fastest = max(fastest, float(np.linalg.norm(inside.state.velocity_w, axis=1).max()))
    assert inside.pose("crate_1")[0] - inside.pose("crate_0")[0] > 0.59
    assert fastest < 1.0


def test_fast_spin_about_the_middle_axis_gains_no_energy(world: Make) -> None:
    spin = world("wall: {model: wall, mass: 5}", "effects: {}\nrates: {physics: 240}")
    inertia = spin.model.bodies.inertia_b[0]
    spin.state.angular_velocity_w[0] = np.array([0.01, 0.01, 0.01]) + 20.0 * (np.argsort(np.argsort(inertia)) == 1)

    def energy() -> float:
        q, w = spin.state.orientation_w[0], spin.state.angular_velocity_w[0]
        axis, scalar = -q[:3], q[3]
        body = w + 2 * np.cross(axis, np.cross(axis, w) + scalar * w)
        return float(0.5 * (inertia * body**2).sum())

    start = energy()
    run(spin, 10.0)
    assert energy() <= start * 1.001
    assert np.linalg.norm(spin.state.orientation_w[0]) == pytest.approx(1.0, abs=1e-12)
