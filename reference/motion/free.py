"""Hard cases of motion without contact: a tumbling box, and a fast spin about the intermediate axis."""

from collections.abc import Sequence

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.world import World
from reference.box_world import GRAVITY, Box, G, Setting, advance, angular_momentum, energy, world_of
from reference.free_rotation import attitude
from reference.motion.outcome import Outcome, Reached, thinned

SIZE, MASS = (1.0, 4.0, 9.0), 10.0
VELOCITY, RATE = np.array([-2.0, 2.0, 8.0]), np.array([0.1, 5.0, 0.1])  # of Gazebo's benchmark 'boxes'
SECONDS = 10.0
ORDERS = {"semi_implicit_euler": 1, "midpoint": 2, "rk4": 4}
SUBSTEPS = {"semi_implicit_euler": (8, 16, 32), "midpoint": (8, 16, 32), "rk4": (2, 4, 8)}
TYPICAL = 0.01  # of g T dt / 2, which engines that do not integrate gravity exactly are off by
SPIN = 100.0  # rad/s
MINUTE = 60.0


def tumbling(setting: Setting) -> World:
    """The box in the air, thrown and turning."""
    world = world_of({"box": Box(SIZE, (0.0, 0.0, 0.0), MASS)}, setting, GRAVITY)
    world.state.velocity_w[0], world.state.angular_velocity_w[0] = VELOCITY, RATE
    return world


def tumble_errors(world: World, seconds: float) -> tuple[float, float]:
    """How far a box that has tumbled for so long is from where it should be: m, rad."""
    path = VELOCITY * seconds - np.array([0.0, 0.0, 0.5 * G * seconds**2])
    return (float(np.linalg.norm(world.state.position_w[0] - path)),
            angle_between(world.state.orientation_w[0], attitude(world.model.bodies.inertia_b[0], RATE, seconds)))


def angle_between(q: Floats, turn: Floats) -> float:
    """Angle in rad from the rotation matrix (3, 3) to the quaternion (4,), exact for small ones."""
    x, y, z, w = q / np.linalg.norm(q)
    own = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    apart = np.linalg.norm(own - turn)  # 2 sqrt(2) sin(angle / 2), Frobenius
    return float(2.0 * np.arcsin(min(1.0, apart / np.sqrt(8.0))))


def order_of(errors: Sequence[float], steps: Sequence[float]) -> float:
    """The slope of log error over log step, by least squares."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def tumble(setting: Setting, seconds: float = SECONDS) -> Outcome:
    """Order of convergence of the attitude, and the error of the position beside that typical of engines.

    The setting's integrator, with ever more sub-steps of 1 / rate.
    """
    steps, places, turns = [], [], []
    for substeps in SUBSTEPS[setting.integrator]:
        world = tumbling(Setting(setting.rate, substeps, setting.integrator, setting.sleep))
        for _ in advance(world, seconds):
            pass
        place, turn = tumble_errors(world, seconds)
        steps.append(world.dt / substeps)
        places.append(place)
        turns.append(turn)
    order = order_of(turns, steps)
    reached = [Reached("order of convergence off by", abs(order - ORDERS[setting.integrator]), 0.2)]
    if ORDERS[setting.integrator] > 1:  # one of first order is off by that much, by its nature
        reached.append(Reached("position off, of g T h / 2", places[-1] / (0.5 * G * seconds * steps[-1]), TYPICAL))
    return Outcome(tuple(reached), {"step_s": np.array(steps), "position_m": np.array(places),
                                    "attitude_rad": np.array(turns), "order": np.array([order])})


def spin(setting: Setting, seconds: float = MINUTE) -> Outcome:
    """Spin about the intermediate axis, which turns over again and again: energy, angular momentum, quaternion."""
    world = world_of({"box": Box(SIZE, (0.0, 0.0, 0.0), MASS)}, setting, "")
    middle = np.argsort(world.model.bodies.inertia_b[0])[1]
    world.state.angular_velocity_w[0] = np.where(np.arange(3) == middle, SPIN, 1e-4 * SPIN)
    first, momentum = energy(world), angular_momentum(world)
    worst_norm, t, drift, turned = 0.0, [0.0], [0.0], [0.0]
    for now in advance(world, seconds):
        t.append(now)
        drift.append(100.0 * (energy(world) / first - 1.0))
        turned.append(100.0 * float(np.linalg.norm(angular_momentum(world) - momentum) / np.linalg.norm(momentum)))
        worst_norm = max(worst_norm, abs(float(np.linalg.norm(world.state.orientation_w[0])) - 1.0))
    return Outcome((Reached("energy drift", float(np.abs(drift).max()), 0.1, "%"),
                    Reached("angular momentum off", max(turned), 0.1, "%"),
                    Reached("quaternion norm off", worst_norm, 1e-12)),
                   thinned({"time_s": t, "energy_percent": drift, "momentum_percent": turned}))
