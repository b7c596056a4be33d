"""Whether copies of a scene can run in blocks, and the constants that blocks need."""

from typing import NamedTuple

import numpy as np

from drone_engine import effects
from drone_engine.arrays import Floats
from drone_engine.effects.drag import Parameters as Drag
from drone_engine.effects.gravity import Parameters as Gravity
from drone_engine.effects.motor_lag import Parameters as MotorLag
from drone_engine.fleet.block import write_lag_decay
from drone_engine.flight.craft import ROTOR_DRAG
from drone_engine.flight.quadrotor import rotors_of, row_of
from drone_engine.world import World

IN_BLOCKS = ("gravity", "drag", "motor_lag")  # effects that blocks support
INTEGRATORS = ("midpoint", "semi_implicit_euler")  # integrators that blocks support


class BlockConstants(NamedTuple):
    """What `block.advance` takes of a scene, in its order; see there."""

    constants: Floats
    lag: Floats | None
    drag: float | None
    rotors: bool | None
    seen: bool | None
    second_order: bool | None
    substeps: int

    @classmethod
    def of(cls, world: World) -> "BlockConstants":
        """Raises SceneError for a drone that cannot fly."""
        scene, bodies, drones = world.scene, world.model.bodies, world.model.drones
        active, substeps = effects.parameters(scene), scene.dynamics.substeps
        gravity, drag, motor_lag = active.get("gravity"), active.get("drag"), active.get("motor_lag")
        h = world.dt / substeps
        row = row_of(world.model, 0, h, scene.path)
        constants = np.array([*row, gravity.acceleration if isinstance(gravity, Gravity) else 0.0, h, world.dt,
                              bodies.inverse_mass[0], drones.max_speed[0], drones.max_yaw_rate[0], *bodies.half[0]])
        lag = None
        if isinstance(motor_lag, MotorLag):
            lag = np.empty((substeps + 1, 2))
            write_lag_decay(h, substeps, motor_lag.up, motor_lag.down, lag)
        return cls(
            constants, lag,
            drag=0.5 * drag.density * drag.coefficient if isinstance(drag, Drag) else None,
            rotors=True if row[ROTOR_DRAG] else None,
            seen=True if rotors_of(world.model, 0)[0] >= 0 else None,
            second_order=True if scene.dynamics.integrator == "midpoint" else None,
            substeps=substeps,
        )


def why_not_in_blocks(world: World) -> str:
    """Why copies of a scene cannot run in blocks; empty if they can."""
    scene, model = world.scene, world.model
    if model.bodies.count != 1:
        others = [name for i, name in enumerate(model.bodies.names) if i not in model.drones.body]
        return f"there is more than one drone that touches nothing: {', '.join(others[:3]) or 'another drone'}"
    if not model.drones.quadrotor[0]:
        return "the flight model is not 'quadrotor'"
    if scene.dynamics.integrator not in INTEGRATORS:
        return f"the integrator is '{scene.dynamics.integrator}', not one of {', '.join(INTEGRATORS)}"
    if any(thing.behavior or (thing.flight and thing.flight.controller) for thing in scene.objects.values()):
        return "an object has a behavior or a controller"
    other = [name for name in scene.effects if name not in IN_BLOCKS]
    return f"the scene has the effect '{other[0]}'" if other else ""
