"""A film of a mission as GIF or MP4."""

from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from PIL import Image

from onehop.analysis.film_frames import TRAIL_ALPHA, FilmFrames, Pixels
from onehop.analysis.log import Log
from onehop.analysis.palette import rgb, robot_colours
from onehop.contracts.errors import InputError

FRAMES_PER_S = 20
"""Frames a second of film."""

SPEED_UP = 8.0
"""Simulated seconds in a second of film."""

GIF_EVERY = 2
"""A GIF takes every second frame only: 10 a second, which every viewer can show."""


def write_film(log: Log, path: Path) -> None:
    """Write a film; the suffix says the format, .gif or .mp4.

    Raises InputError for another suffix, for mp4 without imageio-ffmpeg (the extra `film`), and for a
    log without a tick.
    """
    if path.suffix == ".gif":
        _write_gif(log, path)
    elif path.suffix == ".mp4":
        _write_mp4(log, path)
    else:
        raise InputError(f"film {path}", "is neither .gif nor .mp4", "choose one of them")


def _frames(film: FilmFrames, every: int) -> Iterator[Pixels]:
    """Each `every`-th frame of the film, the last moment included."""
    return film.frames(SPEED_UP * every / FRAMES_PER_S)


def _write_gif(log: Log, path: Path) -> None:
    """One palette for the whole film, so that no colour flickers."""
    frames = (Image.fromarray(pixels) for pixels in _frames(FilmFrames(log), GIF_EVERY))
    first = next(frames)
    palette = _with_swatches(first, log.robots).quantize(colors=255)
    pages = (
        frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in chain((first,), frames)
    )
    next(pages).save(
        path, save_all=True, append_images=pages, duration=1000 * GIF_EVERY // FRAMES_PER_S, loop=0
    )


def _with_swatches(frame: Image.Image, robots: tuple[int, ...]) -> Image.Image:
    """The frame with a stripe of every colour of the team, full and as faint as a trail."""
    sheet = frame.copy()
    stripe = max(1, frame.height // (4 * len(robots)))
    for number, colour in enumerate(robot_colours(robots).values()):
        full = np.array(rgb(colour))
        for part, tone in enumerate((full, TRAIL_ALPHA * full + (1.0 - TRAIL_ALPHA))):
            ink = tuple(round(255 * float(value)) for value in tone)
            top = (2 * number + part) * stripe
            sheet.paste(ink, (0, top, frame.width, top + stripe))
    return sheet


def _write_mp4(log: Log, path: Path) -> None:
    try:
        import imageio_ffmpeg
    except ImportError:
        raise InputError(
            "--film mp4", "needs imageio-ffmpeg", "pip install 'onehop[film]', or --film gif"
        ) from None
    film = FilmFrames(log)
    writer = imageio_ffmpeg.write_frames(
        str(path), film.size, fps=FRAMES_PER_S, macro_block_size=2, quality=7,
        output_params=["-movflags", "+faststart"],
    )  # fmt: skip
    writer.send(None)
    for pixels in _frames(film, 1):
        writer.send(np.ascontiguousarray(pixels))
    writer.close()
