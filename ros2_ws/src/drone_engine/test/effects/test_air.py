"""Wind, gusts and downwash move the air as their sources say; so do the random numbers behind them."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from drone_engine import SceneError
from drone_engine.effects import downwash, gusts, wind
from drone_engine.effects.disks import Disks
from drone_engine.effects.noise import bits, normals, streams, uniform
from drone_engine.world import World

Make = Callable[..., World]
G = 9.80665
CRATE = "crate: {model: crate, mass: 2, pose: [0, 0, 6]}"


def test_random_bits_are_those_of_splitmix64() -> None:
    # The reference implementation (Vigna, prng.di.unimi.it/splitmix64.c), seeded with 1234567.
    assert [int(bits(1234567, n)) for n in range(5)] == [
        6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431, 16408922859458223821]


def test_random_numbers_have_the_moments_that_they_should() -> None:
    flat = np.array([uniform(-5, n) for n in range(100_000)])
    bell = np.array([normals(17, n) for n in range(100_000)])
    assert 0.0 < flat.min() < 1e-4 and 1 - 1e-4 < flat.max() < 1.0
    assert flat.mean() == pytest.approx(0.5, abs=4 * math.sqrt(1 / 12 / 1e5))
    np.testing.assert_allclose(bell.mean(0), 0.0, atol=4 / math.sqrt(1e5))
    np.testing.assert_allclose(np.cov(bell.T), np.eye(2), atol=4 * math.sqrt(2 / 1e5))
    assert (bell**4).mean() == pytest.approx(3.0, abs=4 * math.sqrt(96 / 2e5))


def test_streams_hang_on_seed_effect_and_name_alone() -> None:
    one, other = streams(1, "gusts", ["a", "b"]), streams(1, "gusts", ["c", "b", "a"])
    assert one[0] == other[2] and one[1] == other[1]
    assert len({*one, *streams(2, "gusts", ["a", "b"]), *streams(1, "rain", ["a", "b"])}) == 6


def test_wind_slows_down_near_the_ground_as_the_laws_say() -> None:
    power, log = wind.Parameters(profile="power"), wind.Parameters(profile="log")
    assert power.factor(10.0) == log.factor(10.0) == wind.Parameters().factor(1.0) == 1.0
    assert power.factor(80.0) == pytest.approx(8 ** (1 / 7))  # 1.346
    # From 10 m to 2 m over short grass, z_0 = 1.48 cm: 0.748 (FAO 56, eq. 47, which has the air begin at 8 cm).
    assert wind.Parameters(profile="log", roughness=0.0148).factor(2.0) == pytest.approx(0.748, abs=0.006)
    assert log.factor(0.0) == log.factor(wind.LOWEST) > 0.0


@pytest.mark.parametrize("profile", ["uniform", "power", "log"])
def test_what_drag_acts_on_drifts_with_the_wind(world: Make, profile: str) -> None:
    drift = world(CRATE, f"effects: {{drag: {{}}, wind: {{mean: [4, -3, 0], profile: {profile}}}}}")
    for _ in range(20_000):
        drift.step()
    factor = wind.Parameters(profile=profile).factor(6.3)  # type: ignore[arg-type]
    np.testing.assert_allclose(drift.state.velocity_w[0], np.array([4, -3, 0]) * factor, rtol=0.02)


def test_a_storm_beyond_all_storms_is_refused(world: Make) -> None:
    with pytest.raises(SceneError, match=r"effects\.wind: mean: expected a speed of at most 150 m/s, got 500 m/s"):
        world(CRATE, "effects: {wind: {mean: [300, 400, 0]}}")


def test_turbulence_has_the_scales_and_intensities_of_the_specification() -> None:
    top = gusts.scales(1000 * 0.3048, 10.0)  # where 0.177 + 0.000823 h = 1
    np.testing.assert_allclose(top, [304.8, 304.8, 1.0, 1.0], rtol=1e-12)
    low = gusts.scales(50 * 0.3048, 15.43)  # 50 ft, 30 knots: L_u = 282 ft, sigma_w = 3 knots
    np.testing.assert_allclose(low, [50 * 0.3048 / 0.21815**1.2, 15.24, 1.543 / 0.21815**0.4, 1.543], rtol=1e-12)
    assert gusts.scales(0.0, 5.0) == gusts.scales(10 * 0.3048, 5.0)
    assert gusts.scales(5000.0, 5.0) == gusts.scales(304.8, 5.0)


@pytest.mark.parametrize("h", [1e-6, 9.9e-4, 1.01e-3, 0.1, 3.0, 100.0])
def test_filters_are_discretised_exactly(h: float) -> None:
    """The stationary covariance stays, and two steps of h are one of 2 h."""
    def step(h: float) -> tuple[np.ndarray, np.ndarray]:
        left, aa, ab, bb = gusts.second_order(h)
        root = np.array([[aa, 0.0], [ab, bb]])
        return left * np.array([[1.0, 0.0], [h, 1.0]]), root @ root.T

    stationary = np.array([[1.0, 0.5], [0.5, 0.5]])
    turn, noise = step(h)
    np.testing.assert_allclose(turn @ stationary @ turn.T + noise, stationary, rtol=0, atol=1e-12)
    twice, noise_twice = step(2 * h)
    np.testing.assert_allclose(turn @ turn, twice, rtol=1e-12)
    np.testing.assert_allclose(turn @ noise @ turn.T + noise, noise_twice, rtol=1e-7)
    left, fresh = gusts.first_order(h)
    assert left**2 + fresh**2 == pytest.approx(1.0, abs=1e-15)


def test_gusts_correlate_as_the_spectra_of_dryden() -> None:
    """u: exp(-t / T); v, w: exp(-t / T) (1 - t / 2 T), the Fourier transforms of MIL-F-8785C's spectra."""
    n, steps, dt, speed, height = 4000, 41, 0.05, 10.0, 30.0
    awake = np.arange(-1, n)
    awake[0] = n
    position, velocity = np.zeros((n, 3)), np.zeros((n, 3))
    position[:, 2], velocity[:, 1] = height, speed
    stream = streams(3, "gusts", [f"body_{i}" for i in range(n)])
    memory, gust, count = np.zeros((n, 5)), np.zeros((n, 3)), np.zeros(1, np.int64)
    seen = []
    for k in range(400 + steps):
        count[0] = k
        gusts.stir(awake, position, velocity, np.empty((0, 3)), stream, count, 8.0, 0.0, dt, memory, gust)
        if k == 0:
            memory[:] *= 30.0  # far from what is usual: it is forgotten
            gusts.stir(awake, position, velocity, np.empty((0, 3)), stream, count, 8.0, 0.0, 100.0, memory, gust)
        elif k >= 400:
            seen.append(gust.copy())
    long, short, sigma, sigma_w = gusts.scales(height, 8.0)
    t = dt * speed * np.arange(steps)
    wanted = np.array([sigma**2 * np.exp(-t / long), sigma**2 * np.exp(-t / long) * (1 - t / long / 2),
                       sigma_w**2 * np.exp(-t / short) * (1 - t / short / 2)]).T
    found = np.array([(seen[0] * later).mean(0) for later in seen])
    np.testing.assert_allclose(found, wanted, atol=4 * sigma**2 * math.sqrt(2 / n))
    cross = np.corrcoef(seen[0].T)
    np.testing.assert_allclose(cross, np.eye(3), atol=4 / math.sqrt(n))


