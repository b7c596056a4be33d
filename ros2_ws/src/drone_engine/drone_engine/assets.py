"""Where scenes, models and textures are: beside a scene, or among those that come with the engine."""

from collections.abc import Callable
from functools import cache, wraps
from pathlib import Path
from typing import Any, TypeVar, TypeVarTuple

Others = TypeVarTuple("Others")
Content = TypeVar("Content")


def read_once(read: Callable[[Path, *Others], Content]) -> Callable[[Path, *Others], Content]:
    """Keeps what a function reads of a file, for as long as the file stays as it is."""

    @cache
    def kept(path: Path, changed: int, *others: Any) -> Content:
        return read(path, *others)

    @wraps(read)
    def once(path: Path, *others: *Others) -> Content:
        return kept(path, path.stat().st_mtime_ns if path.exists() else 0, *others)

    return once


ASSETS = Path(__file__).with_name("data")  # scenes, models and textures that come with the engine


def asset_path(kind: str, name: str, error: type[ValueError] = ValueError, beside: Path | None = None) -> Path:
    """The file `name` of a kind: scenes, models or textures; from the folder `beside` if it has it, else the assets.

    Raises `error`, ValueError if not given, for what is not there and for paths that lead out of the folder.
    """
    if Path(name).is_absolute() or ".." in Path(name).parts:
        raise error(f"'{name}' leads out of the {kind}")
    folders = [root / kind for root in (beside, ASSETS) if root]
    for folder in folders:
        if (folder / name).is_file():
            return folder / name
    known = sorted({path.stem for folder in folders for path in folder.glob(f"*{Path(name).suffix}")})
    raise error(f"no {kind[:-1]} '{Path(name).stem}'; there are {', '.join(known) or 'none'}")


def image_flaw(path: Path) -> str:
    """Why an image file cannot be read, in one line; nothing if it can."""
    try:
        path.stat()
    except OSError as error:
        return error.strerror or str(error)
    return _flaw(path)


@read_once  # many materials share their textures
def _flaw(path: Path) -> str:
    from PIL import Image, UnidentifiedImageError  # takes a while, and most scenes are loaded without a picture

    try:
        with Image.open(path) as image:
            image.load()
    except UnidentifiedImageError:
        return "no image"
    except OSError as error:
        return error.strerror or str(error)
    except Exception as error:  # each format has its own
        return (str(error).splitlines() or [type(error).__name__])[0]
    return ""
