"""The messages that a world publishes every step, serialized from its arrays."""

from collections.abc import Container, Iterator
from enum import Enum

import numpy as np

from drone_engine.arrays import Floats
from drone_engine.collision.events import ContactEvents
from drone_engine.math.poses import compose, inverse, rotate_all
from drone_engine.world import World
from drone_sim.wire import layouts
from drone_sim.wire.cdr import SECOND, Message

CLOCK_RATE = 200.0  # Hz at most


class Type(Enum):
    """Message types by their full names."""

    CLOCK = "rosgraph_msgs/msg/Clock"
    POSE = "geometry_msgs/msg/PoseStamped"
    ODOMETRY = "nav_msgs/msg/Odometry"
    TRANSFORMS = "tf2_msgs/msg/TFMessage"
    JOINTS = "sensor_msgs/msg/JointState"
    COLLISIONS = "drone_interfaces/msg/CollisionEvents"


class Telemetry:
    """The messages of one world. Topic names are relative, but for /clock."""

    def __init__(self, world: World) -> None:
        self._world = world
        bodies, rotors, fixed = world.model.bodies, world.model.rotors, world.model.fixed
        self._movable = np.flatnonzero(bodies.movable)
        movable = [bodies.names[i] for i in self._movable]
        self._drone_rows = np.searchsorted(self._movable, world.model.drones.body)
        drones = [bodies.names[i] for i in world.model.drones.body]

        self._clock = layouts.clock()
        self._clock_every = max(1, int(np.ceil(world.scene.rates.physics / CLOCK_RATE)))
        self._transforms = layouts.transforms(["world"] * len(movable) + list(rotors.parents),
                                               movable + list(rotors.names))
        self._joints = layouts.joint_state(rotors.names) if rotors.names else None
        self._poses = {f"{name}/pose": layouts.pose_stamped("world") for name in movable}
        self._odometry = {f"{name}/odom": layouts.odometry("world", name) for name in drones}
        self._collisions = layouts.CollisionEvents(bodies.names)
        self._collision_events(world.contact_events, 0)  # compiles now, not for the first subscriber
        self._static = layouts.transforms(fixed.parents, fixed.names)
        if fixed.names:
            self._static.write("pose", fixed.pose_p)

    @property
    def topics(self) -> dict[str, Type]:
        """The topics of `messages` and their types."""
        joints = {"joint_states": Type.JOINTS} if self._joints else {}
        return {"/clock": Type.CLOCK, "tf": Type.TRANSFORMS, "collisions": Type.COLLISIONS, **joints,
                **dict.fromkeys(self._poses, Type.POSE), **dict.fromkeys(self._odometry, Type.ODOMETRY)}

    def static(self, time_ns: int) -> bytes:
        """The serialized TFMessage for tf_static at a time in ns."""
        self._static.stamp(time_ns)
        return bytes(self._static)

    def messages(self, subscribed: Container[str]) -> Iterator[tuple[str, bytes]]:
        """Yields topic and serialized message of everything to publish after a step.

        subscribed: topics with subscribers; poses, odometry and collisions of other topics are left out.
        """
        world, now = self._world, self.time_ns
        step = int(world.state.step[0])
        poses = world.object_poses()[self._movable]
        if step % self._clock_every == 0:
            yield "/clock", self._filled(self._clock, now)
        yield "tf", self._filled(self._transforms, now, pose=np.concatenate([poses, self._rotor_poses()]))
        if self._joints:
            yield "joint_states", self._filled(self._joints, now, position=world.state.rotor_angle,
                                               velocity=world.state.rotor_rate)
        for (topic, message), pose in zip(self._poses.items(), poses, strict=True):
            if topic in subscribed:
                yield topic, self._filled(message, now, pose=pose)
        for (topic, message), row, twist in zip(self._odometry.items(), self._drone_rows, self._twists(), strict=True):
            if topic in subscribed:
                yield topic, self._filled(message, now, pose=poses[row], twist=twist)
        if "collisions" in subscribed and len((events := world.contact_events).phase):
            yield "collisions", self._collision_events(events, now)

    def _collision_events(self, events: ContactEvents, time_ns: int) -> bytes:
        touching = events.pairs
        pairs = np.stack([touching.key >> 32, touching.key & 0xFFFFFFFF], axis=1)
        numbers = np.concatenate([touching.touch[:, :3], touching.normal, touching.touch[:, 3:]], axis=1)
        return self._collisions.message(time_ns, int(self._world.state.step[0]), events.phase, pairs, touching.level,
                                        numbers)

    @property
    def time_ns(self) -> int:
        """Simulated time in ns, from the number of steps, so that no rounding accumulates."""
        return round(int(self._world.state.step[0]) * SECOND / self._world.scene.rates.physics)

    @staticmethod
    def _filled(message: Message, time_ns: int, **values: Floats) -> bytes:
        message.stamp(time_ns)
        for name, numbers in values.items():
            if numbers.size:
                message.write(name, numbers)
        return bytes(message)

    def _rotor_poses(self) -> Floats:
        """Poses (r, 7) of the rotors in their parents' frames, rotated about their own z axes."""
        angle = self._world.state.rotor_angle
        rotated = np.zeros((len(angle), 7))
        rotated[:, 5], rotated[:, 6] = np.sin(angle / 2), np.cos(angle / 2)
        return compose(self._world.model.rotors.pose_p, rotated)

    def _twists(self) -> Floats:
        """Twists (d, 6) of the drones, linear and angular, in their body frames, at the origins of their objects."""
        state, bodies, drone = self._world.state, self._world.model.bodies, self._world.model.drones.body
        to_body = inverse(state.orientation_w[drone])
        angular = rotate_all(to_body, state.angular_velocity_w[drone])
        linear = rotate_all(to_body, state.velocity_w[drone]) - np.cross(angular, bodies.center_b[drone])
        return np.concatenate([linear, angular], axis=1)
