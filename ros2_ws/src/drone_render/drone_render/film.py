"""Films: MP4 through PyAV or GIF through Pillow, encoded in a thread of their own."""

import queue
import threading
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from PIL import Image

from drone_render.arrays import Bytes

MAX_GIF_RATE = 50  # pictures per second; viewers show faster GIFs at ten pictures per second
QUEUE_LENGTH = 16  # pictures that wait for the encoder at most; then `add` waits, as a film drops no picture


class FilmError(ValueError):
    """Why a film cannot be made, in one line."""


class Film:
    """A film of RGB pictures of one size.

    path: ends in .mp4 or .gif; size: width and height in pixels; rate: pictures per second. The file can be played once
    the film is closed. Raises FilmError for another suffix, a size or rate that the format does not allow, and a file
    that cannot be written.
    """

    def __init__(self, path: Path, size: tuple[int, int], rate: int) -> None:
        encoders: dict[str, Callable[[], None]] = {".mp4": self._mp4, ".gif": self._gif}
        if path.suffix not in encoders:
            raise FilmError(f"{path}: expected a file name that ends in .mp4 or .gif, got '{path.name}'")
        if path.suffix == ".gif" and rate > MAX_GIF_RATE:
            raise FilmError(f"{path}: expected at most {MAX_GIF_RATE} pictures per second for a GIF, got {rate}")
        if path.suffix == ".mp4" and (size[0] % 2 or size[1] % 2):
            raise FilmError(f"{path}: expected an even width and height for an MP4, got {size[0]}x{size[1]}")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.open("wb").close()
        except OSError as error:
            raise FilmError(f"{path}: {error.strerror}") from None
        self.path, self.size, self.frames = path, size, 0
        self._rate = rate
        self._queue: queue.Queue[bytes | None] = queue.Queue(QUEUE_LENGTH)
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._encode, args=(encoders[path.suffix],), name="film")
        self._thread.start()

    def add(self, pixels: bytes | Bytes) -> None:
        """Adds a picture: (height, width, 3) uint8, or its bytes, the top row first.

        Raises FilmError if encoding has failed; the film is closed then.
        """
        if self._error is not None:
            self.close()
        self._queue.put(bytes(pixels))
        self.frames += 1

    def close(self) -> None:
        """Waits for the encoder and finishes the file. Raises FilmError if encoding has failed."""
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join()
        if self._error is not None:
            raise FilmError(f"{self.path}: {self._error}")

    def _encode(self, encoder: Callable[[], None]) -> None:
        try:
            encoder()
        except Exception as error:  # of the codec or the disk; `add` and `close` raise it
            self._error = error
            for _ in self._pictures():  # empties the queue, so that `add` does not block
                pass

    def _pictures(self) -> Iterator[bytes]:
        return iter(self._queue.get, None)

    def _mp4(self) -> None:
        width, height = self.size
        # In fragments of one second, so that the file can be played even if the process is killed.
        options = {"movflags": "frag_keyframe+empty_moov+default_base_moof"}
        with av.open(str(self.path), "w", options=options) as container:
            stream = container.add_stream("libx264", rate=self._rate, options={"preset": "veryfast", "crf": "20"})
            stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
            stream.codec_context.gop_size = self._rate
            stream.codec_context.thread_count = 1  # the physics needs the other core
            stream.codec_context.time_base = Fraction(1, self._rate)
            for i, pixels in enumerate(self._pictures()):
                rows = np.frombuffer(pixels, np.uint8).reshape(height, width, 3)
                frame = av.VideoFrame.from_ndarray(rows, format="rgb24")
                frame.pts = i
                container.mux(stream.encode(frame))
            container.mux(stream.encode())

    def _gif(self) -> None:
        # Pillow keeps all pictures until the end; with 256 colors each they take a third of the memory.
        images = [Image.frombytes("RGB", self.size, pixels).quantize(256) for pixels in self._pictures()]
        if images:
            ends = np.round(100 * np.arange(len(images) + 1) / self._rate)  # GIF durations are multiples of 10 ms
            durations = (10 * np.diff(ends)).astype(int).tolist()
            images[0].save(self.path, save_all=True, append_images=images[1:], duration=durations, loop=0)


class Reel:
    """A film that is opened with its first picture, whose size it keeps; with an empty path no film is made."""

    def __init__(self, path: str, rate: int) -> None:
        self.path, self.rate = path, rate
        self._film: Film | None = None

    def add(self, size: tuple[int, int], pixels: bytes) -> None:
        """Adds a picture of any size (width, height), as bytes. Raises FilmError, and then makes no film."""
        try:
            if self._film is None:
                self._film = Film(Path(self.path), size, self.rate)
            if size != self._film.size:
                pixels = Image.frombytes("RGB", size, pixels).resize(self._film.size).tobytes()
            self._film.add(pixels)
        except FilmError:
            self.path, self._film = "", None
            raise

    def close(self) -> str:
        """Finishes the film, and returns a description of it; empty if there is none. Raises FilmError."""
        if self._film is None:
            return ""
        self._film.close()
        return f"{self._film.frames} pictures in {self._film.path}"
