"""Forces of effects against closed forms, published numbers and the conservation laws."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from drone_engine import parse
from drone_engine.collision.terrain.height_field import NO_GROUND
from drone_engine.effects import ground_effect, water
from drone_engine.effects.disks import Disks, disks
from drone_engine.effects.submerged import ROWS, submerged
from drone_engine.math.rotation import matrix
from drone_engine.world import World
from reference.shapes import write_box

Make = Callable[..., World]
G = 9.80665
CRATE = "crate: {model: crate, mass: %g, pose: [0, 0, %g]}"  # a cube of 0.6 m that stands on its origin
FOUR = "".join(f"r{k}: {{model: rotor, parent: drone, pose: [{x}, {y}, 0], rotor: {{direction: {turn}}}}}\n"
               for k, (x, y, turn) in enumerate([(0.2, -0.2, 1), (0.2, 0.2, -1), (-0.2, 0.2, 1), (-0.2, -0.2, -1)]))
DRONE = ("drone: {model: drone, mass: 1.4, pose: [0, 0, 1], flight: {}}\n"
         "rotor: {model: rotor, parent: drone, pose: [0.2, 0.1, 0.05], rotor: {direction: 1}}\n")
FLOOR = "floor: {model: floor, static: true, collision: {level: floor}}\n"


def run(world: World, seconds: float) -> None:
    world.run(round(seconds / world.dt))


def body_rates(world: World, i: int = 0) -> np.ndarray:
    """Angular velocity in the body's frame."""
    m = np.array(matrix(*world.state.orientation_w[i])).reshape(3, 3)
    rates: np.ndarray = m.T @ world.state.angular_velocity_w[i]
    return rates


# Linear drag

def test_linear_drag_decays_exponentially_along_each_axis(world: Make) -> None:
    glide = world("crate: {model: crate, mass: 2, pose: [0, 0, 0, 0, 0, 0.5]}",
                  "rates: {physics: 1000}\neffects: {linear_drag: {rate: [0.2, 0.5, 1.0], spin: 0.7, bodies: all}}")
    m = np.array(matrix(*glide.state.orientation_w[0])).reshape(3, 3)
    glide.state.velocity_w[0] = m @ [1.0, 2.0, 3.0]
    run(glide, 2.0)
    np.testing.assert_allclose(m.T @ glide.state.velocity_w[0], [1, 2, 3] * np.exp(np.multiply([-0.2, -0.5, -1], 2)),
                               rtol=2e-4)
    glide.state.angular_velocity_w[0] = [0.0, 0.0, 2.0]
    run(glide, 1.0)
    assert glide.state.angular_velocity_w[0, 2] == pytest.approx(2.0 * math.exp(-0.7), rel=2e-4)


def test_linear_drag_is_of_drones_unless_the_scene_says_otherwise(world: Make) -> None:
    both = world(DRONE + CRATE % (2, 5), "effects: {linear_drag: {}}")
    both.state.velocity_w[1, 0] = 3.0
    run(both, 1.0)
    assert both.state.velocity_w[1, 0] == 3.0


# Ground effect

@pytest.mark.parametrize(("height", "ratio"), [(0.5, 4 / 3), (1.0, 16 / 15), (2.0, 64 / 63), (0.1, 4 / 3)])
def test_thrust_near_the_ground_is_that_of_cheeseman_and_bennett(height: float, ratio: float) -> None:
    assert 1.0 + ground_effect.gain(0.12, height * 0.12, 0.0, 5.0) == pytest.approx(ratio)


def test_speed_along_the_ground_takes_the_gain_away() -> None:
    gains = [ground_effect.gain(0.12, 0.12, speed, 5.0) for speed in (0.0, 5.0, 50.0)]
    assert gains[0] > gains[1] > gains[2]
    assert gains[1] == pytest.approx(1 / 31)  # half of (R / 4 z)^2 at V = v_i
    assert gains[2] < 1e-3


