"""The node that draws: follows the scene and the poses of the simulation, and publishes the pictures of its cameras."""

import sys
import threading
import time
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from drone_interfaces.msg import Scene as SceneMessage
from PIL import Image as PillowImage
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from drone_engine import SceneError
from drone_engine.arrays import Floats
from drone_engine.geometry import mesh
from drone_engine.scene import loading as scenes
from drone_render.film import FilmError, Reel
from drone_render.frame.schedule import Due, Schedule
from drone_render.gl import context
from drone_render.node.camera_messages import ImageMessage
from drone_render.node.camera_publisher import CameraPublisher, static_transforms
from drone_render.node.debug_view import DebugView
from drone_render.node.diagnostics import diagnostics
from drone_render.node.save_image import Request, SaveImage
from drone_render.renderer import Renderer
from drone_sim.node.parameters import Parameters
from drone_sim.node.process import Stop, run, spinning
from drone_sim.node.qos import LATCHED, RELIABLE
from drone_sim.wire.cdr import SECOND, Transforms, read_transforms

MAX_EARLY_STATES = 10_000  # kept for a film while its scene is being loaded
SWITCH_INTERVAL = 0.0005  # s; with Python's 5 ms the drawing thread would wait for the ROS thread a third of the time
FINISH_TIMEOUT = 1.0  # s, for the remaining pictures of a film after Ctrl-C


