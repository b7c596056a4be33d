"""The options of start.py and their validation."""

import argparse
import re
from pathlib import Path
from typing import NoReturn

EXAMPLE = "example: start.py --scene island --duration 20 --record out/run1 --film out/run1.mp4 --no-teleop"


class _Parser(argparse.ArgumentParser):
    """Reports errors in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")


def _amount(text: str) -> float:
    """A finite number, 0 or more."""
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0.0 <= number < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number of 0 or more, got '{text}'")
    return number


def _make_parser() -> _Parser:
    """The parser with all options."""
    parser = _Parser(description="Starts every node of the drone simulator, one process each.", epilog=EXAMPLE)

    run = parser.add_argument_group("nodes and time")
    run.add_argument("--scene", default="island", metavar="NAME|FILE", help="scene, by name or file (%(default)s)")
    run.add_argument("--duration", type=_amount, default=0.0, metavar="S",
                     help="end after this simulated time in s; 0: never (0)")
    run.add_argument("--rtf", type=_amount, default=1.0, metavar="X",
                     help="real-time factor, simulated s per wall s; 0: as fast as possible (1)")
    run.add_argument("--no-teleop", action="store_true", help="no keyboard teleoperation in this terminal")
    run.add_argument("--no-ai", action="store_true", help="no AI pilot")
    run.add_argument("--no-render", action="store_true", help="no renderer")

    keep = parser.add_argument_group("recording")
    keep.add_argument("--record", type=Path, metavar="DIR", help="record a bag (rosbag2) into this new folder")
    keep.add_argument("--storage", choices=("mcap", "sqlite3"), default="mcap", help="the bag's format (%(default)s)")
    keep.add_argument("--record-topics", nargs="+", metavar="TOPIC", help="record only these topics (all)")
    keep.add_argument("--film", type=Path, metavar="FILE", help="film the run, as .mp4 or .gif")
    keep.add_argument("--camera", metavar="NAME", help="camera selected at the start (the scene's first)")
    keep.add_argument("--log-dir", type=Path, default=Path("out/log"), metavar="DIR",
                      help="output of the nodes, one file per node (%(default)s)")

    graph = parser.add_argument_group("ROS graph")
    graph.add_argument("--domain", type=int, metavar="N", help="ROS_DOMAIN_ID, 0 to 232 (from the environment)")
    graph.add_argument("--namespace", metavar="NS", help="put every node, topic and service under /NS")
    graph.add_argument("--verbose", action="store_true", help="show all output of the nodes, with debug messages")
    return parser


def parse() -> argparse.Namespace:
    """Parses the command line. An invalid option ends the program with status 2 and one line."""
    parser = _make_parser()
    options = parser.parse_args()
    if options.record and options.record.exists():
        parser.error(f"--record: expected a new folder, got {options.record}, which exists")
    if options.rtf > 1000.0:
        parser.error(f"--rtf: expected at most 1000, got {options.rtf:g}")
    if options.duration > 1e9:
        parser.error(f"--duration: expected at most 1e9, got {options.duration:g}")
    if options.rtf == 0.0 and (options.record or options.film):
        parser.error("--rtf: expected more than 0 with --record or --film, which would miss states, got 0")
    if options.record_topics and not options.record:
        parser.error("--record-topics: expected --record as well, got none")
    if options.film and options.film.suffix not in (".mp4", ".gif"):
        parser.error(f"--film: expected a name that ends in .mp4 or .gif, got '{options.film}'")
    if options.no_render and (options.film or options.camera):
        parser.error("--film, --camera: expected the renderer, got --no-render")
    if options.domain is not None and not 0 <= options.domain <= 232:
        parser.error(f"--domain: expected 0 to 232, got {options.domain}")
    if options.namespace and not re.fullmatch(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", options.namespace, re.ASCII):
        parser.error(f"--namespace: expected letters, digits and _, got '{options.namespace}'")
    from drone_engine import SceneError, load  # imported here, so that --help is fast

    try:
        scene = load(options.scene)
    except SceneError as error:
        parser.error(f"--scene: {error}")
    if options.camera and options.camera not in scene.cameras:
        parser.error(f"--camera: expected one of {', '.join(scene.cameras)}, got '{options.camera}'")
    for folder in (options.log_dir, *(path.parent for path in (options.film, options.record) if path)):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            parser.error(f"{folder}: {error.strerror}")
    return options
