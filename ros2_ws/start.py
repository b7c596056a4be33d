"""Starts every node of the drone simulator, one process each, and ends them together.

Exit status: 0 after a clean run, 1 if a node died, 2 if an option is refused.
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
FILM_PATIENCE = 600.0  # s; a film drops no picture, and drawing may be slower than the simulation was


def programs(options: argparse.Namespace) -> list[Program]:
    """The nodes that the options ask for; the simulation first, because all the others wait for it."""
    package = importlib.util.find_spec("drone_render")  # found, not imported: that would take time
    dds_profile = Path(package.origin if package and package.origin else "").with_name("fastdds.xml")

    def node(name: str, module: str, environment: dict[str, str] | None = None, terminal: bool = False,
             patience: float = 0.0, **parameters: Any) -> Program:
        command = [sys.executable, "-m", module, "--ros-args", "--disable-external-lib-logs"]
        if options.verbose:
            command += ["--log-level", f"{name}:=debug"]
        if options.namespace:  # rclpy listens to the absolute /clock, whatever the namespace
            command += ["-r", f"__ns:=/{options.namespace.strip('/')}", "-r", "/clock:=clock"]
        for key, value in ({"use_sim_time": name != "drone_sim"} | parameters).items():
            if value is not None:
                command += ["-p", f"{key}:={json.dumps(value, default=str)}"]
        leads = name == "drone_sim"
        niceness = 0 if leads or terminal else 5
        return Program(name, command, environment or {}, terminal, leads, niceness, patience)

    # A film and a bag begin with the first step: the simulation waits until these two listen to tf.
    records_tf = options.record and (not options.record_topics or {"tf", "/tf"} & set(options.record_topics))
    nodes = [node("drone_sim", "drone_sim.sim_node", scene=options.scene, rtf=options.rtf, duration=options.duration,
                  listeners=bool(options.film) + bool(records_tf))]
    if not options.no_render:
        # Its stamps are those of the states that it draws; a clock would wake it at every step once more.
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
    """What all nodes share; what the person has set already stays."""
    os.environ.setdefault("AMENT_PREFIX_PATH", sys.prefix)
    os.environ.setdefault(DDS_VARIABLE, str(DDS_PROFILE))
    os.environ["PYTHONUNBUFFERED"] = "1"
    for library in ("OPENBLAS", "OMP", "NUMBA"):  # a thread pool for each core in each node only costs start-up
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    if options.domain is not None:
        os.environ["ROS_DOMAIN_ID"] = str(options.domain)


def recover(bag: Path) -> str:
    """Closes the bag that a dead recorder left behind; says what is saved."""
    command = [sys.executable, "-m", "drone_sim.bag", "recover", str(bag)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    return (result.stdout.strip() or result.stderr.strip()).rpartition("\n")[2]


def main() -> int:
    """Runs until the duration is over, the person quits, or Ctrl-C."""
    try:
        options = parse()
    except KeyboardInterrupt:  # before anything has started
        return 0
    nodes = programs(options)
    set_environment(options)
    if not options.no_teleop and not sys.stdin.isatty():
        print("no teleop: the standard input is not a terminal")

    start = time.monotonic()
    terminal = termios.tcgetattr(sys.stdin) if sys.stdin.isatty() else None
    supervisor = Supervisor(nodes, options.log_dir, options.verbose)
    supervisor.run(alone_for=options.duration / (options.rtf or 1.0))
    if terminal:  # whatever became of the program that changed it
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, terminal)

    saved = recover(options.record) if "drone_recorder" in supervisor.died else ""
    deaths = f"; died: {', '.join(supervisor.died)}" if supervisor.died else ""
    print(f"ran for {time.monotonic() - start:.1f} s{deaths}")
    kept = {"log": options.log_dir, "bag": options.record, "film": options.film}
    print("  ".join(f"{what}: {path}" for what, path in kept.items() if path) + (f"  ({saved})" if saved else ""))
    return 1 if supervisor.died else 0


if __name__ == "__main__":
    sys.exit(main())
