"""The layouts of what the simulation publishes every step; each function's message is written with the names given."""

from collections.abc import Sequence

from drone_sim.cdr import Layout, Message


def clock() -> Message:
    """rosgraph_msgs/Clock."""
    return Layout().stamp().message()


def pose_stamped(frame: str) -> Message:
    """geometry_msgs/PoseStamped; 'pose': x y z qx qy qz qw."""
    return Layout().header(frame).float64("pose", 7).message()


def odometry(frame: str, child: str) -> Message:
    """nav_msgs/Odometry; 'pose': x y z qx qy qz qw; 'twist': linear, angular, in the child's frame; no covariance."""
    layout = Layout().header(frame).string(child)
    return layout.float64("pose", 7).float64("pose_covariance", 36).float64("twist", 6).float64(
        "twist_covariance", 36).message()


def transforms(parents: Sequence[str], children: Sequence[str]) -> Message:
    """tf2_msgs/TFMessage; 'pose': (n, 7) x y z qx qy qz qw."""
    layout = Layout().uint32(len(children))
    for parent, child in zip(parents, children, strict=True):
        layout.header(parent).string(child).float64("pose", 7)
    return layout.message()


def joint_state(names: Sequence[str]) -> Message:
    """sensor_msgs/JointState; 'position' (1, n) in rad, 'velocity' (1, n) in rad/s."""
    layout = Layout().header("").uint32(len(names))
    for name in names:
        layout.string(name)
    layout.uint32(len(names)).float64("position", len(names))
    layout.uint32(len(names)).float64("velocity", len(names))
    return layout.uint32(0).float64("effort", 0).message()
