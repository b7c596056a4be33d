"""The options of start.py: what they are, and which are refused."""

import argparse
import re
from pathlib import Path
from typing import NoReturn

EXAMPLE = "example: start.py --scene island --duration 20 --record out/run1 --film out/run1.mp4 --no-teleop"


class _Parser(argparse.ArgumentParser):
    """Refuses in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")


def _amount(text: str) -> float:
    """A finite number, 0 or more."""
    try:
        number = float(text)
    except ValueError:
        number = -1.0
    if not 0.0 <= number < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of 0 or more")
    return number


def _make_parser() -> _Parser:
    """All options."""
    parser = _Parser(description="Starts every node of the drone simulator, one process each.", epilog=EXAMPLE)

    run = parser.add_argument_group("what runs")
    run.add_argument("--scene", default="island", metavar="NAME|FILE", help="scene by name or by file (%(default)s)")
    run.add_argument("--duration", type=_amount, default=0.0, metavar="S",
                     help="end after so many simulated seconds; 0: never (0)")
    run.add_argument("--rtf", type=_amount, default=1.0, metavar="X",
                     help="real-time factor, 2 is twice as fast; 0: as fast as possible (1)")
    run.add_argument("--no-teleop", action="store_true", help="no keyboard control in this terminal")
    run.add_argument("--no-ai", action="store_true", help="the AI drone stays where it is")
    run.add_argument("--no-render", action="store_true", help="no pictures")

    keep = parser.add_argument_group("what is kept")
    keep.add_argument("--record", type=Path, metavar="DIR", help="record a bag (rosbag2) into this new folder")
    keep.add_argument("--storage", choices=("mcap", "sqlite3"), default="mcap", help="the bag's format (%(default)s)")
    keep.add_argument("--record-topics", nargs="+", metavar="TOPIC", help="record these topics only (all)")
    keep.add_argument("--film", type=Path, metavar="FILE", help="film the run, as .mp4 or .gif")
    keep.add_argument("--camera", metavar="NAME", help="camera that is filmed and saved at first (the scene's first)")
    keep.add_argument("--log-dir", type=Path, default=Path("out/log"), metavar="DIR",
                      help="all that the nodes say, one file a node (%(default)s)")

    graph = parser.add_argument_group("the ROS graph")
    graph.add_argument("--domain", type=int, metavar="N", help="ROS_DOMAIN_ID, 0 to 232 (the environment's)")
    graph.add_argument("--namespace", metavar="NS", help="put every node, topic and service under /NS")
    graph.add_argument("--verbose", action="store_true", help="show all that the nodes say, debug messages included")
    return parser


def parse() -> argparse.Namespace:
    """The options of the command line. What cannot be done ends the program with status 2 and one line."""
    parser = _make_parser()
    options = parser.parse_args()
    if options.record and options.record.exists():
        parser.error(f"--record: {options.record} exists; a bag needs a new folder")
    if options.rtf > 1000.0 or options.duration > 1e9:
        parser.error("--rtf goes up to 1000, --duration up to 1e9")
    if options.rtf == 0.0 and (options.record or options.film):
        parser.error("--rtf 0 outruns --record and --film, which would miss states; give a factor, 4 say")
    if options.record_topics and not options.record:
        parser.error("--record-topics needs --record")
    if options.film and options.film.suffix not in (".mp4", ".gif"):
        parser.error(f"--film: '{options.film}' needs to end in .mp4 or .gif")
    if options.no_render and (options.film or options.camera):
        parser.error("--film and --camera need pictures, but there is --no-render")
    if options.domain is not None and not 0 <= options.domain <= 232:
        parser.error(f"--domain: {options.domain} is not within 0 to 232")
    if options.namespace and not re.fullmatch(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", options.namespace, re.ASCII):
        parser.error(f"--namespace: '{options.namespace}' is not a name of letters, digits and _")
    from drone_engine import SceneError, load  # here, because --help need not wait for it

    try:
        scene = load(options.scene)
    except SceneError as error:
        parser.error(f"--scene: {error}")
    if options.camera and options.camera not in scene.cameras:
        parser.error(f"--camera: no camera '{options.camera}'; there are {', '.join(scene.cameras)}")
    for folder in (options.log_dir, *(path.parent for path in (options.film, options.record) if path)):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            parser.error(f"{folder}: {error.strerror}")
    return options
