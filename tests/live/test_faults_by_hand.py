"""Faults by hand on a mission that runs: in its log as what they were, and repeated by their lines."""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from onehop.analysis.difference import compare
from onehop.analysis.log import open_log
from onehop.checking import judge
from onehop.contracts import topics
from onehop.contracts.fault_section import KINDS, FaultSection, in_toml
from onehop.drivers.replay import replay
from onehop.mission.injection import inject
from onehop.mission.rendezvous import FILE, way_into
from onehop.node.bus import open_client
from onehop.wire.log_reader import LogFile, digest
from tests.live.mission import Mission, gone
from tests.onehop.scenes import field, log_of

pytestmark = pytest.mark.live

SLOWLY = ("robot.leader_speed=0.05",)


@pytest.fixture(autouse=True)
def _own_list(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "runtime"))


@pytest.fixture
def mission(tmp_path: Path) -> Mission:
    """One that lasts as long as tests need it: its leader creeps."""
    running = Mission(tmp_path, *SLOWLY, "clock.limit_s=600")
    running.await_ticks()
    return running


def onehop(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "onehop", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def ended(mission: Mission) -> LogFile:
    """The log of a mission that is stopped now; it happens again, and every promise held."""
    mission.stop()
    log = LogFile(mission.out / "mission.mcap")
    report = replay(log)
    assert (report.divergences, report.flaws) == (0, [])
    assert judge(log).violations == ()
    return log


def repeated(folder: Path, log: LogFile, lines: str, path: Path) -> str:
    """Digest of the same mission in one process, with faults written down, as long as the log is."""
    assert log.summary is not None
    limit_s = log.summary["ticks"] * 0.05
    return log_of(field(folder, *SLOWLY, f"clock.limit_s={limit_s}", f"faults=[{lines}]"), path)


ORDERS = [
    FaultSection("hold", robots=(3,), duration_s=0.5),
    FaultSection("stop", robots=(4, 1)),
    FaultSection("blind", robots=(2,), duration_s=1.0),
    FaultSection("slow", robots=(3,), delay_ticks=7, duration_s=2.0),
    FaultSection("continue", robots=(4,)),
    FaultSection("cut", robots=(4,), others=(2,), direction="from"),
    FaultSection("corrupt", probability=0.5, duration_s=3.0),
    FaultSection("jam", x=8.0, y=8.0, radius=3.0, duration_s=1.0),
    FaultSection("restart", robots=(1,)),
    FaultSection("kidnap", robots=(3,), x=30.0, y=8.0, heading_deg=-45.0),
    FaultSection("kill", robots=(2,)),
    FaultSection("heal"),
]


def test_what_is_done_by_hand_is_what_the_same_lines_in_the_scenario_do(
    mission: Mission, tmp_path: Path
) -> None:
    assert {order.kind for order in ORDERS} == set(KINDS)
    way_in = way_into(mission.out)
    begun = [inject(way_in, order) for order in ORDERS]
    assert [answer.refusal for answer in begun] == [""] * len(ORDERS)
    log = ended(mission)
    lines = ", ".join(in_toml(answer.fault) for answer in begun)
    assert repeated(tmp_path, log, lines, tmp_path / "again.mcap") == digest(log)
    repeated(tmp_path, log, "", tmp_path / "quiet.mcap")
    found = compare(open_log(tmp_path / "out" / "mission.mcap"), open_log(tmp_path / "quiet.mcap"))
    assert found.first is not None
    assert (found.first.tick, found.first.channel) == (begun[0].tick, "/wire/truth")


def test_the_command_does_it_and_prints_the_line_that_repeats_it(
    mission: Mission, tmp_path: Path
) -> None:
    """With one mission there is no need to name it; a killed robot's process is killed indeed."""
    pid = mission.children()["robot_agent 3"]
    done = onehop("fault", "kill", "3", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert told["kind"] == "kill"
    assert (told["robots"], told["mission"]) == ([3], str(mission.out))
    assert gone([pid])
    refused = onehop("fault", "kill", "3", "--mission", str(mission.out))
    assert refused.returncode == 2
    assert refused.stderr == (
        "onehop: fault kill: robots: robot 3 does not take part any more; one of 1, 2, 4\n"
    )
    log = ended(mission)
    line = told["scenario"].removeprefix("faults = [").removesuffix("]")
    assert repeated(tmp_path, log, line, tmp_path / "again.mcap") == digest(log)
    assert not (mission.out / FILE).exists()
    assert onehop("fault", "kill", "1").stderr.startswith("onehop: fault: no mission runs; ")


REFUSED = [
    (FaultSection("hold", robots=(9,)), "robots: robot 9 is not in the team"),
    (FaultSection("continue", robots=(2,)), "robots: robot 2 is not stopped; one of nobody"),
    (FaultSection("kidnap", robots=(2,), x=20.0, y=26.0), "x, y: .* the nearest free point is"),
    (FaultSection("hold", robots=(2,), duration_s=math.nan), "duration_s: nan is out of range"),
    (FaultSection("kill"), "robots: kill of nobody"),
    (FaultSection("kill", on="formed"), "at_s: at_s and on at once"),
]


def test_orders_that_cannot_be_carried_out_are_refused_and_leave_no_trace(
    mission: Mission, tmp_path: Path
) -> None:
    way_in = way_into(mission.out)
    for order, said in REFUSED:
        assert re.match(said, inject(way_in, order).refusal), order
    log = ended(mission)
    assert repeated(tmp_path, log, "", tmp_path / "quiet.mcap") == digest(log)


def test_the_injector_may_order_faults_and_nothing_else(mission: Mission) -> None:
    """Neither does its password show in the process table."""
    way_in = way_into(mission.out)
    for pid in mission.children().values():
        assert way_in.password not in Path(f"/proc/{pid}/cmdline").read_text()
    with open_client(way_in.mission, way_in.endpoint, topics.INJECTOR, way_in.identity()) as bus:
        bus.publisher(topics.by(topics.OPERATOR, topics.CONTROL))(b"stop")
        bus.publisher(topics.to(topics.robot_name(3), topics.KILL))(b"")
        bus.publisher(topics.by(topics.INJECTOR, topics.FAULT))(b"garbage")
        bus.publisher(topics.by(topics.INJECTOR, "nonsense"))(b"")
        assert bus.ask(topics.config(topics.RECORDER), 0.5) is None
    answer = inject(way_in, FaultSection("hold", robots=(3,), duration_s=0.1))
    assert answer.refusal == ""
    assert len(mission.children()) == 7
    ended(mission)
