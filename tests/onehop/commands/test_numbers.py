"""Every number of the command line: what is none, or not of its unit, is one line and status 2."""

import signal
import sys

import pytest

from onehop.cli import main
from onehop.mission.stops import ENDS
from tests.onehop.scenes import field, log_of


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Files that are sound, so that only the number can be what is wrong."""
    folder = tmp_path_factory.mktemp("inputs")
    log_of(field(folder, "clock.limit_s=5"), folder / "mission.mcap")
    return {"SCENARIO": str(folder / "field.toml"), "LOG": str(folder / "mission.mcap")}


NO_NUMBERS = ("nan", "inf", "-inf", "1e400", "-1", "1e308", str(2**64), "9" * 5000, "", "x")

OPTIONS = [
    ("run SCENARIO", "--seed"),
    ("plan SCENARIO", "--seed"),
    ("plan SCENARIO", "--cell"),
    ("elect 1,2,4", "--spacing"),
    ("link", "--distance"),
    ("link", "--rate"),
    ("link", "--msdu"),
    ("link", "--seed"),
    ("link", "--seconds"),
    ("saturate", "--stations"),
    ("saturate", "--rate"),
    ("saturate", "--msdu"),
    ("saturate", "--seed"),
    ("saturate", "--seconds"),
    ("replay LOG", "--robot"),
    ("replay LOG", "--from"),
    ("replay LOG", "--to"),
    ("explain LOG --at 1", "--robot"),
    ("explain LOG --robot 1", "--at"),
    ("explain LOG --robot 1 --at 1", "--window"),
]


@pytest.mark.parametrize(("command", "option"), OPTIONS)
@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: value[:8] or "empty")
def test_what_is_no_number_of_its_unit_is_refused_in_one_line(
    inputs: dict[str, str], capsys: pytest.CaptureFixture[str], command: str, option: str, value: str
) -> None:
    words = [inputs.get(word, word) for word in command.split()]
    assert _exit_status([*words, option, value]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("onehop: ")
    assert told.err.count("\n") == 1
    assert option in told.err


@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: value[:8] or "empty")
@pytest.mark.parametrize("option", ["--start", "--goal"])
def test_a_point_has_two_numbers(
    inputs: dict[str, str], capsys: pytest.CaptureFixture[str], option: str, value: str
) -> None:
    assert _exit_status(["plan", inputs["SCENARIO"], f"{option}={value},2"]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def _exit_status(words: list[str]) -> object:
    """That of the command line, run in this process; signal handlers come back after it."""
    before = {number: signal.getsignal(number) for number in ENDS}
    try:
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(sys, "argv", ["onehop", *words])
            patch.setenv("MPLBACKEND", "agg")  # the command sets it, and leaves it set
            with pytest.raises(SystemExit) as end:
                main()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return end.value.code
