"""Loading scenes: from a file by name or path, from text, or from data in Python. All three validate alike."""

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from drone_engine.assets import asset_path
from drone_engine.scene import files
from drone_engine.scene.errors import SceneError, first_error, quoted
from drone_engine.scene.fields import FOUND
from drone_engine.scene.plain import plain
from drone_engine.scene.schema import FILE_SIZE_LIMIT, Scene
from drone_engine.scene.shorthand import as_json
from drone_engine.scene.strict_yaml import read_yaml

__all__ = ["Scene", "SceneError", "load", "make_scene", "parse"]


def load(scene: str | Path) -> Scene:
    """Reads a scene file, given by its path or, for the shipped ones, by its name ('island'). Raises SceneError."""
    path = Path(scene)
    if path.suffix not in (".yaml", ".yml"):
        path = asset_path("scenes", f"{scene}.yaml", SceneError)
    try:
        with path.open("rb") as file:
            text = file.read(FILE_SIZE_LIMIT + 1)
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}") from None
    return parse(text, path)


def parse(text: bytes | str, path: Path) -> Scene:
    """Reads a scene from the text of its file.

    path: of the file, which need not exist: errors name it, and models and textures are looked up beside its folder.
    Raises SceneError.
    """
    text = text.encode() if isinstance(text, str) else text
    try:
        if len(text) > FILE_SIZE_LIMIT:
            raise SceneError(f"expected at most {FILE_SIZE_LIMIT} bytes")
        found = {"name": path.stem, "path": path.absolute(), "folder": path.absolute().parent,
                 "assets": path.absolute().parent.parent}
        return _completed(as_json(read_yaml(text)), found, text)
    except ValueError as error:
        raise SceneError(f"{path}: {error}") from None


def make_scene(content: Mapping[str, Any], name: str = "scene", folder: str | Path | None = None) -> Scene:
    """Makes a scene from data with the structure of a scene file.

        make_scene({"effects": {"gravity": {}}, "objects": {"crate": {"model": "crate", "mass": 3, "pose": (0, 0, 2)}}})

    content: dicts for mappings, lists, tuples or arrays for lists, numbers also of NumPy; 'version' may be left out.
    Parts of the schema, such as `Camera(...)`, are accepted in place of dicts. A model may also be the path of an OBJ
    file ("parts/arm.obj"), a texture of the sky any path with a folder in it.
    name: of the scene, which errors begin with: "<name>: objects.crate.mass: Input should be ...".
    folder: where relative paths start, and whose folders models/ and textures/ are searched before the shipped ones;
    if None, relative paths start in the current folder.
    Raises SceneError, with the texts that a file would cause.
    """
    if not re.fullmatch(r"[^/\\\n\r]{1,100}", name):
        raise SceneError(f"name: expected 1 to 100 characters without slashes and line breaks, got {quoted(name)}")
    start = Path.cwd() if folder is None else Path(folder).absolute()
    try:
        if not start.is_dir():
            raise SceneError(f"folder: no folder '{folder}'")
        if not isinstance(content, Mapping):
            raise SceneError(f"expected a mapping, got {type(content).__name__}")
        data = plain(content)
        data.setdefault("version", 1)
        text = as_json(data)
        found = {"name": name, "path": Path(name), "folder": start, "assets": None if folder is None else start,
                 "files": _given_by_path(data, start)}
        return _completed(text, found, text.encode())
    except ValueError as error:
        raise SceneError(f"{name}: {error}") from None


def _completed(text: str, found: dict[str, Any], source: bytes) -> Scene:
    """The scene in a JSON text, validated, with the values that loading adds. Raises ValueError without the prefix."""
    try:
        scene = Scene.model_validate_json(text, strict=True)
    except ValidationError as error:
        raise SceneError(first_error(error, Scene)) from None
    reserved = {key for key, field in Scene.model_fields.items() if FOUND in field.metadata}
    if written := reserved & scene.model_fields_set:
        raise SceneError(f"{min(written)}: must not be set in a scene")
    scene = scene.model_copy(update=found)
    digest = hashlib.sha256(source)
    for name in scene.objects:
        digest.update(files.model_bytes(scene, name))
    return files.with_texture_files(scene).model_copy(update={"hash": digest.hexdigest()})


def _given_by_path(data: dict[str, Any], start: Path) -> dict[str, Path]:
    """Files of the models and textures that plain data name by their paths, by these names."""
    objects = data.get("objects")
    models = [thing.get("model") for thing in objects.values() if isinstance(thing, dict)] if isinstance(
        objects, dict) else []
    render = data.get("render")
    sky = render.get("sky") if isinstance(render, dict) else None
    textures = [sky.get(key) for key in files.SKY_TEXTURES] if isinstance(sky, dict) else []
    names = [model for model in models if isinstance(model, str) and model.lower().endswith(".obj")]
    names += [texture for texture in textures if isinstance(texture, str) and len(Path(texture).parts) > 1]
    return {name: start / Path(name).expanduser() for name in names}
