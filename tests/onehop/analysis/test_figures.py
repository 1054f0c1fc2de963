"""What figures are made from: colours, stretches of time, means; and that they are drawn."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from onehop.analysis.palette import rgb, robot_colours
from onehop.analysis.report.follower_chart import rolling_mean
from onehop.analysis.timeline import spans
from onehop.analysis.trajectory import draw_trajectory
from onehop.wire.log_reader import LogFile


def test_neighbouring_robots_are_easy_to_tell_apart() -> None:
    colours = [np.array(rgb(c)) for c in robot_colours(tuple(range(1, 25))).values()]
    for one, other in pairwise(colours):
        assert np.linalg.norm(one - other) > 0.2


def test_twenty_four_robots_have_twenty_four_colours() -> None:
    assert len(set(robot_colours(tuple(range(1, 25))).values())) == 24


def test_a_robot_keeps_its_colour_whoever_asks() -> None:
    assert robot_colours((3, 1, 2)) == robot_colours((1, 2, 3))


def test_stretches_of_equal_value_end_at_a_change_and_at_a_gap() -> None:
    times = np.array([0.0, 1.0, 2.0, 3.0, 9.0, 10.0])
    values = np.array(["a", "a", "b", "b", "b", "b"])
    found = [(s.start_s, s.end_s, s.what) for s in spans(times, values, gap_s=1.5)]
    assert found == [(0.0, 2.0, "a"), (2.0, 3.0, "b"), (9.0, 10.0, "b")]


def test_a_stretch_too_short_to_see_belongs_to_the_one_before() -> None:
    times = np.arange(0.0, 6.0, 0.5)
    values = np.array(["a"] * 5 + ["b"] + ["a"] * 6)
    found = spans(times, values, gap_s=0.75, shortest_s=1.0)
    assert [(s.start_s, s.end_s, s.what) for s in found] == [(0.0, 5.5, "a")]


@given(st.lists(st.sampled_from("abc"), min_size=1, max_size=40))
def test_stretches_cover_the_time_and_alternate(letters: list[str]) -> None:
    times = np.arange(len(letters)) * 0.1
    found = spans(times, np.array(letters), gap_s=0.15)
    assert found[0].start_s == times[0]
    assert found[-1].end_s == times[-1]
    for one, other in pairwise(found):
        assert one.end_s == other.start_s
        assert one.what != other.what


@given(st.lists(st.floats(-10, 10) | st.just(float("nan")), min_size=1, max_size=30))
def test_the_rolling_mean_is_the_mean_of_what_is_near(values: list[float]) -> None:
    times, series = np.arange(len(values)) * 1.0, np.array(values)
    found = rolling_mean(times, series, width_s=4.0)
    for time, value, mean in zip(times, series, found, strict=True):
        near = series[np.abs(times - time) <= 2.0]
        expected = np.nan if np.isnan(value) else np.nanmean(near)
        assert mean == pytest.approx(expected, abs=1e-9, nan_ok=True)


def test_the_trajectory_is_drawn_with_every_robots_colour(log_path: Path, tmp_path: Path) -> None:
    path = tmp_path / "trajectory.png"
    draw_trajectory(LogFile(log_path), path)
    with Image.open(path) as figure:
        pixels = np.asarray(figure.convert("RGB"), dtype=int)
    for colour in robot_colours((1, 2, 3, 4)).values():
        wanted = np.round(255 * np.array(rgb(colour)))
        assert (np.abs(pixels - wanted).max(axis=2) <= 2).sum() > 20
