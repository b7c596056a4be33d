"""Hard cases of motion without contact: a tumbling box, and fast rotation about the intermediate axis."""

from collections.abc import Sequence

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.world import World
from reference.box_world import GRAVITY, Box, G, Setting, advance, angular_momentum, energy, world_of
from reference.free_rotation import attitude
from reference.motion.outcome import Criterion, Outcome, thinned

SIZE, MASS = (1.0, 4.0, 9.0), 10.0
VELOCITY, RATE = np.array([-2.0, 2.0, 8.0]), np.array([0.1, 5.0, 0.1])  # from Gazebo's benchmark 'boxes'
SECONDS = 10.0
ORDERS = {"semi_implicit_euler": 1, "midpoint": 2, "rk4": 4}
SUBSTEPS = {"semi_implicit_euler": (8, 16, 32), "midpoint": (8, 16, 32), "rk4": (2, 4, 8)}
TYPICAL = 0.01  # limit, relative to g T dt / 2, the error of engines that do not integrate gravity exactly
SPIN = 100.0  # rad/s
MINUTE = 60.0


def tumbling(setting: Setting) -> World:
    """A world with one box in free flight, with linear and angular velocity."""
    world = world_of({"box": Box(SIZE, (0.0, 0.0, 0.0), MASS)}, setting, GRAVITY)
    world.state.velocity_w[0], world.state.angular_velocity_w[0] = VELOCITY, RATE
    return world


def tumble_errors(world: World, seconds: float) -> tuple[float, float]:
    """Errors of the tumbling box after `seconds` s: position in m, attitude in rad."""
    path = VELOCITY * seconds - np.array([0.0, 0.0, 0.5 * G * seconds**2])
    return (float(np.linalg.norm(world.state.position_w[0] - path)),
            angle_between(world.state.orientation_w[0], attitude(world.model.bodies.inertia_b[0], RATE, seconds)))


def angle_between(q: Floats, rotation: Floats) -> float:
    """Angle in rad between a rotation matrix (3, 3) and a quaternion (4,), accurate for small angles."""
    x, y, z, w = q / np.linalg.norm(q)
    own = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
    distance = np.linalg.norm(own - rotation)  # 2 sqrt(2) sin(angle / 2), Frobenius
    return float(2.0 * np.arcsin(min(1.0, distance / np.sqrt(8.0))))


def order_of(errors: Sequence[float], steps: Sequence[float]) -> float:
    """Order of convergence: slope of log error over log step size, by least squares."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def tumble(setting: Setting, seconds: float = SECONDS) -> Outcome:
    """Order of convergence of the attitude, and the position error relative to the typical one of engines.

    Uses the setting's integrator and rate with increasing numbers of sub-steps.
    """
    steps, position_errors, attitude_errors = [], [], []
    for substeps in SUBSTEPS[setting.integrator]:
        world = tumbling(Setting(setting.rate, substeps, setting.integrator, setting.sleep))
        for _ in advance(world, seconds):
            pass
        position_error, attitude_error = tumble_errors(world, seconds)
        steps.append(world.dt / substeps)
        position_errors.append(position_error)
        attitude_errors.append(attitude_error)
    order = order_of(attitude_errors, steps)
    criteria = [Criterion("error of the order of convergence", abs(order - ORDERS[setting.integrator]), 0.2)]
    if ORDERS[setting.integrator] > 1:  # a first-order integrator has this error
        typical = 0.5 * G * seconds * steps[-1]
        criteria.append(Criterion("position error, relative to g T h / 2", position_errors[-1] / typical, TYPICAL))
    return Outcome(tuple(criteria), {"step_s": np.array(steps), "position_m": np.array(position_errors),
                                    "attitude_rad": np.array(attitude_errors), "order": np.array([order])})


def spin(setting: Setting, seconds: float = MINUTE) -> Outcome:
    """Fast rotation about the intermediate axis, which is unstable.

    Measures the drift of energy, angular momentum and quaternion norm.
    """
    world = world_of({"box": Box(SIZE, (0.0, 0.0, 0.0), MASS)}, setting, "")
    middle = np.argsort(world.model.bodies.inertia_b[0])[1]
    world.state.angular_velocity_w[0] = np.where(np.arange(3) == middle, SPIN, 1e-4 * SPIN)
    first, momentum = energy(world), angular_momentum(world)
    worst_norm, t, drift, momentum_error = 0.0, [0.0], [0.0], [0.0]
    for time in advance(world, seconds):
        t.append(time)
        drift.append(100.0 * (energy(world) / first - 1.0))
        change = np.linalg.norm(angular_momentum(world) - momentum)
        momentum_error.append(100.0 * float(change / np.linalg.norm(momentum)))
        worst_norm = max(worst_norm, abs(float(np.linalg.norm(world.state.orientation_w[0])) - 1.0))
    return Outcome((Criterion("energy drift", float(np.abs(drift).max()), 0.1, "%"),
                    Criterion("angular momentum error", max(momentum_error), 0.1, "%"),
                    Criterion("quaternion norm error", worst_norm, 1e-12)),
                   thinned({"time_s": t, "energy_percent": drift, "momentum_percent": momentum_error}))