def test_each_rotor_gains_over_the_floor_below_it() -> None:
    def lifted(height: float, roll: float = 0.0, floors: tuple[float, ...] = (-3.0, 0.0)) -> tuple[np.ndarray, ...]:
        place, axis = np.array([[0.2, 0.1, 0.05]]), np.array([[0.0, 0.0, 1.0]])
        force, torque = np.zeros((1, 3)), np.zeros((1, 3))
        rotor = Disks(np.zeros(1, np.int64), place, axis, np.array([0.1]))
        ground_effect.lift(np.array(floors), NO_GROUND, rotor, np.array([3.0]), np.array([[0.0, 0.0, height]]),
                           np.array([[math.sin(roll / 2), 0.0, 0.0, math.cos(roll / 2)]]),
                           np.zeros((1, 3)), np.empty((0, 3)), 1.225, force, torque)
        return force[0], torque[0]

    force, torque = lifted(0.05)  # the rotor at z = R
    np.testing.assert_allclose(force, [0, 0, 3.0 / 15.0])
    np.testing.assert_allclose(torque, np.cross([0.2, 0.1, 0.05], force))
    assert lifted(-0.2)[0][2] < 1e-3  # over the lower floor
    np.testing.assert_array_equal(lifted(-0.2, floors=(0.0,))[0], 0.0)
    np.testing.assert_array_equal(lifted(0.05, roll=math.pi)[0], 0.0)
    tilted = lifted(0.05, roll=0.3)[0]
    assert tilted[1] < 0.0 < tilted[2] and tilted[2] / -tilted[1] == pytest.approx(1 / math.tan(0.3))


def test_a_quadrotor_hovers_close_to_the_ground_with_less(world: Make) -> None:
    """Its rotors push with more than their rates say, so they turn slower."""
    hover = world(FLOOR + "drone: {model: drone, mass: 1.4, pose: [0, 0, 0.1], flight: {model: quadrotor}}\n" + FOUR,
                  "effects: {gravity: {}, ground_effect: {}}")
    run(hover, 10.0)
    height = hover.pose("drone")[2]
    assert 0.09 < height < 0.25
    ratio = 1.0 + ground_effect.gain(0.1, height, 0.0, 1.0)
    wanted = math.sqrt(1.4 * G / (4 * 8.54858e-06 * ratio))
    np.testing.assert_allclose(np.abs(hover.state.rotor_rate), wanted, rtol=1e-3)


def test_disks_are_where_the_rotors_are_and_as_large(world: Make) -> None:
    tail = ("boom: {model: rotor, parent: drone, pose: [-0.2, 0, 0, 0, 0, 1.5707963]}\n"
            "tail: {model: rotor, parent: boom, pose: [0.1, 0, 0, 1.5707963, 0, 0], rotor: {direction: -1}}")
    hung = world(DRONE + tail)
    disk = disks(hung.model)
    np.testing.assert_allclose(disk.place_b, [[0.2, 0.1, 0.05], [-0.2, 0.1, 0.0]], atol=1e-7)
    np.testing.assert_allclose(disk.axis_b, [[0, 0, 1], [1, 0, 0]], atol=1e-7)
    np.testing.assert_allclose(disk.radius, 0.1)
    np.testing.assert_array_equal(disks(hung.model, 0.3).radius, 0.3)


# Water

def below(half: np.ndarray, turn: np.ndarray, height: float) -> tuple[float, float]:
    """Volume of a box below a plane, and its integral over the height so far, by inclusion and exclusion over the
    corners (Scardovelli, Zaleski 2000, eq. 6), which is exact where no edge is level."""
    normal = np.abs(turn[2]) * 2 * half
    alpha = height + normal.sum() / 2
    corners = [(k.bit_count(), normal[[bool(k & 1), bool(k & 2), bool(k & 4)]].sum()) for k in range(8)]
    cubes = sum((-1) ** count * max(alpha - reach, 0.0) ** 3 for count, reach in corners)
    fourths = sum((-1) ** count * max(alpha - reach, 0.0) ** 4 for count, reach in corners)
    scale = 8 * half.prod() / normal.prod()
    return scale * cubes / 6, scale * fourths / 24


