"""Films: MP4 through PyAV or GIF through Pillow, encoded beside the drawing."""

import queue
import threading
from collections.abc import Callable, Iterator
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from PIL import Image

GIF_RATE = 50  # pictures a second; what comes faster, viewers show at a tenth of a second each
WAITING = 16  # frames that may wait for the encoder; beyond, drawing waits, as a film never drops any


class FilmError(ValueError):
    """What is wrong with a film, in one line."""


class Film:
    """A film of RGB pictures of one size, `rate` a second. Its file can be played once it is closed.

    Raises FilmError for an ending other than .mp4 and .gif and for a file that cannot be written.
    """

    def __init__(self, path: Path, size: tuple[int, int], rate: int) -> None:
        encoders: dict[str, Callable[[], None]] = {".mp4": self._mp4, ".gif": self._gif}
        if path.suffix not in encoders:
            raise FilmError(f"{path}: films end in .mp4 or .gif")
        if path.suffix == ".gif" and rate > GIF_RATE:
            raise FilmError(f"{path}: a GIF has at most {GIF_RATE} pictures a second, not {rate}")
        if path.suffix == ".mp4" and (size[0] % 2 or size[1] % 2):
            raise FilmError(f"{path}: an MP4 needs an even width and height, not {size[0]}x{size[1]}")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.open("wb").close()
        except OSError as error:
            raise FilmError(f"{path}: {error.strerror}") from None
        self.path, self.size, self.frames = path, size, 0
        self._rate = rate
        self._queue: queue.Queue[bytes | None] = queue.Queue(WAITING)
        self._error: Exception | None = None
        self._thread = threading.Thread(target=self._encode, args=(encoders[path.suffix],), name="film")
        self._thread.start()

    def add(self, pixels: bytes) -> None:
        """Takes one picture: rows from the top, width x 3 bytes each. Raises FilmError if encoding has failed; the
        film is closed then."""
        if self._error is not None:
            self.close()
        self._queue.put(pixels)
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
        except Exception as error:  # of a codec, a disk: whoever adds next is told
            self._error = error
            for _ in self._pictures():  # nobody may wait for a full queue
                pass

    def _pictures(self) -> Iterator[bytes]:
        return iter(self._queue.get, None)

    def _mp4(self) -> None:
        width, height = self.size
        # In fragments of a second, so that what is there can be played even if the process is killed.
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
        # Pillow keeps all frames until the end, so they are kept with 256 colours each.
        images = [Image.frombytes("RGB", self.size, pixels).quantize(256) for pixels in self._pictures()]
        if images:
            ends = np.round(100 * np.arange(len(images) + 1) / self._rate)  # a GIF counts in hundredths of a second
            durations = (10 * np.diff(ends)).astype(int).tolist()
            images[0].save(self.path, save_all=True, append_images=images[1:], duration=durations, loop=0)


class Reel:
    """A film that begins with its first picture, and keeps the size of that; `path` is empty where none is made."""

    def __init__(self, path: str, rate: int) -> None:
        self.path, self.rate = path, rate
        self._film: Film | None = None

    def add(self, size: tuple[int, int], pixels: bytes) -> None:
        """Takes one picture of any size. Raises FilmError, after which none is made."""
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
        """Finishes the film, if there is one, and says what is in it. Raises FilmError."""
        if self._film is None:
            return ""
        self._film.close()
        return f"{self._film.frames} pictures in {self._film.path}"
