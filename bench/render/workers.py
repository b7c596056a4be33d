"""Renderers compared by bench.render, each in its own process: `python -m bench.render.workers NAME` waits for orders.

An order is a line of JSON, and so is its answer: {"size": [w, h]} makes ready, {"draw": n, "from": k} draws n pictures
and tells the s it took, {"save": k, "path": p} draws one and writes it, {"about": true} tells who it is.
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
    """One who can draw the scene. `about` says how: lights, samples, what is read back."""

    about: str

    def size(self, width: int, height: int) -> Callable[[float], Bytes]:
        """What draws the picture of a number, (height, width, 3)."""


class Worker:
    """A process that draws; it starts while others do, and whoever asks first waits for it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._process = subprocess.Popen([sys.executable, "-m", "bench.render.workers", name], cwd=ROOT, text=True,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def about(self) -> str:
        """How it draws."""
        return str(self.ask(about=True))

    def ask(self, **order: Any) -> Any:
        """Gives an order and waits for the answer. Raises RuntimeError with its last line if the process has ended."""
        assert self._process.stdin and self._process.stdout and self._process.stderr
        try:
            self._process.stdin.write(json.dumps(order) + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            pass
        for line in self._process.stdout:  # libraries talk, too
            if line.startswith("answer "):
                return json.loads(line.removeprefix("answer "))
        raise RuntimeError(([*self._process.stderr] or ["ended without a word"])[-1].strip())

    def draw(self, count: int, first: int) -> tuple[float, float]:
        """s of wall and of CPU time that so many pictures take."""
        wall, cpu = self.ask(draw=count, first=first)
        return float(wall), float(cpu)

    def close(self) -> None:
        """Ends the process."""
        self._process.kill()
        self._process.communicate()


def main() -> None:
    module, _, mode = PEERS[sys.argv[1]].partition(":")
    drawer: Drawer = importlib.import_module(f"bench.render.{module}").Drawer(*([mode] if mode else []))
    frame: Callable[[float], Bytes] | None = None
    for line in sys.stdin:
        order = json.loads(line)
        answer: Any = drawer.about
        if "size" in order:
            frame = drawer.size(*order["size"])
            pixels = np.asarray(frame(0))
            assert pixels.shape == (order["size"][1], order["size"][0], 3) and pixels.dtype == np.uint8, pixels.shape
            answer = float(pixels.std())
        elif "draw" in order:
            assert frame is not None
            wall, cpu = time.perf_counter(), time.process_time()
            for k in range(order["first"], order["first"] + order["draw"]):
                frame(k)
            answer = time.perf_counter() - wall, time.process_time() - cpu
        elif "save" in order:
            assert frame is not None
            save(np.ascontiguousarray(frame(order["save"])), Path(order["path"]))
        print("answer " + json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