def test_the_volume_under_water_is_exact_in_any_pose() -> None:
    rng = np.random.default_rng(4)
    scratch = np.empty((ROWS, 3))
    for _ in range(3000):
        half = rng.uniform(0.05, 1.0, 3)
        q = rng.normal(size=4)
        m = matrix(*(q / np.linalg.norm(q)))
        turn = np.array(m).reshape(3, 3)
        height = rng.uniform(-1.2, 1.2) * float(np.abs(turn[2]) @ half)
        volume, *centroid = submerged(m, half, height, scratch)
        wanted, moment = below(half, turn, height)
        whole = 8 * half.prod()
        assert volume == pytest.approx(wanted, abs=1e-9 * whole)
        assert volume * (height - centroid[2]) == pytest.approx(moment, abs=1e-9 * whole)
        over = (*m[:3], *(-x for x in m[3:]))  # turned over about x, so that what was above is below
        above, *rest = submerged(over, half, -height, scratch)
        assert volume + above == pytest.approx(whole, rel=1e-12)
        balance = volume * np.array(centroid) + above * np.array(rest) * [1, -1, -1]
        np.testing.assert_allclose(balance, 0.0, atol=1e-12 * whole)


@pytest.mark.parametrize(("q", "height", "volume", "centroid"), [
    ((0, 0, 0, 1), 0.0, 0.5 * 0.192, (0, 0, -0.15)),  # level: edges along the surface
    ((0, 0, 0, 1), 0.3, 0.192, (0, 0, 0)),  # the surface is a face
    ((0, 0, 0, 1), -0.3, 0.0, (0, 0, 0)),
    ((math.sqrt(0.5), 0, 0, math.sqrt(0.5)), 0.1, 0.8 * 0.6 * 0.3, (0, 0, -0.05)),  # on its side
    ((math.sin(math.pi / 8), 0, 0, math.cos(math.pi / 8)), 0.0, 0.096, None)])  # an edge below: half is half
def test_the_volume_under_water_in_poses_without_general_position(
        q: tuple[float, ...], height: float, volume: float, centroid: tuple[float, ...] | None) -> None:
    found, *middle = submerged(matrix(*q), np.array([0.4, 0.2, 0.3]), height, np.empty((ROWS, 3)))
    assert found == pytest.approx(volume, abs=1e-12)
    if centroid:
        np.testing.assert_allclose(middle, centroid, atol=1e-12)


def test_a_box_floats_as_deep_as_archimedes_says(world: Make) -> None:
    afloat = world(CRATE.replace("%g]", "%g, 0.1, 0.2, 0]") % (30, 2.3),
                   "dynamics: {sleep: false}\neffects: {gravity: {}, water: {level: 2.5, density: 1000}}")
    run(afloat, 120.0)
    assert afloat.pose("crate")[2] == pytest.approx(2.5 - 30 / (1000 * 0.36), abs=1e-4)
    assert np.abs(afloat.state.velocity_w).max() < 1e-4


@pytest.mark.parametrize(("share", "upright"), [(0.15, True), (0.25, False), (0.75, False), (0.85, True)])
def test_a_cube_floats_upright_if_it_is_light_or_heavy_enough(world: Make, share: float, upright: bool) -> None:
    """Relative densities from 0.2113 to 0.7887, the roots of 6 s (1 - s) = 1, tilt it: its metacentre is too low."""
    afloat = world(CRATE.replace("%g]", "%g, 0.05, 0, 0]") % (216 * share, 0.0),
                   "effects: {gravity: {}, water: {density: 1000}}")
    run(afloat, 120.0)
    up = matrix(*afloat.state.orientation_w[0])[8]
    assert up > 0.9999 if upright else up < 0.98


def test_it_heaves_at_the_frequency_of_the_spring_that_water_is(world: Make) -> None:
    draught, added = 30 / (1000 * 0.36), 0.5
    heave = world(CRATE % (30, 0.004 - draught), "rates: {physics: 240}\neffects: {gravity: {}, water: "
                  f"{{density: 1000, coefficient: 0, damping: 0, added_mass: {added}}}}}")
    omega = math.sqrt(1000 * G * 0.36 / (30 * (1 + added)))
    run(heave, 8 * math.pi / omega)  # four periods
    assert heave.pose("crate")[2] + draught == pytest.approx(0.004 * math.cos(omega * heave.time), abs=2e-4)


