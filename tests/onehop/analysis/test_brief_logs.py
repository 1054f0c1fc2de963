"""Logs that ended as soon as they began: nothing to show is no reason to fail."""

from pathlib import Path

import pytest

from onehop.analysis import open_log
from onehop.analysis.difference import compare
from onehop.analysis.explanation import explain
from onehop.analysis.film import write_film
from onehop.analysis.report.page import write_report
from onehop.analysis.salvage import salvage
from onehop.analysis.trajectory import draw_trajectory
from onehop.analysis.view.layer import write_view
from onehop.contracts.errors import InputError
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LogWriter


@pytest.fixture(params=[0, 1], ids=["no tick", "one tick"])
def brief(request: pytest.FixtureRequest, log_path: Path, tmp_path: Path) -> Path:
    """A log with the first ticks of the small mission, torn after them."""
    source = LogFile(log_path)
    whole, torn = tmp_path / "whole.mcap", tmp_path / "brief.mcap"
    writer = LogWriter(whole, source.bundle, "inline")
    for tick, _ in zip(source.ticks(), range(request.param), strict=False):
        writer.write(tick.tick, tick.messages)
    writer.flush()
    torn.write_bytes(whole.read_bytes())
    writer.close(None)
    return torn


def test_the_trajectory_is_drawn(brief: Path, tmp_path: Path) -> None:
    draw_trajectory(LogFile(brief), tmp_path / "trajectory.png")
    assert (tmp_path / "trajectory.png").stat().st_size > 1000


@pytest.mark.slow
def test_the_report_says_that_the_log_ends_early(brief: Path, tmp_path: Path) -> None:
    page = write_report(open_log(brief), tmp_path / "report").page
    assert "the log ends after 0 s" in page.read_text()


def test_the_film_has_a_picture_at_most(brief: Path, tmp_path: Path) -> None:
    if not list(open_log(brief).truths()):
        with pytest.raises(InputError, match="not one tick"):
            write_film(open_log(brief), tmp_path / "film.gif")
        return
    write_film(open_log(brief), tmp_path / "film.gif")
    assert (tmp_path / "film.gif").stat().st_size > 1000


def test_the_viewer_layer_is_written(brief: Path, tmp_path: Path) -> None:
    write_view(open_log(brief), tmp_path / "view.mcap")
    assert not open_log(tmp_path / "view.mcap").torn


def test_it_is_saved_and_compared(brief: Path, tmp_path: Path) -> None:
    salvage(brief, tmp_path / "saved.mcap")
    found = compare(open_log(brief), open_log(tmp_path / "saved.mcap"))
    assert found.first is None
    assert found.same == (found.ticks > 0)


def test_a_moment_that_it_does_not_hold_is_refused(brief: Path) -> None:
    with pytest.raises(InputError):
        explain(open_log(brief), 1, 5.0)