def test_gusts_take_the_wind_of_the_scene_and_run_along_it(world: Make) -> None:
    breeze = "wind: {mean: [0, 8, 0], profile: log}"
    assert gusts.wind_6m(gusts.Parameters(wind_6m=3.0), None) == 3.0  # type: ignore[arg-type]
    swept = world(CRATE, f"effects: {{drag: {{}}, gusts: {{}}, {breeze}}}")
    speed = 8 * wind.Parameters(profile="log").factor(6.096)
    told = world(CRATE, f"effects: {{drag: {{}}, gusts: {{wind_6m: {speed}}}, {breeze}}}")
    for _ in range(50):
        swept.step()
        told.step()
    assert swept.state.hash() == told.state.hash()
    assert np.abs(swept.state.velocity_w[0, 0]) > 0.0


def test_gusts_come_of_the_seed_and_the_name_and_repeat(world: Make) -> None:
    def flown(objects: str = CRATE, seed: int = 1) -> np.ndarray:
        run = world(objects, f"seed: {seed}\neffects: {{drag: {{}}, gusts: {{}}}}")
        for _ in range(60):
            run.step()
        index = run.model.bodies.names.index("crate")
        return run.state.velocity_w[index].copy()

    first = flown()
    np.testing.assert_array_equal(first, flown())
    np.testing.assert_array_equal(first, flown("other: {model: crate, mass: 2, pose: [9, 9, 9]}\n" + CRATE))
    assert (first != flown(seed=2)).all()


@pytest.mark.parametrize("down", [0.01, 0.5, 1.0, 3.0, 20.0])
def test_a_jet_keeps_the_momentum_of_its_rotor(down: float) -> None:
    thrust, density, radius, spread = 3.4, 1.2, 0.12, 0.094
    r = np.linspace(0.0, 3.0 * max(radius, 0.2 * down), 20_001)
    flux = [density * downwash.pressure(thrust, density, radius, spread, down, x * x) for x in r]
    assert np.trapezoid(2 * math.pi * r * flux, r) == pytest.approx(thrust, rel=1e-5)
    half = max(radius, spread * down / math.sqrt(math.log(2.0))) * math.sqrt(math.log(2.0))
    middle, edge = (downwash.pressure(thrust, density, radius, spread, down, x * x) for x in (0.0, half))
    assert math.sqrt(edge / middle) == pytest.approx(0.5)


