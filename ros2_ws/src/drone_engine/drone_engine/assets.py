"""Looks up scenes, models and textures: in a folder of the user, or among those shipped with the engine."""

from pathlib import Path

ASSETS = Path(__file__).with_name("data")  # scenes, models and textures shipped with the engine


def asset_path(kind: str, name: str, error: type[ValueError] = ValueError, beside: Path | None = None) -> Path:
    """The file `name` of a kind ('scenes', 'models' or 'textures'): in <beside>/<kind> if it is there, else shipped.

    Raises `error` for a file that does not exist, and for a path that leads out of the folder.
    """
    if Path(name).is_absolute() or ".." in Path(name).parts:
        raise error(f"'{name}' leads out of the {kind}")
    folders = [root / kind for root in (beside, ASSETS) if root]
    for folder in folders:
        if (folder / name).is_file():
            return folder / name
    known = sorted({path.stem for folder in folders for path in folder.glob(f"*{Path(name).suffix}")})
    raise error(f"no {kind[:-1]} '{Path(name).stem}'; there are {', '.join(known) or 'none'}")
