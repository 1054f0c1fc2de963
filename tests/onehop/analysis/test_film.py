"""Films: as long as the mission, with robots that move."""

from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

from onehop.analysis import Log
from onehop.analysis.film import FRAMES_PER_S, GIF_EVERY, SPEED_UP, write_film
from onehop.contracts.errors import InputError


@pytest.mark.slow
def test_a_gif_plays_the_whole_mission_and_moves(log: Log, tmp_path: Path) -> None:
    path = tmp_path / "mission.gif"
    write_film(log, path)
    assert log.summary is not None
    expected = log.summary["sim_s"] / SPEED_UP * FRAMES_PER_S / GIF_EVERY
    with Image.open(path) as film:
        pages = [np.asarray(page.convert("RGB"), dtype=int) for page in ImageSequence.Iterator(film)]
    assert abs(len(pages) - expected) <= 2
    changed = [np.abs(one - other).max(axis=2) > 40 for one, other in pairwise(pages)]
    assert sum(mask.any() for mask in changed) > len(pages) // 2


def test_another_kind_of_film_is_refused(log: Log, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"neither \.gif nor \.mp4"):
        write_film(log, tmp_path / "mission.avi")


@pytest.mark.skipif(find_spec("imageio_ffmpeg") is not None, reason="the extra `film` is installed")
def test_mp4_without_its_library_says_what_to_install(log: Log, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"onehop\[film\]"):
        write_film(log, tmp_path / "mission.mp4")
