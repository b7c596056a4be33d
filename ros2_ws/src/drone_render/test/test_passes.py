"""Render passes of a user's own package: pixels, graphics state, errors."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest

from drone_engine import SceneError
from drone_render import Renderer

from .drawing import Make

SCENE = """
render: {antialiasing: {}, sky: {}, water: {}, passes: PASSES}
objects:
  crate: {model: crate, pose: [4, 0, 0], mass: 1}
  lake: {model: floor, pose: [0, 0, -1], static: true, shading: water}
lights: {sun: {pose: [-200, 200, 300]}}
cameras: {front: {size: [160, 120], fov: 1.0}}
"""
SQUARE = '''
"""A green rectangle beside an object."""

import moderngl
import numpy as np

from drone_engine.scene.fields import Strict
from drone_render import Frame, PassContext, RenderPass

VERTEX = """#version 330 core
in vec3 position;
uniform mat4 view_projection;
void main() { gl_Position = view_projection * vec4(position, 1.0); }"""
FRAGMENT = """#version 330 core
out vec4 pixel;
uniform float opacity;
void main() { pixel = vec4(0.0, 1.0, 0.0, opacity); }"""


class Parameters(Strict):
    object: str
    opacity: float = 1.0


class Square(RenderPass):
    def __init__(self, parameters: Parameters, context: PassContext) -> None:
        self.parameters, self.context, self.released = parameters, context, 0
        self.program = context.device.compile("square", VERTEX, FRAGMENT)
        self.program["opacity"] = parameters.opacity
        self.buffer = context.device.buffer(np.zeros((4, 3), np.float32))
        self.array = context.device.vertex_array(self.program, [(self.buffer, "3f", "position")])

    def HOOK(self, frame: Frame) -> None:
        place = self.context.hierarchy.matrix(frame.world, self.parameters.object)[:3, 3]
        corners = place + [(-0.6, y, z) for y in (0.7, 1.6) for z in (-0.5, 0.5)]
        self.buffer.write(corners.astype(np.float32).tobytes())
        self.program["view_projection"].write(frame.view_projection.T.astype(np.float32).tobytes())
        self.array.render(moderngl.TRIANGLE_STRIP)

    def release(self) -> None:
        print("released", end="")


def build(parameters: Parameters, context: PassContext) -> RenderPass:
    return Square(parameters, context)
'''
RESTLESS = '''
from drone_engine.scene.fields import Strict
from drone_render import RenderPass


class Parameters(Strict):
    pass


class Restless(RenderPass):
    """Leaves the graphics state changed."""

    def __init__(self, context):
        self.gl = context.gl
        self.other = context.device.target((16, 16))

    def draw_opaque(self, frame):
        self.gl.enable_only(self.gl.BLEND)
        self.gl.blend_func = self.gl.ONE, self.gl.ONE
        self.gl.front_face = "ccw"
        self.gl.depth_func = ">"
        self.other.use()

    draw_blended = draw_opaque


def build(parameters, context):
    return Restless(context)
'''
Write = Callable[[str, str], str]


@pytest.fixture
def write_module(tmp_path: Path) -> Iterator[Write]:
    """Writes a module of the package my_passes beside the scene file; returns its dotted name."""
    folder = tmp_path / "my_passes"
    folder.mkdir()
    (folder / "__init__.py").touch()

    def write(name: str, text: str) -> str:
        (folder / f"{name}.py").write_text(text)
        return f"my_passes.{name}"

    yield write
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_passes"]:
        del sys.modules[name]


def draw(make_scene: Make, graphics: moderngl.Context, passes: str) -> np.ndarray:
    with Renderer(make_scene(SCENE.replace("PASSES", passes)), graphics) as renderer:
        return renderer.draw("front").astype(int)


@pytest.mark.parametrize("hook", ["draw_opaque", "draw_blended"])
def test_a_pass_beside_the_scene_file_is_drawn(
    hook: str, make_scene: Make, write_module: Write, graphics: moderngl.Context, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_module("square", SQUARE.replace("HOOK", hook))
    without = draw(make_scene, graphics, "{}")
    shown = draw(make_scene, graphics, f"{{{name}: {{object: crate}}}}")
    assert capsys.readouterr().out == "released"
    rows, columns = np.nonzero((shown == [0, 255, 0]).all(axis=2) | (hook == "draw_opaque") & (shown[..., 1] > 250))
    # 3.4 m ahead and 0.7 to 1.6 m to the left of the camera.
    focal = 80 / np.tan(0.5)
    assert len(rows) == pytest.approx(0.9 * (focal / 3.4) ** 2, rel=0.1)
    assert columns.mean() == pytest.approx(79.5 - 1.15 * focal / 3.4, abs=1.0)
    changed = np.abs(shown - without).max(axis=2) > 0
    changed[rows.min() - 1 : rows.max() + 2, columns.min() - 1 : columns.max() + 2] = False
    assert not changed.any()


def test_a_blended_pass_lets_the_picture_through(
    make_scene: Make, write_module: Write, graphics: moderngl.Context
) -> None:
    name = write_module("square", SQUARE.replace("HOOK", "draw_blended"))
    pictures = [draw(make_scene, graphics, passes) for passes in
                ("{}", f"{{{name}: {{object: crate, opacity: 0.5}}}}", f"{{{name}: {{object: crate}}}}")]
    inside = (pictures[2] == [0, 255, 0]).all(axis=2)
    np.testing.assert_allclose(pictures[1][inside], (pictures[0] + pictures[2])[inside] / 2, atol=1.5)


def test_a_pass_cannot_spoil_the_rest_of_the_picture(
    make_scene: Make, write_module: Write, graphics: moderngl.Context
) -> None:
    name = write_module("restless", RESTLESS)
    np.testing.assert_array_equal(draw(make_scene, graphics, f"{{{name}: {{}}}}"), draw(make_scene, graphics, "{}"))


def test_an_entry_point_names_a_pass(
    make_scene: Make, tmp_path: Path, write_module: Write, graphics: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_module("square", SQUARE.replace("HOOK", "draw_opaque"))
    metadata = tmp_path / "my_passes-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: my-passes\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text("[drone_render.passes]\nsquare = my_passes.square\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    by_entry_point = draw(make_scene, graphics, "{square: {object: crate}}")
    np.testing.assert_array_equal(by_entry_point, draw(make_scene, graphics, "{my_passes.square: {object: crate}}"))
    assert (by_entry_point[..., 1] == 255).any()


@pytest.mark.parametrize(("module", "given", "message"), [
    (SQUARE, "object: crate, size: 1", "render.passes.my_passes.mine.size: unknown key; allowed are object, opacity"),
    (SQUARE, "opacity: 1", "render.passes.my_passes.mine.object: Field required"),
    (SQUARE.replace("HOOK", "draw_opaque"), "object: house", "render.passes.my_passes.mine: KeyError: 'house'"),
    (SQUARE.replace("out vec4", "out vec9"), "object: crate",
     "render.passes.my_passes.mine: ValueError: the driver refuses the program 'square': "),
    ("x = 1", "", "render.passes.my_passes.mine: 'my_passes.mine' has no 'Parameters'"),
    ("import nowhere", "", "render.passes.my_passes.mine: cannot be imported: ModuleNotFoundError: "
                           "No module named 'nowhere'"),
    (RESTLESS.replace("return Restless(context)", "return 7"), "",
     "render.passes.my_passes.mine: expected build() to return a RenderPass, got int"),
], ids=["unknown key", "missing key", "draws", "shader", "no module of a pass", "import", "no pass"])  # fmt: skip
def test_an_error_is_one_line_with_file_and_key(
    module: str, given: str, message: str, make_scene: Make, write_module: Write, tmp_path: Path,
    graphics: moderngl.Context,
) -> None:  # fmt: skip
    write_module("mine", module)
    with pytest.raises(SceneError) as caught:
        draw(make_scene, graphics, f"{{my_passes.mine: {{{given}}}}}")
    text = str(caught.value)
    assert text.startswith(f"{tmp_path / 'test.yaml'}: {message}") and "\n" not in text


def test_a_module_that_does_not_exist_is_named(make_scene: Make, tmp_path: Path, graphics: moderngl.Context) -> None:
    with pytest.raises(SceneError) as caught:
        draw(make_scene, graphics, "{nowhere_at_all.glow: {}}")
    assert str(caught.value) == (f"{tmp_path / 'test.yaml'}: render.passes.nowhere_at_all.glow: no module "
                                 f"'nowhere_at_all', neither in the environment nor in {tmp_path}")
    with pytest.raises(SceneError, match=r"render\.passes\.glow: unknown pass$"):
        draw(make_scene, graphics, "{glow: {}}")
    with pytest.raises(SceneError, match=r"render\.passes\.a-b"):
        draw(make_scene, graphics, "{a-b: {}}")
