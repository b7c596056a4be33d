"""The layouts of what the simulation publishes every step; each function's message is written with the names given."""

from collections.abc import Iterable, Sequence

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


LINE_LIST = 5  # of visualization_msgs/Marker: points two by two


def line_markers(frame: str, lines: Iterable[tuple[str, int]]) -> Message:
    """visualization_msgs/MarkerArray with one marker of lines for each (name, number of end points).

    '<name>/points': (1, 3 n) m in the frame; '<name>/colours': (1, 4 n) red, green, blue, alpha, from 0 to 1.
    """
    lines = list(lines)
    layout = Layout().uint32(len(lines))
    for name, count in lines:
        layout.header(frame).string(name).uint32(0).uint32(LINE_LIST).uint32(0)  # id, type, action: add
        layout.float64("identity", 7).float64("width", 3).float32("colour", 4).uint32(0).uint32(0).uint8(0)
        layout.uint32(count).float64(f"{name}/points", 3 * count)
        layout.uint32(count).float32(f"{name}/colours", 4 * count)
        layout.string("").header("").string("").uint32(0).uint32(0)  # no texture, no uv coordinates
        layout.string("").string("").string("").uint32(0).uint8(0)  # no text, no mesh
    message = layout.message()
    if lines:
        message.write("identity", (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
        message.write("width", (0.01, 0.0, 0.0))
        message.write("colour", 1.0)
    return message
