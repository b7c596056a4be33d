"""Schema of a quadrotor: rotors and control gains.

Defaults are those of the 3DR Iris in RotorS (Furrer et al. 2016, RotorS: A Modular Gazebo MAV Simulator Framework;
rotors_description/urdf/iris.xacro), which weighs 1.5 kg. Mass and inertia are those of the scene's object.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from drone_engine.scene.fields import Strict

Meters = Annotated[float, Field(ge=-100.0, le=100.0)]
Gain = Annotated[float, Field(gt=0.0, le=1000.0)]
# Forward and left of the center of mass in m; direction: 1 is counter-clockwise seen from above.
Arm = tuple[Meters, Meters, Literal[1, -1]]
IRIS: tuple[Arm, Arm, Arm, Arm] = ((0.13, -0.22, 1), (-0.13, 0.20, 1), (0.13, 0.22, -1), (-0.13, -0.20, -1))


class Gains(Strict):
    """Bandwidth of each control loop in 1/s; reduced where the time step is too coarse for it."""

    velocity: Gain = 3.0
    attitude: Gain = 8.0
    rate: Gain = 20.0  # of roll and pitch
    yaw_rate: Gain = 5.0
    disturbance: Annotated[float, Field(ge=0.0, le=100.0)] = 3.0  # of the estimate of external forces


class Airframe(Strict):
    """Four rotors: thrust = thrust_coefficient rate^2, drag torque = torque_ratio thrust, against their rotation."""

    arms: tuple[Arm, Arm, Arm, Arm] = IRIS  # used if the object does not have four rotors as children
    thrust_coefficient: Annotated[float, Field(gt=0.0, le=1.0)] = 8.54858e-06  # N s^2/rad^2
    torque_ratio: Annotated[float, Field(gt=0.0, le=1.0)] = 0.016  # m: N m of torque per N of thrust
    max_rate: Annotated[float, Field(gt=0.0, le=1e5)] = 838.0  # rad/s
    min_rate: Annotated[float, Field(ge=0.0, le=1e5)] = 100.0  # rad/s in flight, as PX4 arms its Iris
    rotor_drag: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0  # N s^2/(m rad), per rotor; RotorS has 8.06428e-5
    max_tilt: Annotated[float, Field(gt=0.0, le=1.4)] = 0.8  # rad, limit of the commanded tilt
    gains: Gains = Gains()

    @model_validator(mode="after")
    def _range(self) -> Self:
        if self.min_rate >= self.max_rate:
            raise ValueError(f"min_rate: expected less than max_rate, {self.max_rate:g}, got {self.min_rate:g}")
        return self
