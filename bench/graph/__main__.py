"""The whole ROS graph on this machine: start-up time, real-time factor, and camera frames published and received.

Starts all nodes like a user and subscribes, in another process and with default settings, to the pose of the user's
drone and to one camera, 640x480 at 60 Hz. Scenes: the island; the hangar, which takes half as long to draw; a thousand
falling crates. A frame counts once, by its stamp, and its bytes must look like a picture. drone_render reports the
number of published frames.
"""

import argparse
import os
import signal
import statistics
import subprocess
import sys
import time

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

from bench import ROOT
from bench.report.results import Row, report

WARM_UP = 3.0  # s of simulated time before the counting starts
SETTLING = 1.0  # s for the discovery of the listener, before the nodes start
CROWD = "crates"  # has to run in real time; the other targets are for scenes drawn at 60 Hz
CROWDED = ("one camera drawn", ": frames that arrive", "of one core")
HEADER = 12  # bytes: encoding, seconds, nanoseconds


class Listener:
    """Receives poses, frames and diagnostics; arrival times and stamps are in s."""

    def __init__(self, node: Node, camera: str) -> None:
        self.poses: list[tuple[float, float]] = []
        self.frames: list[tuple[float, float]] = []
        self.spreads: list[float] = []
        self.published: list[tuple[int, int]] = []  # frames drawn by drone_render so far, and received by then
        node.create_subscription(PoseStamped, "user_drone/pose", self._on_pose, qos_profile_sensor_data, raw=True)
        node.create_subscription(DiagnosticArray, "diagnostics", self._on_report, 10)
        node.create_subscription(Image, f"camera/{camera}/image_raw", self._on_frame, qos_profile_sensor_data, raw=True)

    def _on_pose(self, data: bytes) -> None:
        self.poses.append((time.monotonic(), _stamp(data)))

    def _on_frame(self, data: bytes) -> None:
        self.frames.append((time.monotonic(), _stamp(data)))
        if len(self.frames) % 60 == 1:
            self.spreads.append(float(np.frombuffer(data, np.uint8, offset=len(data) // 4).std()))

    def _on_report(self, report: DiagnosticArray) -> None:
        for status in report.status:
            for value in status.values:
                if status.name.startswith("drone_render") and value.key == "frames drawn":
                    self.published.append((int(value.value), len(self.frames)))

    def arrived(self) -> float:
        """Percentage of the published frames that arrived, from the first report with frames to the last."""
        first, last = next(pair for pair in self.published if pair[0]), self.published[-1]
        return 100.0 * (last[1] - first[1]) / (last[0] - first[0])


def _stamp(data: bytes) -> float:
    """Time stamp of a serialized message, s."""
    seconds, nanoseconds = np.frombuffer(data[:HEADER], "<u4", offset=4)
    return float(seconds) + 1e-9 * float(nanoseconds)


def fly(scene: str, seconds: float, camera: str, domain: int) -> tuple[float, Listener, float]:
    """One run: time of its start, the listener, and CPU time of all its processes in s."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("bench_graph", context=context)
    listener = Listener(node, camera)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    settled = time.monotonic() + SETTLING
    while time.monotonic() < settled:
        executor.spin_once(timeout_sec=0.1)
    before = os.times()
    start = time.monotonic()
    graph = subprocess.Popen(
        [sys.executable, str(ROOT / "ros2_ws/start.py"), "--scene", scene, "--duration", str(seconds + WARM_UP),
         "--no-teleop"],
        env={**os.environ, "ROS_DOMAIN_ID": str(domain)}, stdout=subprocess.DEVNULL)
    try:
        while graph.poll() is None:
            executor.spin_once(timeout_sec=0.1)
    finally:
        if graph.poll() is None:
            graph.send_signal(signal.SIGINT)
        graph.wait()
        node.destroy_node()
        rclpy.shutdown(context=context)
    after = os.times()
    cpu = after.children_user + after.children_system - before.children_user - before.children_system
    return start, listener, cpu


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="simulated time that is measured (default: 20)")
    parser.add_argument("--runs", type=int, default=3, help="medians are over this many (default: 3)")
    parser.add_argument("--camera", default="chase")
    parser.add_argument("--quick", action="store_true", help="one run of 5 s")
    options = parser.parse_args()
    seconds, runs = (5.0, 1) if options.quick else (options.seconds, options.runs)

    rows = []
    for scene in ("island", "hangar", CROWD):
        rows += measure(scene, options.camera, seconds, runs)
    report("graph", {"camera": options.camera, "size": "640x480", "physics": 30, "draw": 60, "seconds": seconds,
                     "runs": runs, "numbers": "medians", "start": "kernels and shaders compiled before"}, rows)


def measure(scene: str, camera: str, seconds: float, runs: int) -> list[Row]:
    """Rows of a scene: medians over the runs."""
    numbers: dict[str, list[float]] = {}
    for run in range(runs):
        start, listener, cpu = fly(scene, seconds, camera, 10 + run)
        if min(listener.spreads) < 10.0:
            raise SystemExit("a frame has a single color: it is not a picture")
        window = [(wall, stamp) for wall, stamp in listener.poses if stamp >= WARM_UP]
        wall = window[-1][0] - window[0][0]
        stamps = {round(stamp * 60) for _, stamp in listener.frames if stamp >= WARM_UP}
        for name, number in {
            "pose": listener.poses[0][0] - start, "frame": listener.frames[0][0] - start,
            "factor": (window[-1][1] - window[0][1]) / wall, "rate": len(stamps) / seconds,
            "arrived": listener.arrived(), "cpu": 100.0 * cpu / (window[-1][0] - start),
        }.items():
            numbers.setdefault(name, []).append(number)
        print(f"{scene}, run {run + 1} of {runs}: "
              + ", ".join(f"{name} {values[-1]:.4g}" for name, values in numbers.items()), flush=True)
    m = {name: statistics.median(values) for name, values in numbers.items()}
    rows = [
        Row(f"{scene}: start to first pose", "s", m["pose"], "at most 3", m["pose"] <= 3.0),
        Row(f"{scene}: start to first frame", "s", m["frame"], "at most 5", m["frame"] <= 5.0),
        Row(f"{scene}: real-time factor, one camera drawn", "", m["factor"], "at least 0.99", m["factor"] >= 0.99),
        Row(f"{scene}: frames that arrive", "1/s", m["rate"], "60"),
        Row(f"{scene}: published frames that arrive", "%", m["arrived"], "at least 99", m["arrived"] >= 99.0),
        Row(f"{scene}: CPU of all nodes, of one core", "%", m["cpu"]),
    ]
    return [row for row in rows if scene != CROWD or row.work.endswith(CROWDED)]


if __name__ == "__main__":
    main()
