"""MuJoCo in bench.render: mujoco.Renderer through EGL, with its default of 4 samples or without multisampling."""

import os
from collections.abc import Callable

os.environ["MUJOCO_GL"] = "egl"  # read by the import below

import mujoco
import numpy as np

from bench.render import scene as scenery
from bench.render.scene import Bytes, save

MODEL = """<mujoco><visual><global offwidth="1280" offheight="720" fovy="{fov}"/><quality offsamples="{samples}"/>
<headlight ambient="{ambient} {ambient} {ambient}" diffuse="0 0 0" specular="0 0 0"/><map znear="0.0005" zfar="10"/>
</visual><asset><texture name="hill" type="2d" file="hill.png"/><material name="hill" texture="hill" specular="0"/>
<mesh name="hill" file="hill.obj" inertia="shell"/>{materials}</asset><worldbody>{lights}
<geom type="mesh" mesh="hill" material="hill" contype="0" conaffinity="0"/>{balls}</worldbody></mujoco>"""
SUN = '<light directional="true" castshadow="false" pos="0 0 50" dir="{0} {1} {2}"/>'
LAMP = ('<light castshadow="false" pos="{0} {1} {2}" dir="0 0 -1" cutoff="180" attenuation="1 0 {fall}" '
        'diffuse="{share} {share} {share}"/>')
PAINT = ('<texture name="{0}" type="2d" file="{0}.png"/><material name="{0}" texture="{0}" specular="0.3"/>'
         '<mesh name="{0}" file="ball.obj" scale="{1} {1} {1}"/>')
BALL = '<geom type="mesh" mesh="{0}" material="{0}" pos="{1} {2} {3}" contype="0" conaffinity="0"/>'
OFF = (mujoco.mjtRndFlag.mjRND_SHADOW, mujoco.mjtRndFlag.mjRND_REFLECTION, mujoco.mjtRndFlag.mjRND_SKYBOX,
       mujoco.mjtRndFlag.mjRND_HAZE)


class Drawer:
    """Shadows, reflections, sky box and haze are off."""

    def __init__(self, samples: str) -> None:
        self.about = f"3 lights, per vertex, {samples} samples"
        balls = [(f"ball_{k}", *ball) for k, ball in enumerate(scenery.balls())]
        assets = {"hill.obj": scenery.obj(scenery.hill()).encode(), "ball.obj": scenery.obj(scenery.ball()).encode()}
        for k, name in enumerate(["hill", *(name for name, _, _ in balls)]):
            assets[f"{name}.png"] = _png(scenery.colors(k - 1 if k else None))
        lights = SUN.format(*-scenery.SUN) + "".join(
            LAMP.format(*place, fall=scenery.REACH**-2, share=scenery.LAMP_SHARE) for place in scenery.LAMPS[:2])
        text = MODEL.format(
            fov=scenery.HEIGHT_OF_VIEW, samples=samples, ambient=scenery.AMBIENT, lights=lights,
            materials="".join(PAINT.format(name, scale) for name, _, scale in balls),
            balls="".join(BALL.format(name, *position) for name, position, _ in balls))
        self._model = mujoco.MjModel.from_xml_string(text, assets)
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self._camera = mujoco.MjvCamera()
        self._camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        self._renderer: mujoco.Renderer | None = None

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """Prepares for pictures of this size; returns the function that draws picture k, (height, width, 3)."""
        if self._renderer is not None:
            self._renderer.close()
        renderer = self._renderer = mujoco.Renderer(self._model, height, width)
        for flag in OFF:
            renderer.scene.flags[flag] = 0
        rows = np.empty((height, width, 3), np.uint8)
        camera = self._camera

        def frame(number: float) -> Bytes:
            sight = -scenery.eye(number)
            camera.lookat[:] = 0.0
            camera.distance = np.linalg.norm(sight)
            camera.azimuth = np.degrees(np.arctan2(sight[1], sight[0]))
            camera.elevation = np.degrees(np.arcsin(sight[2] / camera.distance))
            renderer.update_scene(self._data, camera)
            return np.asarray(renderer.render(out=rows))

        return frame


def _png(pixels: Bytes) -> bytes:
    """The pixels as a PNG file."""
    import io

    file = io.BytesIO()
    save(pixels, file)
    return file.getvalue()
