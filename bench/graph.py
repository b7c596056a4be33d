"""The whole graph on this machine: start-up, real-time factor, and how many camera frames arrive.

Starts every node as a user would and listens in a process with default settings to the poses of the user's drone
and to one camera, 640x480 at 60 Hz. A frame counts once, by its stamp; its bytes are checked to be a picture.
"""

import argparse
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import PoseStamped
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from report import Row, report
from sensor_msgs.msg import Image

ROOT = Path(__file__).parents[1]
WARM_UP = 3.0  # s of simulated time before the counting starts
HEADER = 12  # bytes: encoding, seconds, nanoseconds


class Listener:
    """Arrival times and stamps, in s."""

    def __init__(self, node: Node, camera: str) -> None:
        self.poses: list[tuple[float, float]] = []
        self.frames: list[tuple[float, float]] = []
        self.spreads: list[float] = []
        node.create_subscription(PoseStamped, "user_drone/pose", self._on_pose, qos_profile_sensor_data, raw=True)
        node.create_subscription(Image, f"camera/{camera}/image_raw", self._on_frame, qos_profile_sensor_data, raw=True)

    def _on_pose(self, data: bytes) -> None:
        self.poses.append((time.monotonic(), _stamp(data)))

    def _on_frame(self, data: bytes) -> None:
        self.frames.append((time.monotonic(), _stamp(data)))
        if len(self.frames) % 60 == 1:
            self.spreads.append(float(np.frombuffer(data, np.uint8, offset=len(data) // 4).std()))


def _stamp(data: bytes) -> float:
    seconds, nanoseconds = np.frombuffer(data[:HEADER], "<u4", offset=4)
    return float(seconds) + 1e-9 * float(nanoseconds)


def fly(seconds: float, camera: str, domain: int) -> tuple[float, Listener, float]:
    """One run: when it was started, what was heard, and CPU s of all its processes."""
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("bench_graph", context=context)
    listener = Listener(node, camera)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    before = os.times()
    start = time.monotonic()
    graph = subprocess.Popen(
        [sys.executable, str(ROOT / "ros2_ws/start.py"), "--duration", str(seconds + WARM_UP), "--no-teleop"],
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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0, help="simulated time that is measured (default: 20)")
    parser.add_argument("--runs", type=int, default=3, help="medians are over this many (default: 3)")
    parser.add_argument("--camera", default="chase")
    parser.add_argument("--quick", action="store_true", help="one run of 5 s")
    options = parser.parse_args()
    seconds, runs = (5.0, 1) if options.quick else (options.seconds, options.runs)

    first_pose, first_frame, factors, arrived, cpu = [], [], [], [], []
    for run in range(runs):
        start, heard, cpu_time = fly(seconds, options.camera, 10 + run)
        first_pose.append(heard.poses[0][0] - start)
        first_frame.append(heard.frames[0][0] - start)
        window = [(wall, stamp) for wall, stamp in heard.poses if stamp >= WARM_UP]
        factors.append((window[-1][1] - window[0][1]) / (window[-1][0] - window[0][0]))
        stamps = {round(stamp * 60) for _, stamp in heard.frames if stamp >= WARM_UP}
        arrived.append(100.0 * len(stamps) / (60 * seconds))
        cpu.append(100.0 * cpu_time / (window[-1][0] - start))
        if min(heard.spreads) < 10.0:
            raise SystemExit("a frame was of one colour: these are no pictures")
        print(f"run {run + 1} of {runs}: pose {first_pose[-1]:.2f} s, frame {first_frame[-1]:.2f} s, "
              f"factor {factors[-1]:.4f}, frames {arrived[-1]:.1f} %")

    median = statistics.median
    report("graph", {"scene": "island", "camera": options.camera, "size": "640x480", "physics": 30, "draw": 60,
                     "seconds": seconds, "runs": runs, "start": "kernels and shaders compiled before"}, [
        Row("start to first pose", "s", median(first_pose), "at most 3", median(first_pose) <= 3.0),
        Row("start to first frame", "s", median(first_frame), "at most 5", median(first_frame) <= 5.0),
        Row("real-time factor, one camera drawn", "", median(factors), "at least 0.99", median(factors) >= 0.99),
        Row("frames that arrive at 60 Hz", "%", median(arrived), "at least 99", median(arrived) >= 99.0),
        Row("CPU of all nodes, of one core", "%", median(cpu)),
    ])


if __name__ == "__main__":
    main()