def test_damping_takes_the_heave_away_as_in_the_closed_form(world: Make) -> None:
    draught, added = 30 / (1000 * 0.36), 0.5
    heave = world(CRATE % (30, 0.004 - draught), "rates: {physics: 240}\neffects: {gravity: {}, water: "
                  f"{{density: 1000, coefficient: 0, damping: 0.6, added_mass: {added}}}}}")
    rate = 0.5 * 0.6 / (1 + added)  # of the amplitude; the water displaced weighs what the crate does
    period = 2 * math.pi * math.sqrt(30 * (1 + added) / (1000 * G * 0.36))
    highest = 0.0
    while heave.time < 6.0:
        heave.step()
        if heave.time > 6.0 - period:
            highest = max(highest, heave.pose("crate")[2] + draught)
    assert 0.004 * math.exp(-rate * 6.0) < highest < 1.02 * 0.004 * math.exp(-rate * (6.0 - period))


def test_what_is_heavier_sinks_at_its_terminal_velocity(world: Make) -> None:
    sinking = world(CRATE % (400, -5), "effects: {gravity: {}, water: {density: 1000, coefficient: 1.1, damping: 0}}")
    run(sinking, 20.0)
    wanted = math.sqrt(2 * (400 - 216) * G / (1000 * 1.1 * 0.36))
    assert sinking.state.velocity_w[0, 2] == pytest.approx(-wanted, rel=1e-3)


def test_buoyancy_is_the_gradient_of_a_potential_in_any_pose() -> None:
    """Force and torque are what the potential energy of the water displaced falls by along small motions, so that
    rocking gains no energy."""
    rng = np.random.default_rng(8)
    half, scratch, step = np.array([0.4, 0.25, 0.1]), np.empty((ROWS, 3)), 1e-5

    still = water.Sea(level=0.0, density=1000.0, gravity=G, drag=0.5, damping=0.5, added_mass=0.0, current_x=0.0,
                      current_y=0.0, current_z=0.0)

    def potential(height: float, turn: np.ndarray) -> float:
        return 1000 * G * below(half, turn, -height)[1]

    for _ in range(100):
        q = rng.normal(size=4)
        q /= np.linalg.norm(q)
        turn = np.array(matrix(*q)).reshape(3, 3)
        height = rng.uniform(-0.9, 0.9) * float(np.abs(turn[2]) @ half)
        force, torque = np.zeros((1, 3)), np.zeros((1, 3))
        water.float_up(np.array([1, 0]), np.array([[0.0, 0.0, height]]), q[None], np.zeros((1, 3)), np.zeros((1, 3)),
                       half[None], np.ones(1), np.ones((1, 3)), still, 1e-3, scratch, force, torque, np.ones(1),
                       np.ones((1, 3)))
        up = potential(height + step, turn) - potential(height - step, turn)
        assert force[0, 2] == pytest.approx(-up / (2 * step), abs=1e-2)
        for axis in range(2):
            small = np.zeros(4)
            small[axis], small[3] = step / 2, 1.0
            rolled = np.array(matrix(*(small / np.linalg.norm(small)))).reshape(3, 3)
            change = potential(height, rolled @ turn) - potential(height, rolled.T @ turn)
            assert torque[0, axis] == pytest.approx(-change / (2 * step), abs=1e-2)


def test_what_pops_up_takes_water_along(world: Make) -> None:
    balloon = world(CRATE % (0.01, -50), "rates: {physics: 240}\neffects: {gravity: {}, water: "
                    "{density: 1000, coefficient: 0, damping: 0, added_mass: 0.5}}")
    run(balloon, 0.5)
    assert balloon.state.velocity_w[0, 2] == pytest.approx(0.5 * 2 * G, rel=1e-3)  # a bubble rises at 2 g


