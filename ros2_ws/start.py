"""Starts every node of the drone simulator, one process each, and ends them together.

Exit status: 0 after a clean run, 1 if a node failed, 2 for an invalid option.
"""

import argparse
import importlib.util
import json
import os
import subprocess
import sys
import termios
import time
from pathlib import Path
from typing import Any

from options import parse
from supervisor import Program, Supervisor

from drone_sim.node import DDS_PROFILE

DDS_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"  # set by the user: all nodes use that profile
FILM_PATIENCE = 600.0  # s; a film has every frame, and drawing may be slower than the simulation


def programs(options: argparse.Namespace) -> list[Program]:
    """The nodes to start; the simulation comes first, because the others wait for it."""
    package = importlib.util.find_spec("drone_render")  # not imported, which would take time
    dds_profile = Path(package.origin if package and package.origin else "").with_name("fastdds.xml")

    def node(name: str, module: str, environment: dict[str, str] | None = None, terminal: bool = False,
             patience: float = 0.0, **parameters: Any) -> Program:
        command = [sys.executable, "-m", module, "--ros-args", "--disable-external-lib-logs"]
        if options.verbose:
            command += ["--log-level", f"{name}:=debug"]
        if options.namespace:  # rclpy subscribes to the absolute /clock in any namespace
            command += ["-r", f"__ns:=/{options.namespace.strip('/')}", "-r", "/clock:=clock"]
        for key, value in ({"use_sim_time": name != "drone_sim"} | parameters).items():
            if value is not None:
                command += ["-p", f"{key}:={json.dumps(value, default=str)}"]
        leads = name == "drone_sim"
        niceness = 0 if leads or terminal else 5
        return Program(name, command, environment or {}, terminal, leads, niceness, patience)

    # A film and a bag begin with the first step: the simulation waits until both nodes subscribe to tf.
    records_tf = options.record and (not options.record_topics or {"tf", "/tf"} & set(options.record_topics))
    nodes = [node("drone_sim", "drone_sim.sim_node", scene=options.scene, rtf=options.rtf, duration=options.duration,
                  listeners=bool(options.film) + bool(records_tf))]
    if not options.no_render:
        # It takes its stamps from the states that it draws; a clock would wake it once more per step.
        nodes.append(node("drone_render", "drone_render.render_node", film=options.film, camera=options.camera,
                          use_sim_time=None,
                          patience=FILM_PATIENCE if options.film else 0.0,
                          environment={} if DDS_VARIABLE in os.environ else {DDS_VARIABLE: str(dds_profile)}))
    if not options.no_teleop and sys.stdin.isatty():
        nodes.append(node("drone_teleop", "drone_teleop.teleop_node", terminal=True, camera=options.camera))
    if not options.no_ai:
        nodes.append(node("drone_ai", "drone_ai.ai_node"))
    if options.record:
        nodes.append(node("drone_recorder", "drone_sim.recorder_node", path=options.record, storage=options.storage,
                          topics=options.record_topics))
    return nodes


def set_environment(options: argparse.Namespace) -> None:
    """Sets the environment of all nodes; variables that the user has set are kept."""
    os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
    os.environ.setdefault(DDS_VARIABLE, str(DDS_PROFILE))
    os.environ["PYTHONUNBUFFERED"] = "1"
    for library in ("OPENBLAS", "OMP", "NUMBA"):  # a thread pool in each node only slows the start
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    if options.domain is not None:
        os.environ["ROS_DOMAIN_ID"] = str(options.domain)


def recover(bag: Path) -> str:
    """Completes the bag of a recorder that failed; returns the result in one line."""
    command = [sys.executable, "-m", "drone_sim.bag", "recover", str(bag)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return (result.stdout.strip() or result.stderr.strip()).rpartition("\n")[2]


def main() -> int:
    """Runs until the end of the duration, until the user quits, or Ctrl-C; returns the exit status."""
    try:
        options = parse()
    except KeyboardInterrupt:  # before anything has started
        return 0
    nodes = programs(options)
    set_environment(options)
    if not options.no_teleop and not sys.stdin.isatty():
        print("no keyboard teleoperation: the standard input is not a terminal")

    start = time.monotonic()
    terminal = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    supervisor = Supervisor(nodes, options.log_dir, options.verbose)
    supervisor.run(alone_for=options.duration / (options.rtf or 1.0))
    if terminal:  # a node that was killed may have left it changed
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, terminal)

    recovered = recover(options.record) if "drone_recorder" in supervisor.failed else ""
    failures = f"; failed: {', '.join(supervisor.failed)}" if supervisor.failed else ""
    print(f"ran for {time.monotonic() - start:.1f} s{failures}")
    outputs = {"log": options.log_dir, "bag": options.record, "film": options.film}
    print("  ".join(f"{kind}: {path}" for kind, path in outputs.items() if path)
          + (f"  ({recovered})" if recovered else ""))
    return 1 if supervisor.failed else 0


if __name__ == "__main__":
    sys.exit(main())
