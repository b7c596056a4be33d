"""Panda3D in bench.render: through EGL without a GPU, or with its own software rasterizer; lit per vertex."""

from collections.abc import Callable

import numpy as np
from panda3d import core

from bench.render import scene as scenery
from bench.render.scene import Bytes

PIPES = {"gl": "p3headlessgl", "tiny": "p3tinydisplay"}
SETTINGS = "window-type offscreen\naudio-library-name null\nsync-video 0\ntextures-power-2 none\nauto-flip 1"


class Drawer:
    """Uses the fixed-function pipeline; the shader generator needs Cg, which does not run on a software driver."""

    def __init__(self, mode: str) -> None:
        core.load_prc_file_data("", f"load-display {PIPES[mode]}\n{SETTINGS}")
        from direct.showbase.ShowBase import ShowBase  # reads the settings when it is imported

        self.about = "3 lights, per vertex, " + ("its own rasterizer" if mode == "tiny" else "fixed function")
        self._base = ShowBase(windowType="none")
        self._base.makeDefaultPipe()
        root = self._base.render
        hill = root.attach_new_node(self._geometry(scenery.hill()))
        hill.set_texture(self._texture(None))
        for k, (position, scale) in enumerate(scenery.balls()):
            node = root.attach_new_node(self._geometry(scenery.ball()))
            node.set_texture(self._texture(k))
            node.set_pos(*position)
            node.set_scale(scale)
        ambient, sun = core.AmbientLight("ambient"), core.DirectionalLight("sun")
        ambient.set_color((scenery.AMBIENT,) * 3 + (1,))
        sun.set_direction(core.Vec3(*-scenery.SUN))
        sun.set_color((scenery.SUN_SHARE,) * 3 + (1,))
        lights = [root.attach_new_node(light) for light in (ambient, sun)]
        for place in scenery.LAMPS[:2]:
            lamp = core.PointLight("lamp")
            lamp.set_color((scenery.LAMP_SHARE,) * 3 + (1,))
            lamp.attenuation = (1, 0, scenery.REACH**-2)
            lights.append(root.attach_new_node(lamp))
            lights[-1].set_pos(*place)
        for light in lights:
            root.set_light(light)

    def _geometry(self, mesh: scenery.Mesh) -> core.GeomNode:
        data = core.GeomVertexData("mesh", core.GeomVertexFormat.get_v3n3t2(), core.Geom.UH_static)
        data.unclean_set_num_rows(len(mesh.vertices))
        columns = np.hstack([mesh.vertices, mesh.normals, mesh.uv]).astype("f4")
        memoryview(data.modify_array(0)).cast("B")[:] = columns.tobytes()
        triangles = core.GeomTriangles(core.Geom.UH_static)
        triangles.set_index_type(core.Geom.NT_uint32)
        index = triangles.modify_vertices()
        index.unclean_set_num_rows(mesh.faces.size)
        memoryview(index).cast("B")[:] = mesh.faces.astype("u4").tobytes()
        geometry = core.Geom(data)
        geometry.add_primitive(triangles)
        node = core.GeomNode("mesh")
        node.add_geom(geometry)
        return node

    def _texture(self, number: int | None) -> core.Texture:
        image = scenery.colors(number)
        texture = core.Texture()
        texture.setup_2d_texture(image.shape[1], image.shape[0], core.Texture.T_unsigned_byte, core.Texture.F_rgb)
        texture.set_ram_image(np.ascontiguousarray(image[::-1, :, ::-1]).tobytes())
        texture.set_minfilter(core.SamplerState.FT_linear_mipmap_linear)
        return texture

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """Prepares for pictures of this size; returns the function that draws picture k, (height, width, 3)."""
        engine = self._base.graphicsEngine
        engine.remove_all_windows()
        buffers = core.FrameBufferProperties()
        buffers.set_rgba_bits(8, 8, 8, 8)
        buffers.set_depth_bits(24)
        window = engine.make_output(self._base.pipe, "picture", 0, buffers, core.WindowProperties.size(width, height),
                                    core.GraphicsPipe.BF_refuse_window)
        picture = core.Texture()
        window.add_render_texture(picture, core.GraphicsOutput.RTM_copy_ram)
        window.set_clear_color((*scenery.BACKGROUND, 1))
        lens = core.PerspectiveLens()
        lens.set_near_far(scenery.NEAR, scenery.FAR)
        across = 2 * np.degrees(np.arctan(np.tan(np.radians(scenery.HEIGHT_OF_VIEW) / 2) * width / height))
        lens.set_fov(across, scenery.HEIGHT_OF_VIEW)
        camera = self._base.render.attach_new_node(core.Camera("camera", lens))
        window.make_display_region().set_camera(camera)

        def frame(number: float) -> Bytes:
            camera.set_pos(*scenery.eye(number))
            camera.look_at(core.Point3(0, 0, 0), core.Vec3(0, 0, 1))
            engine.render_frame()
            rows = np.frombuffer(picture.get_ram_image(), np.uint8).reshape(height, width, -1)
            return rows[::-1, :, 2::-1].copy()

        return frame
