"""The command `topic`."""

import signal
import sys

from geometry_msgs.msg import PoseStamped, Twist

from .live import Graph, NodeProcess, Spawn


def topic(spawn: Spawn, *arguments: str) -> NodeProcess:
    process = spawn.command("topic", [sys.executable, "-P", "-m", "drone_sim.topic", *arguments])
    process.ended_by_test = True  # a command ends by itself, with a status that the test checks
    return process


def test_list_echo_info_and_hz(graph: Graph, spawn: Spawn) -> None:
    pose = graph.node.create_publisher(PoseStamped, "user_drone/pose", 10)
    message = PoseStamped()
    message.pose.position.z = 2.5
    with graph.repeating(pose, message):
        listing, echo = topic(spawn, "list", "-t"), topic(spawn, "echo", "user_drone/pose", "--once")
        field = topic(spawn, "echo", "user_drone/pose", "--count", "2", "--field", "pose.position.z")
        unknown, info = topic(spawn, "echo", "user_drone/pos"), topic(spawn, "info", "user_drone/pose")
        commands = (listing, echo, field, unknown, info)
        graph.wait_for(lambda: all(command.ended() for command in commands), "the end of the commands")
        hz = topic(spawn, "hz", "user_drone/pose")
        graph.wait_for(lambda: "average rate: " in hz.output(), "a rate")
    assert hz.interrupt() == 0
    assert "Traceback" not in hz.output()
    assert "/user_drone/pose [geometry_msgs/msg/PoseStamped]" in listing.output().splitlines()
    assert echo.output().startswith("header:\n") and echo.output().endswith("---\n")
    assert "    z: 2.5\n" in echo.output()
    assert field.output() == "2.5\n---\n2.5\n---\n"
    assert unknown.output().splitlines() == ["topic: no topic /user_drone/pos; similar: /user_drone/pose"]
    assert unknown.wait() == 1
    assert "Publishers: 1" in info.output()


def test_pub(graph: Graph, spawn: Spawn) -> None:
    heard = graph.listen(Twist, "cmd_vel")
    once = topic(spawn, "pub", "cmd_vel", "geometry_msgs/Twist", "{linear: {x: 1, z: -0.5}}", "--once")
    graph.wait_for(lambda: heard, "a command")
    assert (heard[0].linear.x, heard[0].linear.z, heard[0].angular.z) == (1.0, -0.5, 0.0)
    assert once.wait() == 0
    repeated = topic(spawn, "pub", "cmd_vel", "geometry_msgs/msg/Twist", "{}", "--rate", "50")
    graph.wait_for(lambda: len(heard) > 10, "ten commands")
    repeated.send(signal.SIGINT)
    assert repeated.wait() == 0


def test_pub_names_what_is_wrong(spawn: Spawn) -> None:
    for text, complaint in {
        "{linear: {w: 1}}": "linear.w: expected one of x, y, z, got 'w'",
        "{linear: {x: fast}}": "linear.x: expected double, got 'fast'",
        "[1, 2]": "message: expected fields (linear, angular), got [1, 2]",
    }.items():
        process = topic(spawn, "pub", "cmd_vel", "geometry_msgs/msg/Twist", text)
        assert process.wait() == 1
        assert process.output() == f"topic: {complaint}\n"
