"""Whether image files can be read."""

from pathlib import Path

from drone_engine.file_cache import read_once


def image_flaw(path: Path) -> str:
    """Why an image file cannot be read, in one line; empty if it can."""
    try:
        path.stat()
    except OSError as error:
        return error.strerror or str(error)
    return _flaw(path)


@read_once  # many materials share their textures
def _flaw(path: Path) -> str:
    from PIL import Image, UnidentifiedImageError  # slow to import, and most scenes have no texture to check

    try:
        with Image.open(path) as image:
            image.load()
    except UnidentifiedImageError:
        return "not an image"
    except OSError as error:
        return error.strerror or str(error)
    except Exception as error:  # each image format raises its own
        return (str(error).splitlines() or [type(error).__name__])[0]
    return ""
