"""The service that saves a picture: a call waits until the drawing thread has drawn one."""

import threading
from dataclasses import dataclass, field
from pathlib import Path

from PIL import Image
from rclpy.node import Node
from std_srvs.srv import Trigger

TIMEOUT = 5.0  # s, for a call of the service


@dataclass
class Request:
    """A call that waits for a picture of the selected camera."""

    done: threading.Event = field(default_factory=threading.Event)
    image: Image.Image | None = None
    name: str = ""  # of the file


class SaveImage:
    """The service ~/save_image: writes a PNG into `folder` and answers with its path.

    changed: guards `waiting`, and is notified when a call has come.
    """

    def __init__(self, node: Node, folder: Path, changed: threading.Condition) -> None:
        self.waiting: list[Request] = []
        self._folder = folder
        self._changed = changed
        node.create_service(Trigger, "~/save_image", self._on_save_image)

    def take(self) -> list[Request]:
        """Removes and returns the waiting calls; the caller has to set `done` of each."""
        requests, self.waiting = self.waiting, []
        return requests

    def _on_save_image(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        request = Request()
        with self._changed:
            self.waiting.append(request)
            self._changed.notify()
        if not request.done.wait(TIMEOUT) or request.image is None:
            response.message = "nothing to save: no scene with a camera has been drawn yet"
            return response
        path = self._folder / request.name
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            request.image.save(path)
        except OSError as error:
            response.message = f"{path}: {error.strerror}"
            return response
        response.success, response.message = True, str(path)
        return response
