"""The files that a scene refers to: models and textures."""

from pathlib import Path
from typing import TYPE_CHECKING

from drone_engine.assets import asset_path
from drone_engine.images import image_flaw
from drone_engine.scene.errors import SceneError

if TYPE_CHECKING:
    from drone_engine.scene.schema import Scene

SKY_TEXTURES = ("colours", "stars", "clouds")  # keys of render.sky


def model_path(scene: "Scene", name: str) -> Path:
    """File of the model of the object `name`: as given by path, in models/ of the scene's assets, or shipped.

    Raises SceneError if there is none.
    """
    model = scene.objects[name].model
    return scene.files.get(model) or asset_path("models", f"{model}.obj", SceneError, beside=scene.assets)


def texture_path(scene: "Scene", texture: Path) -> Path:
    """File of a texture, named with or without '.png': as given by path, in textures/ of the scene's assets or shipped.

    Raises SceneError if there is none.
    """
    file = str(texture) if texture.suffix else f"{texture}.png"
    return scene.files.get(str(texture)) or asset_path("textures", file, SceneError, beside=scene.assets)


def with_texture_files(scene: "Scene") -> "Scene":
    """The scene with the files of the sky's textures instead of their names. Raises SceneError."""
    sky = scene.render.sky
    if sky is None:
        return scene
    files = {}
    for key in SKY_TEXTURES:
        if (name := getattr(sky, key)) is not None:
            try:
                files[key] = texture_path(scene, name)
            except SceneError as error:
                raise SceneError(f"render.sky.{key}: {error}") from None
            if flaw := image_flaw(files[key]):
                raise SceneError(f"render.sky.{key}: {files[key]} is not readable: {flaw}")
    render = scene.render.model_copy(update={"sky": sky.model_copy(update=files)})
    return scene.model_copy(update={"render": render})


def model_bytes(scene: "Scene", name: str) -> bytes:
    """Contents of the model file of an object. Raises SceneError."""
    try:
        path = model_path(scene, name)
        return path.read_bytes()
    except OSError as error:
        raise SceneError(f"objects.{name}.model: {path}: {error.strerror}") from None
    except SceneError as error:
        raise SceneError(f"objects.{name}.model: {error}") from None