@pytest.mark.parametrize("load", [50, 200])
def test_a_raft_displaces_what_it_and_its_load_weigh(load: float, tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    write_box(tmp_path / "models" / "raft.obj", (2.0, 2.0, 0.5), 0.0)
    write_box(tmp_path / "models" / "crate.obj", (0.6, 0.6, 0.6), 0.3)
    raft = World(parse("version: 1\neffects: {gravity: {}, water: {density: 1000, damping: 2}}\nobjects:\n"
                       "  raft: {model: raft, mass: 100}\n"
                       f"  crate: {{model: crate, mass: {load}, pose: [0, 0, 0.25], friction: 0.9}}\n",
                       tmp_path / "scenes" / "raft.yaml"))
    run(raft, 30.0)
    assert raft.pose("raft")[2] - 0.25 == pytest.approx(-(100 + load) / 4000, abs=1e-3)
    assert raft.pose("crate")[2] == pytest.approx(raft.pose("raft")[2] + 0.25, abs=1e-3)


def test_what_has_sunk_presses_with_what_is_left_of_its_weight(world: Make) -> None:
    sunk = world(FLOOR + "crate: {model: crate, mass: 240, pose: [0, 0, 0]}",
                 "dynamics: {sleep: false}\neffects: {gravity: {}, water: {level: 5, density: 1000}}")
    run(sunk, 2.0)
    pressed = sum(event.impulse for event in sunk.events) / sunk.dt
    assert pressed == pytest.approx((240 - 216) * G, rel=1e-2)


def test_a_current_takes_along_what_floats(world: Make) -> None:
    afloat = world(CRATE % (30, -0.08), "effects: {gravity: {}, water: {current: [0.7, -0.2, 0]}}")
    run(afloat, 60.0)
    np.testing.assert_allclose(afloat.state.velocity_w[0], [0.7, -0.2, 0.0], atol=5e-3)


def test_nothing_floats_without_weight(world: Make) -> None:
    adrift = world(CRATE % (1, -5), "effects: {water: {}}")
    run(adrift, 1.0)
    np.testing.assert_array_equal(adrift.state.velocity_w, 0.0)


# All of them

@pytest.mark.parametrize("substeps", [1, 8])
@pytest.mark.parametrize("effects", [
    "drag: {density: 2000, coefficient: 10}", "linear_drag: {rate: [1000, 1000, 1000], spin: 1000, bodies: all}",
    "water: {level: 100, density: 20000, coefficient: 10, damping: 100}",
    "drag: {density: 2000, coefficient: 10}, linear_drag: {rate: [1000, 1000, 1000], spin: 1000, bodies: all}, "
    "water: {level: 100, density: 20000, coefficient: 10, damping: 100}"])
@pytest.mark.parametrize("integrator", ["semi_implicit_euler", "midpoint"])
def test_the_strongest_drag_stops_a_body_and_no_more(
        world: Make, effects: str, substeps: int, integrator: str) -> None:
    brake = world("crate: {model: drone, mass: 0.01, pose: [0, 0, 1, 0.4, 0.3, 0]}",
                  f"dynamics: {{substeps: {substeps}, integrator: {integrator}}}\neffects: {{{effects}}}")
    brake.state.velocity_w[0] = [30.0, -20.0, 10.0]
    brake.state.angular_velocity_w[0] = [4.0, 5.0, 6.0]
    last = math.inf
    for _ in range(60):
        brake.step()
        s, b = brake.state, brake.model.bodies
        energy = 0.5 * 0.01 * (s.velocity_w[0] ** 2).sum() + 0.5 * (b.inertia_b[0] * body_rates(brake) ** 2).sum()
        assert energy <= last * (1 + 1e-9)
        last = float(energy)
    assert np.linalg.norm(brake.state.velocity_w[0]) < 0.1


@pytest.mark.parametrize("substeps", [1, 8])
@pytest.mark.parametrize("mass", [0.001, 0.1])
def test_the_lightest_box_stays_on_the_water(world: Make, mass: float, substeps: int) -> None:
    foam = world(f"crate: {{model: drone, mass: {mass}, pose: [0, 0, 0.5, 0.3, 0.2, 0]}}",
                 f"dynamics: {{substeps: {substeps}}}\neffects: {{gravity: {{}}, drag: {{}}, water: {{}}}}")
    run(foam, 5.0)
    for _ in range(300):
        foam.step()
        assert 0.0 < foam.state.position_w[0, 2] < 0.3
        assert np.abs(foam.state.angular_velocity_w).max() < 15.0
