"""Films can be played, and contain every picture."""

import threading
from pathlib import Path

import av
import numpy as np
import pytest
from PIL import Image

from drone_render.film import Film, FilmError, Reel

SIZE = (64, 48)


def pictures(count: int) -> list[bytes]:
    """Gray pictures, each brighter than the one before."""
    return [np.full((SIZE[1], SIZE[0], 3), 20 + 8 * i, np.uint8).tobytes() for i in range(count)]


def test_an_mp4_has_all_pictures_in_order(tmp_path: Path) -> None:
    film = Film(tmp_path / "new" / "run.mp4", SIZE, 30)
    for pixels in pictures(20):
        film.add(pixels)
    film.close()
    with av.open(str(film.path)) as container:
        stream = container.streams.video[0]
        assert (stream.average_rate, stream.codec_context.pix_fmt) == (30, "yuv420p")
        grays = [frame.to_ndarray(format="rgb24").mean() for frame in container.decode(stream)]
    np.testing.assert_allclose(grays, [20 + 8 * i for i in range(20)], atol=3)


def test_a_gif_has_all_pictures(tmp_path: Path) -> None:
    film = Film(tmp_path / "run.gif", SIZE, 30)
    for pixels in pictures(15):
        film.add(pixels)
    film.close()
    with Image.open(film.path) as image:
        assert image.n_frames == 15 and image.size == SIZE  # type: ignore[attr-defined]
        durations = []
        for number in range(15):
            image.seek(number)
            durations.append(image.info["duration"])
    assert sum(durations) == 500  # ms, though none of them is 1000 / 30


def test_a_full_disk_ends_a_film_with_an_error(tmp_path: Path) -> None:
    (tmp_path / "run.mp4").symlink_to("/dev/full")
    noise = np.random.default_rng(1).integers(0, 255, (200, SIZE[1], SIZE[0], 3), np.uint8)
    reel = Reel(str(tmp_path / "run.mp4"), 5)
    with pytest.raises(FilmError, match=r"run\.mp4: "):
        for pixels in noise:
            reel.add(SIZE, pixels.tobytes())
    assert "film" not in {thread.name for thread in threading.enumerate()}
    assert reel.close() == ""


@pytest.mark.parametrize(("name", "size", "rate"), [
    ("run.avi", SIZE, 30), ("run.mp4", (63, 48), 30), ("taken/run.mp4", SIZE, 30), ("run.gif", SIZE, 60)])  # fmt: skip
def test_an_impossible_film_is_an_error_in_one_line(
    tmp_path: Path, name: str, size: tuple[int, int], rate: int
) -> None:
    (tmp_path / "taken").write_text("a file")
    with pytest.raises(FilmError) as caught:
        Film(tmp_path / name, size, rate)
    assert name in str(caught.value) or "taken" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_reel_keeps_the_size_of_its_first_picture(tmp_path: Path) -> None:
    reel = Reel(str(tmp_path / "run.gif"), 10)
    reel.add(SIZE, pictures(1)[0])
    reel.add((32, 24), bytes(32 * 24 * 3))
    assert reel.close() == f"2 pictures in {tmp_path / 'run.gif'}"
    with Image.open(tmp_path / "run.gif") as image:
        assert image.size == SIZE and image.n_frames == 2  # type: ignore[attr-defined]
    assert Reel("", 10).close() == ""
