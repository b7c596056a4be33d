"""Render passes from a user's own package, which a scene names under `render.passes`.

A pass is a module with `Parameters`, a Strict model that validates its part of the scene file, and `build`, which
returns a RenderPass. The scene names the module, which is imported from the environment or from the folder of the scene
file (`passes: {my_package.trail: {object: drone}}`), or an entry point in the group 'drone_render.passes'.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol, cast

from pydantic import ValidationError

from drone_engine import Scene, SceneError
from drone_engine.extension import ExtensionError, find, member
from drone_engine.scene.errors import first_error
from drone_engine.scene.fields import Strict
from drone_render.frame.frame import Frame
from drone_render.frame.hierarchy import Hierarchy
from drone_render.gl.context import Context, Framebuffer
from drone_render.gl.device import Device


@dataclass(frozen=True)
class PassContext:
    """What a pass is built from."""

    scene: Scene
    hierarchy: Hierarchy  # `hierarchy.matrix(frame.world, name)` is the matrix (4, 4) of an object in the world
    gl: Context  # moderngl's context; free what you create with it in `RenderPass.release`
    device: Device  # creates programs, buffers and textures that are freed with the renderer


class RenderPass:
    """Draws into every picture of every camera, at up to two points of it. Override the hooks that you need.

    The framebuffer of the picture is bound when a hook is called. `frame.view_projection` leads from the world to clip
    space; it negates y, so front faces are clockwise there. Depth and labels do not contain user passes.
    """

    def draw_opaque(self, frame: Frame) -> None:
        """Draws opaque surfaces: after the solid ones, before water and sky.

        Depth test and back-face culling are on, blending is off. If the scene uses antialiasing, edges are smoothed
        where alpha differs between neighboring pixels.
        """

    def draw_blended(self, frame: Frame) -> None:
        """Draws translucent surfaces: after everything else of the scene, before the lines of the debug view.

        The depth test is on, depth is not written, culling is off, and colors are blended by their alpha.
        """

    def release(self) -> None:
        """Frees resources that were not created by `PassContext.device`."""


class PassModule(Protocol):
    """The contents of a pass's module."""

    Parameters: type[Strict]

    @staticmethod
    def build(parameters: Strict, context: PassContext) -> RenderPass:
        """The pass with these parameters."""


class UserPasses:
    """The passes that a scene names, in its order. Raises SceneError for passes that cannot be imported or built."""

    def __init__(self, scene: Scene, hierarchy: Hierarchy, device: Device) -> None:
        self._path, self._device = scene.path, device
        self._passes: dict[str, RenderPass] = {}
        context = PassContext(scene, hierarchy, device.context, device)
        for name, given in scene.render.passes.items():
            module = _module(name, scene)
            try:
                parameters = module.Parameters.model_validate_json(json.dumps(given), strict=True)
            except ValidationError as error:
                message = first_error(error, module.Parameters, ("render", "passes", name))
                raise SceneError(f"{scene.path}: {message}") from None
            with self._named(name):
                built = module.build(parameters, context)
            if not isinstance(built, RenderPass):
                raise SceneError(f"{scene.path}: render.passes.{name}: expected build() to return a RenderPass, got "
                                 f"{type(built).__name__}")
            self._passes[name] = built

    def draw_opaque(self, frame: Frame, target: Framebuffer) -> None:
        """Calls this hook of all passes, and restores the state for opaque surfaces."""
        for name, each in self._passes.items():
            with self._named(name):
                each.draw_opaque(frame)
            target.use()
            self._device.set_opaque_state()

    def draw_blended(self, frame: Frame, target: Framebuffer) -> None:
        """Calls this hook of all passes, and restores the state for opaque surfaces."""
        for name, each in self._passes.items():
            self._device.set_blended_state()
            target.depth_mask = False
            with self._named(name):
                each.draw_blended(frame)
            target.use()
            target.depth_mask = True
        self._device.set_opaque_state()

    def release(self) -> None:
        """Releases all passes."""
        for each in self._passes.values():
            each.release()

    @contextmanager
    def _named(self, name: str) -> Iterator[None]:
        """Turns any exception of the user's code into a SceneError that names the scene file and the pass."""
        try:
            yield
        except Exception as error:
            reason = (str(error).splitlines() or [""])[0]
            raise SceneError(f"{self._path}: render.passes.{name}: {type(error).__name__}: {reason}") from error


def _module(name: str, scene: Scene) -> PassModule:
    """The module of a pass. Raises SceneError."""
    try:
        module = find("passes", name, scene.folder, package="drone_render")
        for key in ("Parameters", "build"):
            member(module, name, key)
    except ExtensionError as error:
        raise SceneError(f"{scene.path}: render.passes.{name}: {error}") from error.__cause__
    return cast(PassModule, module)