class RenderNode(Node):
    """Draws in the thread that calls `run`. Callbacks run in another thread; `_changed` guards the shared data."""

    def __init__(self) -> None:
        super().__init__("drone_render")
        parameters = Parameters(self)
        film = parameters.text("film", "", "film to make of the selected camera, .mp4 or .gif; none if empty")
        self._reel = Reel(film, parameters.integer("film_rate", 30, 1, 240, "pictures per simulated second"))
        self._wanted_camera = parameters.text("camera", "", "camera selected at the start; the scene's first if empty")
        image_dir = Path(parameters.text("image_dir", "out", "folder for the images that ~/save_image writes"))

        self._graphics = context.create()
        self.get_logger().info(f"drawing on {context.device_name(self._graphics)}")
        self._changed = threading.Condition()
        self._wanted_scene: SceneMessage | None = None
        self._added: list[str] = []
        self._schedule: Schedule | None = None
        # States that arrive while the scene is being loaded; a film begins with the first of them.
        self._early: deque[Transforms] = deque(maxlen=MAX_EARLY_STATES if film else 1)
        self._renderer: Renderer | None = None
        self._hash = ""
        self._selected = ""
        self._cameras: dict[str, CameraPublisher] = {}
        self._drawn = 0
        self._publishing = ThreadPoolExecutor(1, "publish")  # while the next picture is drawn
        self._published: Future[None] = self._publishing.submit(lambda: None)

        self.create_subscription(SceneMessage, "scene", self._on_scene, LATCHED)
        self.create_subscription(TFMessage, "tf", self._on_tf, RELIABLE, raw=True)
        self.create_subscription(String, "camera/select", self._on_select, LATCHED)
        self.create_subscription(String, "camera/add", self._on_add, 10)
        self._saving = SaveImage(self, image_dir, self._changed)
        self._debug = DebugView(self)
        self._names = self.create_publisher(String, "camera/labels", LATCHED)
        self._tf_static = self.create_publisher(TFMessage, "tf_static", LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self.create_timer(1.0, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))

    # Callbacks, in the thread of ROS.

    def _on_scene(self, message: SceneMessage) -> None:
        with self._changed:
            self._wanted_scene = message
            self._changed.notify()

    def _on_tf(self, data: bytes) -> None:
        try:
            state = read_transforms(data)
        except ValueError as error:
            self.get_logger().warning(f"tf: {error}; message ignored", throttle_duration_sec=5.0)
            return
        with self._changed:
            if self._schedule is None:
                self._early.append(state)
            else:
                self._schedule.push(state.stamp_ns, state.children, state.poses, time.monotonic())
                self._changed.notify()

    def _on_select(self, message: String) -> None:
        with self._changed:
            self._select(message.data)

    def _select(self, name: str) -> None:
        if self._schedule is None or (self._wanted_scene and self._wanted_scene.hash != self._hash):  # loading
            self._wanted_camera = name
        elif name in self._cameras:
            self._selected = self._wanted_camera = name
        else:
            known = ", ".join(self._cameras) or "none"
            self.get_logger().warning(f"camera/select: no camera '{name}'; there are {known}")

    def _on_add(self, message: String) -> None:
        with self._changed:
            self._added.append(message.data)
            self._changed.notify()

    def _report(self) -> None:
        with self._changed:
            dropped, now = 0, 0
            if self._schedule is not None:
                dropped, now = self._schedule.dropped, self._schedule.history.latest.stamp
            values = {"frames drawn": self._drawn, "frames dropped": dropped, "selected": self._selected}
            times = [value for publisher in self._cameras.values() for value in publisher.report()]
        name, drawing = context.device_name(self._graphics), self._renderer is not None
        self._diagnostics.publish(diagnostics(name, drawing, now, values, times))

    # Drawing, in the thread that owns the context.

    def run(self, stop: Stop) -> None:
        """Draws until `stop` is set, and then the rest of the film."""
        try:
            with spinning(self, stop):
                mesh.prepare()  # done while the simulation starts, which takes longer
                self._draw_until(stop)
        finally:
            self._close(stop)

    def _draw_until(self, stop: Stop) -> None:
        while not stop.is_set():
            with self._changed:
                now = time.monotonic()
                wait = None if self._schedule is None else self._schedule.wait(now)
                if self._wanted_scene is None and not self._saving.waiting and not self._added and wait != 0.0:
                    self._changed.wait(min(0.1 if wait is None else wait, 0.1))
                wanted, self._wanted_scene = self._wanted_scene, None
            if wanted is not None and wanted.hash != self._hash:
                self._switch(wanted)
            with self._changed:
                requests = self._saving.take()
                added, self._added = self._added, []
                due = None if self._schedule is None else self._schedule.pop(time.monotonic())
            for text in added:
                self._add(text)
            for request in requests:
                self._answer(request)
            if due is not None:
                self._draw(due)
        with self._changed:
            for request in self._saving.take():
                request.done.set()

    def _close(self, stop: Stop) -> None:
        """Draws the rest of the film, within FINISH_TIMEOUT after Ctrl-C, and frees the device."""
        self._publishing.shutdown()
        try:
            if self._schedule is not None:
                self._draw_film(self._schedule, stop)
        finally:
            try:
                if made := self._reel.close():
                    print(f"drone_render: {made}", flush=True)
            except FilmError as error:
                print(f"drone_render: {error}", flush=True)
            if self._renderer is not None:
                self._renderer.release()
            self._graphics.release()

    def _draw_film(self, schedule: Schedule, stop: Stop | None = None) -> None:
        """Draws the remaining pictures of the film, if there is one."""
        until = np.inf
        while self._reel.path and time.monotonic() < until and (due := schedule.pop(np.inf)):
            due.live = False
            self._draw(due)
            if stop is not None and stop.interrupted and until == np.inf:
                until = time.monotonic() + FINISH_TIMEOUT

    def _switch(self, message: SceneMessage) -> None:
        """Changes to the scene of a message; keeps the old one if the new one cannot be drawn."""
        with self._changed:
            old_schedule, self._schedule = self._schedule, None
        try:
            scene = scenes.load(message.uri)
            renderer = Renderer(scene, self._graphics)
        except ValueError as error:
            self.get_logger().error(f"scene: {error}")
            with self._changed:
                self._schedule = old_schedule
                self._early.clear()
                if self._wanted_camera and old_schedule is not None:
                    self._select(self._wanted_camera)
            return
        if scene.hash != message.hash:
            self.get_logger().warning(f"scene: {message.uri}: has changed since the simulation loaded it")
        if old_schedule is not None:
            self._draw_film(old_schedule)
        old = self._renderer
        film = float(self._reel.rate) if self._reel.path else None
        hierarchy = renderer.hierarchy
        self._published.result()
        for publisher in self._cameras.values():
            publisher.close()
        with self._changed:
            self._renderer, self._hash = renderer, message.hash
            self._schedule = Schedule(hierarchy.names, hierarchy.start, scene.rates.physics, scene.rates.draw, film)
            for state in self._early:
                self._schedule.push(state.stamp_ns, state.children, state.poses, time.monotonic())
            self._early.clear()
            self._cameras = {name: CameraPublisher(self, name, camera) for name, camera in scene.cameras.items()}
            self._selected = next(iter(self._cameras), "")
            if self._wanted_camera:
                self._select(self._wanted_camera)
        if old is not None:
            old.release()
        self._tf_static.publish(static_transforms(scene.cameras))
        self._names.publish(String(data="".join(f"{i}: {name}\n" for i, name in enumerate(scene.objects, 1))))
        self.get_logger().info(f"scene {scene.name}: cameras {', '.join(scene.cameras) or 'none'}")

    def _add(self, text: str) -> None:
        """Adds cameras from YAML as under `cameras` of a scene; invalid text changes nothing."""
        if self._renderer is None:
            self.get_logger().error("camera/add: there is no scene yet")
            return
        old = self._renderer.scene.cameras
        try:
            self._renderer.set_cameras(self._renderer.scene.with_cameras(text))
        except ValueError as error:
            self.get_logger().error(f"camera/add: {error}")
            return
        cameras = self._renderer.scene.cameras
        changed = {name: camera for name, camera in cameras.items() if camera is not old.get(name)}
        self._published.result()
        with self._changed:
            for name, camera in changed.items():
                if name in self._cameras:
                    self._cameras[name].close()
                self._cameras[name] = CameraPublisher(self, name, camera)
                self.get_logger().info(f"camera/add: {'another' if name in old else 'a new'} camera '{name}'")
            self._selected = self._selected or next(iter(self._cameras), "")
        self._tf_static.publish(static_transforms(cameras))

    def _draw(self, due: Due) -> None:
        """Draws the cameras that have subscribers or are filmed, at one moment."""
        poses = due.moment.poses()
        for name, publisher in self._cameras.items():
            filmed = due.film and name == self._selected
            drawn = filmed or (due.live and publisher.needs_picture())
            if drawn:
                self._draw_picture(name, publisher, poses, due.moment.stamp, due.live)
            if filmed:
                self._add_to_film(publisher.picture)
            if due.live and publisher.needs_depth():
                self._draw_depth(name, publisher, poses, due.moment.stamp, published=drawn)

    def _draw_picture(self, name: str, publisher: CameraPublisher, poses: Floats, stamp: int, live: bool) -> None:
        """Draws one picture and, if it is live, publishes it."""
        assert self._renderer is not None
        start = time.perf_counter()
        self._debug.show(self._renderer, poses)
        picture = publisher.picture
        matrix = self._renderer.draw_into(picture.pixels, name, poses, stamp / SECOND)
        with self._changed:
            publisher.seconds += time.perf_counter() - start
            publisher.drawn += 1
            self._drawn += 1
        if live:
            self._published.result()
            self._published = self._publishing.submit(publisher.publish, stamp, matrix, picture.message(stamp))

    def _draw_depth(self, name: str, publisher: CameraPublisher, poses: Floats, stamp: int, published: bool) -> None:
        """Draws and publishes depth and labels; published: whether the camera's transform is published already."""
        assert self._renderer is not None
        depth, labels = publisher.depth, publisher.labels
        camera = self._renderer.measure_into(depth.pixels, labels.pixels, name, poses, stamp / SECOND)
        matrix = None if published else camera
        messages = depth.message(stamp), labels.message(stamp)
        self._published.result()
        self._published = self._publishing.submit(publisher.publish_depth, stamp, matrix, *messages)

    def _add_to_film(self, picture: ImageMessage) -> None:
        """Adds a picture to the film; after an error no film is made."""
        try:
            self._reel.add(picture.size, picture.pixels.tobytes())
        except FilmError as error:
            self.get_logger().error(f"film: {error}; no film is made")
            with self._changed:
                if self._schedule is not None:
                    self._schedule.end_film()

    def _answer(self, request: Request) -> None:
        """Draws the latest state for a call of ~/save_image."""
        if self._schedule is not None and self._selected:
            with self._changed:
                state, name = self._schedule.history.latest, self._selected
            publisher = self._cameras[name]
            self._draw_picture(name, publisher, state.poses, state.stamp, live=False)
            request.image = PillowImage.fromarray(publisher.picture.pixels.copy())
            request.name = f"{name}_{state.stamp / SECOND:.3f}.png"
        request.done.set()


def main(args: list[str] | None = None) -> int:
    """Runs the node until a signal ends it; returns the exit status."""
    sys.setswitchinterval(SWITCH_INTERVAL)
    return run("drone_render", lambda stop: RenderNode(), args, context.ContextError, SceneError, work=RenderNode.run)


if __name__ == "__main__":
    sys.exit(main())
