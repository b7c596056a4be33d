"""The renderers of bench.render, each in its own process: `python -m bench.render.workers NAME` waits for requests.

A request is a line of JSON and has a line of JSON as its answer: {"size": [w, h]} prepares, {"draw": n, "first": k}
draws n pictures from number k on and returns their time in s, {"save": k, "path": p} draws a picture and writes it,
{"about": true} returns the description.
"""

import importlib
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from bench import ROOT
from bench.render.scene import Bytes, save

PEERS = {
    "ours": "draw_ours",
    "ours, edges smoothed": "draw_ours:smooth",
    "plain moderngl loop": "draw_plain",
    "Panda3D tinydisplay": "draw_panda3d:tiny",
    "Panda3D EGL": "draw_panda3d:gl",
    "MuJoCo": "draw_mujoco:0",
    "MuJoCo, 4 samples": "draw_mujoco:4",
    "PyBullet EGL": "draw_pybullet:egl",
    "PyBullet TinyRenderer": "draw_pybullet:tiny",
}


class Drawer(Protocol):
    """A renderer of the scene; about: lights, samples and what is read back."""

    about: str

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """Prepares for pictures of this size; returns the function that draws picture k, (height, width, 3)."""


class Worker:
    """A drawing process. It starts in the background; the first request waits for it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._process = subprocess.Popen([sys.executable, "-m", "bench.render.workers", name], cwd=ROOT, text=True,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def about(self) -> str:
        """The renderer's description."""
        return str(self.ask(about=True))

    def ask(self, **request: Any) -> Any:
        """Sends a request and waits for the answer.

        Raises RuntimeError with the last line of stderr if the process has ended.
        """
        assert self._process.stdin and self._process.stdout and self._process.stderr
        try:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass
        for line in self._process.stdout:  # skips output of the libraries
            if line.startswith("answer "):
                return json.loads(line.removeprefix("answer "))
        raise RuntimeError(([*self._process.stderr] or ["ended without a message"])[-1].strip())

    def draw(self, count: int, first: int) -> tuple[float, float]:
        """Wall and CPU time in s of `count` pictures."""
        wall, cpu = self.ask(draw=count, first=first)
        return float(wall), float(cpu)

    def close(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.communicate()


def main() -> None:
    """Serves requests from stdin for the renderer named in the arguments."""
    module, _, mode = PEERS[sys.argv[1]].partition(":")
    drawer: Drawer = importlib.import_module(f"bench.render.{module}").Drawer(*([mode] if mode else []))
    frame: Callable[[float], Bytes] | None = None
    for line in sys.stdin:
        request = json.loads(line)
        answer: Any = drawer.about
        if "size" in request:
            frame = drawer.size(*request["size"])
            pixels = np.asarray(frame(0))
            width, height = request["size"]
            assert pixels.shape == (height, width, 3) and pixels.dtype == np.uint8, pixels.shape
            answer = float(pixels.std())
        elif "draw" in request:
            assert frame is not None
            wall, cpu = time.perf_counter(), time.process_time()
            for k in range(request["first"], request["first"] + request["draw"]):
                frame(k)
            answer = time.perf_counter() - wall, time.process_time() - cpu
        elif "save" in request:
            assert frame is not None
            save(np.ascontiguousarray(frame(request["save"])), Path(request["path"]))
        print("answer " + json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