def test_a_jet_decays_as_measured() -> None:
    """u / u_0 = B d / x with B = 5.8 to 6.1 (Pope 2000, table 5.1), d the diameter of the contracted jet."""
    thrust, density, radius = 3.4, 1.225, 0.12
    exit_speed = math.sqrt(2 * thrust / (density * math.pi)) / radius  # 2 v_i
    diameter = math.sqrt(2.0) * radius
    x = 50 * diameter
    speed = math.sqrt(downwash.pressure(thrust, density, radius, 0.094, x, 0.0))
    assert 5.6 < speed / exit_speed * x / diameter < 6.4


def test_downwash_weighs_on_a_crazyflie_as_measured() -> None:
    """The fit of gym-pybullet-drones to flights of one Crazyflie under another (Panerati et al. 2021): straight below,
    2267.18 (R / 4 z)^2 N. Its four jets are one by then; it is 9.2 cm square."""
    for z in (0.5, 1.0, 2.0):
        square = downwash.pressure(0.027 * 9.81, 1.225, 0.0231, 0.094, z, 0.0)
        force = 0.5 * 1.225 * 1.2 * 0.092**2 * square
        assert force == pytest.approx(2267.18 * (0.0231348 / (4 * z)) ** 2, rel=0.3)


@pytest.mark.parametrize("model", ["direct", "quadrotor"])
def test_a_drone_above_blows_a_crate_down(world: Make, model: str) -> None:
    """Momentum theory, at the very first instant: the rotors carry the drone, and their jets have that thrust."""
    places = [(0.2, -0.2, 1), (0.2, 0.2, -1), (-0.2, 0.2, 1), (-0.2, -0.2, -1)]
    rotors = "".join(f"r{k}: {{model: rotor, parent: drone, pose: [{x}, {y}, 0], rotor: {{direction: {turn}}}}}\n"
                     for k, (x, y, turn) in enumerate(places))
    blown = world(f"drone: {{model: drone, mass: 1.4, pose: [0, 0, 12], flight: {{model: {model}}}}}\n" + rotors
                  + "crate: {model: crate, mass: 50, pose: [0, 0, 2]}",
                  "rates: {physics: 1000}\neffects: {gravity: {}, drag: {}, downwash: {}}")
    blown.step()
    b = 0.094 * (12.0 - 2.3) / math.sqrt(math.log(2.0))
    square = 2 * 1.4 * G / (1.225 * math.pi * b * b)  # of the speed of one jet of all four, in its middle
    extent = sum(0.5 * math.exp(-2 * (0.3 / math.sqrt(3) + side) ** 2 / b**2) for side in (-0.2, 0.2)) ** 2
    acceleration = -blown.state.velocity_w[1, 2] / blown.dt - G
    assert acceleration == pytest.approx(0.5 * 1.225 * 0.36 * square * extent / 50, rel=0.01)


def test_jets_blow_on_what_is_below_and_on_nothing_else() -> None:
    """Four rotors of a drone that hovers, turned by 180 degrees, and bodies around it."""
    place = np.array([[0.19, 0.19, 0.0], [0.19, -0.19, 0.0], [-0.19, 0.19, 0.0], [-0.19, -0.19, 0.0]])
    axis, radius, thrust = np.tile([0.0, 0.0, 1.0], (4, 1)), np.full(4, 0.12), np.full(4, 3.4)
    position = np.array([[0, 0, 10.0], [0, 0, 4.0], [0.19, 0.19, 9.5], [0.19, 0.19, 11.0], [3.0, 0, 9.0]])
    orientation = np.tile([0.0, 0.0, 0.0, 1.0], (5, 1))
    awake, body, jet = np.array([5, 0, 1, 2, 3, 4]), np.zeros(4, np.int64), np.empty((4, 7))

    def air() -> np.ndarray:
        out = np.zeros((5, 3))
        rotors = Disks(body, place, axis, radius)
        downwash.aim(rotors, thrust, position, orientation, jet)
        downwash.wash(awake, position, orientation, np.full((5, 3), 1e-6), rotors, thrust, jet, 1.225, 0.094, out)
        return out

    below = air()
    np.testing.assert_array_equal(below[[0, 3, 4]], 0.0)  # itself, above, beside
    np.testing.assert_allclose(below[1:3, :2], 0.0, atol=1e-12)
    assert below[2, 2] == pytest.approx(-2 * math.sqrt(3.4 / (2 * 1.225 * math.pi * 0.12**2)), rel=0.02)
    b = 0.094 * 6.0 / math.sqrt(math.log(2.0))
    far = math.sqrt(2 * 4 * 3.4 / (1.225 * math.pi)) / b  # one jet of four rotors
    assert below[1, 2] == pytest.approx(-far * math.exp(-0.19**2 * 2 / b**2), rel=1e-6)
    orientation[0] = 1.0, 0.0, 0.0, 0.0  # upside down
    above = air()
    assert above[3, 2] > 1.0
    np.testing.assert_array_equal(above[[1, 2]], 0.0)
    thrust[:] = 0.0
    np.testing.assert_array_equal(air(), 0.0)
