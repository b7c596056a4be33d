"""Rebuilds every model and texture in place, byte for byte; or only those that are named."""

import argparse
from pathlib import Path

from rich.progress import Progress

from make import buildings, drones, furniture, gates, growth, nature, people, vehicles
from make.obj import write_model
from make.textures import MAKERS, write_texture

ASSETS = Path(__file__).resolve().parent.parent
MODELS = {
    name: maker
    for subject in (drones, people, furniture, gates, buildings, vehicles, nature, growth)
    for name, maker in subject.MODELS.items()
}


def build(models: Path, textures: Path, names: list[str]) -> None:
    """Writes what is named, or all, into the two folders."""
    chosen = names or [*MAKERS, *MODELS]
    with Progress() as progress:
        task = progress.add_task("making", total=len(chosen))
        for name in chosen:
            progress.update(task, description=name)
            if name in MAKERS:
                write_texture(name, textures)
            if name in MODELS:
                write_model(name, MODELS[name](), models)
            progress.advance(task)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(prog="make", description=__doc__)
    parser.add_argument(
        "names",
        nargs="*",
        choices=[*MAKERS, *MODELS, []],
        metavar="NAME",
        help=f"which: {', '.join([*MAKERS, *MODELS])}",
    )
    parser.add_argument("--into", type=Path, default=ASSETS, help="folder that has models/ and textures/")
    arguments = parser.parse_args()
    folders = [arguments.into / kind for kind in ("models", "textures")]
    for folder in folders:
        folder.mkdir(parents=True, exist_ok=True)
    build(folders[0], folders[1], arguments.names)


if __name__ == "__main__":
    main()
