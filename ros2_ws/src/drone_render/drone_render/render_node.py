"""The node that draws: follows the scene and the poses, publishes what its cameras see."""

import logging
import signal
import sys
import threading
import time
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from drone_interfaces.msg import Scene as SceneMessage
from PIL import Image as PillowImage
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from drone_engine.geometry import mesh
from drone_engine.scene import loading as scenes
from drone_render import context
from drone_render.debug_view import DebugView
from drone_render.diagnostics import diagnostics
from drone_render.film import FilmError, Reel
from drone_render.image import Picture
from drone_render.renderer import Renderer
from drone_render.saving import Request, SaveImage
from drone_render.schedule import Due, Schedule
from drone_render.shutter import Shutter, rigid_transforms
from drone_render.view import Array
from drone_sim.node.process import ENDS, PARAMETER_ERRORS, NodeLog
from drone_sim.wire.cdr import SECOND, Transforms, read_transforms

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
EARLY = 10_000  # states kept for a film while its scene is being loaded
SWITCH_INTERVAL = 0.0005  # s; Python's 5 ms would let the thread that draws wait for ROS a third of a picture's time
FINISH_WITHIN = 1.0  # s, for the pictures of a film that are left when all ends


class RenderNode(Node):
    """Draws in the thread that calls `run`; ROS calls back in another one, and leaves what it brings under a lock."""

    def __init__(self) -> None:
        super().__init__("drone_render")
        film = self._text("film", "", "film to make of the selected camera, .mp4 or .gif; none if empty")
        rate = self.declare_parameter(
            "film_rate", 30,
            ParameterDescriptor(description="pictures per simulated second of the film", read_only=True,
                                integer_range=[IntegerRange(from_value=1, to_value=240, step=1)]),
        ).get_parameter_value().integer_value  # fmt: skip
        self._reel = Reel(film, rate)
        self._wanted_camera = self._text("camera", "", "camera selected at the start; the scene's first if empty")
        image_dir = Path(self._text("image_dir", "out", "folder for the images that ~/save_image writes"))

        logging.getLogger("drone_sim").addHandler(NodeLog(self.get_logger()))  # what is wrong with models
        self._graphics = context.create()
        self.get_logger().info(f"drawing on {context.device_name(self._graphics)}")
        self._changed = threading.Condition()
        self._wanted_scene: SceneMessage | None = None
        self._added: list[str] = []
        self._schedule: Schedule | None = None
        # States that come while the scene is being loaded; a film begins with the first of them.
        self._early: deque[Transforms] = deque(maxlen=EARLY if film else 1)
        self._renderer: Renderer | None = None
        self._hash = ""
        self._selected = ""
        self._shutters: dict[str, Shutter] = {}
        self._drawn = 0
        self._publishing = ThreadPoolExecutor(1, "publish")  # beside the drawing of the next picture
        self._published: Future[None] = self._publishing.submit(lambda: None)

        self.create_subscription(SceneMessage, "scene", self._on_scene, LATCHED)
        self.create_subscription(TFMessage, "tf", self._on_tf, QoSProfile(depth=100), raw=True)
        self.create_subscription(String, "camera/select", self._on_select, LATCHED)
        self.create_subscription(String, "camera/add", self._on_add, 10)
        self._saving = SaveImage(self, image_dir, self._changed)
        self._debug = DebugView(self)
        self._names = self.create_publisher(String, "camera/labels", LATCHED)
        self._tf_static = self.create_publisher(TFMessage, "tf_static", LATCHED)
        self._diagnostics = self.create_publisher(DiagnosticArray, "diagnostics", 10)
        self.create_timer(1.0, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _text(self, name: str, default: str, description: str) -> str:
        descriptor = ParameterDescriptor(description=description, read_only=True)
        return str(self.declare_parameter(name, default, descriptor).value)

    # What ROS brings, in its own thread.

    def _on_scene(self, message: SceneMessage) -> None:
        with self._changed:
            self._wanted_scene = message
            self._changed.notify()

    def _on_tf(self, data: bytes) -> None:
        try:
            state = read_transforms(data)
        except ValueError as error:
            self.get_logger().warning(f"tf: {error}; left out", throttle_duration_sec=5.0)
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
        if self._schedule is None or (self._wanted_scene and self._wanted_scene.hash != self._hash):  # one is loading
            self._wanted_camera = name
        elif name in self._shutters:
            self._selected = self._wanted_camera = name
        else:
            known = ", ".join(self._shutters) or "none"
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
            times = [value for shutter in self._shutters.values() for value in shutter.report()]
            drawing = self._renderer is not None
        self._diagnostics.publish(diagnostics(context.device_name(self._graphics), drawing, now, values, times))

    # What draws, in the thread that owns the context.

    def run(self, stop: threading.Event) -> None:
        """Draws until `stop` is set."""
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
            requests = self._saving.take()
        for request in requests:
            request.done.set()

    def close(self, hurry: threading.Event) -> None:
        """Finishes the film with what is left of it, in FINISH_WITHIN s if in a hurry; gives the device back."""
        self._publishing.shutdown()
        try:
            if self._schedule is not None:
                self._draw_film(self._schedule, hurry)
        finally:
            try:
                if made := self._reel.close():
                    print(f"drone_render: {made}", flush=True)
            except FilmError as error:
                print(f"drone_render: {error}", flush=True)
            if self._renderer is not None:
                self._renderer.release()
            self._graphics.release()

    def _draw_film(self, schedule: Schedule, hurry: threading.Event | None = None) -> None:
        """Draws what is left of the film, if one is made."""
        until = np.inf
        while self._reel.path and time.monotonic() < until and (due := schedule.pop(np.inf)):
            due.live = False
            self._draw(due)
            if hurry is not None and hurry.is_set() and until == np.inf:
                until = time.monotonic() + FINISH_WITHIN

    def _switch(self, message: SceneMessage) -> None:
        """Changes to the scene of a message; if it cannot be drawn, the old one stays."""
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
            self.get_logger().warning(f"scene: {message.uri}: has changed since the simulation read it")
        if old_schedule is not None:
            self._draw_film(old_schedule)
        old = self._renderer
        film = float(self._reel.rate) if self._reel.path else None
        hierarchy = renderer.hierarchy
        self._published.result()
        for shutter in self._shutters.values():
            shutter.close()
        with self._changed:
            self._renderer, self._hash = renderer, message.hash
            self._schedule = Schedule(hierarchy.names, hierarchy.start, scene.rates.physics, scene.rates.draw, film)
            for state in self._early:
                self._schedule.push(state.stamp_ns, state.children, state.poses, time.monotonic())
            self._early.clear()
            self._shutters = {name: Shutter(self, name, camera) for name, camera in scene.cameras.items()}
            self._selected = next(iter(self._shutters), "")
            if self._wanted_camera:
                self._select(self._wanted_camera)
        if old is not None:
            old.release()
        self._tf_static.publish(rigid_transforms(scene.cameras))
        self._names.publish(String(data="".join(f"{i}: {name}\n" for i, name in enumerate(scene.objects, 1))))
        self.get_logger().info(f"scene {scene.name}: cameras {', '.join(scene.cameras) or 'none'}")

    def _add(self, text: str) -> None:
        """More cameras, as a scene words them; a broken word changes nothing."""
        if self._renderer is None:
            self.get_logger().error("camera/add: there is no scene yet")
            return
        old = self._renderer.scene.cameras
        try:
            self._renderer.adopt(self._renderer.scene.with_cameras(text))
        except ValueError as error:
            self.get_logger().error(f"camera/add: {error}")
            return
        cameras = self._renderer.scene.cameras
        changed = {name: camera for name, camera in cameras.items() if camera is not old.get(name)}
        self._published.result()
        with self._changed:
            for name, camera in changed.items():
                if name in self._shutters:
                    self._shutters[name].close()
                self._shutters[name] = Shutter(self, name, camera)
                self.get_logger().info(f"camera/add: {'another' if name in old else 'a new'} camera '{name}'")
            self._selected = self._selected or next(iter(self._shutters), "")
        self._tf_static.publish(rigid_transforms(cameras))

    def _draw(self, due: Due) -> None:
        poses = due.moment.poses()
        for name, shutter in self._shutters.items():
            filmed = due.film and name == self._selected
            taken = filmed or (due.live and shutter.watched())
            if taken:
                self._take(name, shutter, poses, due.moment.stamp, due.live)
            if filmed:
                self._expose(shutter.picture)
            if due.live and shutter.measured():
                self._measure(name, shutter, poses, due.moment.stamp, placed=taken)

    def _take(self, name: str, shutter: Shutter, poses: Array, stamp: int, live: bool) -> None:
        """Draws one picture and, if it is live, publishes it."""
        assert self._renderer is not None
        start = time.perf_counter()
        self._debug.show(self._renderer, poses)
        place = self._renderer.draw(name, poses, stamp / SECOND, shutter.picture)
        with self._changed:
            shutter.seconds += time.perf_counter() - start
            shutter.drawn += 1
            self._drawn += 1
        if live:
            self._published.result()
            self._published = self._publishing.submit(shutter.publish, stamp, place, shutter.picture.message(stamp))

    def _measure(self, name: str, shutter: Shutter, poses: Array, stamp: int, placed: bool) -> None:
        """Draws how far away everything is, and what it is; publishes both. placed: the camera's place is published."""
        assert self._renderer is not None
        place = self._renderer.measure(name, poses, stamp / SECOND, shutter.depth, shutter.labels)
        messages = shutter.depth.message(stamp), shutter.labels.message(stamp)
        self._published.result()
        self._published = self._publishing.submit(shutter.publish_ranges, stamp, None if placed else place, *messages)

    def _expose(self, picture: Picture) -> None:
        """Adds a picture to the film."""
        try:
            self._reel.add((picture.width, picture.height), picture.pixels())
        except FilmError as error:
            self.get_logger().error(f"film: {error}; no film is made")
            with self._changed:
                if self._schedule is not None:
                    self._schedule.end_film()

    def _answer(self, request: Request) -> None:
        """Draws the latest state for whoever waits."""
        if self._schedule is not None and self._selected:
            with self._changed:
                state, name = self._schedule.history.latest, self._selected
            picture = self._shutters[name].picture
            self._take(name, self._shutters[name], state.poses, state.stamp, live=False)
            request.image = PillowImage.frombytes("RGB", (picture.width, picture.height), picture.pixels())
            request.name = f"{name}_{state.stamp / SECOND:.3f}.png"
        request.done.set()


def main(args: list[str] | None = None) -> None:
    sys.setswitchinterval(SWITCH_INTERVAL)
    stop, hurry = threading.Event(), threading.Event()

    def end(number: int, _: object) -> None:
        """A signal only sets flags: what is being drawn or published is finished; after SIGTERM the film is, too."""
        stop.set()
        if number == signal.SIGINT:
            hurry.set()

    for number in ENDS:
        signal.signal(number, end)
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = RenderNode()
    except (context.ContextError, *PARAMETER_ERRORS) as error:
        rclpy.try_shutdown()
        sys.exit(f"drone_render: {error}")
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    spinning = ThreadPoolExecutor(1, "ros").submit(executor.spin)
    spinning.add_done_callback(lambda _: stop.set())  # a callback that failed ends the node
    try:
        mesh.prepare()  # the simulation takes longer to start, and nothing is known of the scene before
        node.run(stop)
        executor.shutdown(timeout_sec=FINISH_WITHIN)
        spinning.result()
    except ExternalShutdownException:
        pass
    finally:
        node.close(hurry)
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
