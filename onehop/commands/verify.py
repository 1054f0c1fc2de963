"""`onehop verify`: is a robot's program deterministic, and is it fast enough."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

from onehop.analysis.difference import compare
from onehop.analysis.log import Log
from onehop.commands.output import emit_json, say
from onehop.commands.suspects import suspects
from onehop.contracts import topics
from onehop.contracts.briefings import robot_briefing
from onehop.contracts.errors import MissionError, ScenarioError
from onehop.contracts.fault_section import FaultSection
from onehop.contracts.messages import Inbox, Observation, percept
from onehop.contracts.printable import json_value, printable
from onehop.contracts.randomness import generator
from onehop.contracts.scenario import Scenario
from onehop.contracts.sections import ClockSection, GoalSection, MapSection, StartSection, TeamSection
from onehop.drivers.replay import Divergence, replay
from onehop.maps.map_file import load_map
from onehop.programs.find import check, find, search_in
from onehop.programs.host import Host, ProgramError
from onehop.scenario.as_toml import as_toml
from onehop.scenario.bundle import changed
from onehop.wire.codec import decode
from onehop.wire.log_reader import LogFile
from onehop.wire.output_folder import LOG
from world_server.core.placement import start_poses
from world_server.core.world import RESTARTED

SIDE_M, ROBOTS, LIMIT_S, RESTART_S = 24.0, 4, 10.0, 4.0
"""The missions: a square field with a block, a few robots, one of which is restarted."""

DRAWS = 50
"""Fields that are drawn until one has room for its start and its goal."""

PATIENCE_S = 300.0
"""Wall-clock time that one run may take [s]."""

WAYS = (("inline", "1"), ("inline", "2"), ("processes", "3"))
"""How a mission is run: the driver, and the seed of Python's hashes, which orders sets of texts."""


@dataclass(slots=True)
class Verdict:
    """What was found. how: between which runs the first difference lies. step_ms: of every step."""

    first: Divergence | None = None
    how: str = ""
    failures: list[str] = field(default_factory=list)
    step_ms: list[float] = field(default_factory=list)

    def percentile(self, share: float) -> float:
        return round(float(np.percentile(self.step_ms, share)), 4) if self.step_ms else 0.0


def verify(program: str, missions: int, seed: int, settings: Sequence[str], as_json: bool) -> int:
    """Try a program; exit status 1 if it is not what it should be. Raises InputError, MissionError."""
    search_in("")
    kind = find(program, "PROGRAM")
    drawn = [_mission(program, seed + number, settings) for number in range(missions)]
    check(drawn[0], "--set")
    verdict = Verdict()
    for scenario in drawn:
        with tempfile.TemporaryDirectory(prefix="onehop-verify-") as folder:
            _try(scenario, Path(folder), verdict)
        say(f"mission with seed {scenario.seed}: {'differs' if verdict.first else 'the same bytes'}")
        if verdict.first is not None:
            break
    period_ms = float(drawn[0].clock.period_ms)
    found = suspects(kind)
    if as_json:
        emit_json(
            {
                "program": program,
                "deterministic": verdict.first is None,
                "first": json_value(asdict(verdict.first)) if verdict.first else None,
                "how": verdict.how or None,
                "failures": verdict.failures,
                "step_ms_p50": verdict.percentile(50),
                "step_ms_p99": verdict.percentile(99),
                "period_ms": period_ms,
                "suspects": [{"line": line, "what": what} for line, what in found],
            }
        )
    else:
        _print(program, verdict, period_ms, found)
    sound = verdict.first is None and not verdict.failures
    return 0 if sound and verdict.percentile(99) <= period_ms else 1


def _mission(program: str, seed: int, settings: Sequence[str]) -> Scenario:
    """A small mission, drawn by its seed. Raises ScenarioError."""
    random = generator(seed, "verify")
    problem: ScenarioError | None = None
    for _ in range(DRAWS):
        x, y, start_y, goal_y = (float(round(value, 1)) for value in random.uniform(6.0, 16.0, 4))
        block = ((x, y), (x + 3.0, y), (x + 3.0, y + 3.0), (x, y + 3.0))
        scenario = Scenario(
            name=f"verify-{seed}",
            seed=seed,
            map=MapSection(width=SIDE_M, height=SIDE_M, obstacles=(block,)),
            start=StartSection(x=4.0, y=start_y),
            goal=GoalSection(x=SIDE_M - 3.0, y=goal_y),
            team=TeamSection(size=ROBOTS, program=program),
            clock=ClockSection(limit_s=LIMIT_S),
            faults=(FaultSection("restart", at_s=RESTART_S, robots=(1 + seed % ROBOTS,)),),
        )
        scenario = changed(scenario, settings)
        try:
            start_poses(scenario, load_map(scenario.map, {}))
        except ScenarioError as error:
            problem = error
        else:
            return scenario
    raise problem or ScenarioError("verify", "no mission was drawn", "another --seed")


def _try(scenario: Scenario, folder: Path, verdict: Verdict) -> None:
    """Run a mission in every way, compare its logs, and time its steps from one of them."""
    path = folder / "mission.toml"
    path.write_text(as_toml(scenario), encoding="utf-8")
    logs = [_run(path, folder / f"{n}", *way, verdict) for n, way in enumerate(WAYS)]
    first = logs[0]
    for log, how in zip(logs[1:], ("run again", "run as processes"), strict=True):
        _take(verdict, _difference(first, log), how)
    again = replay(LogFile(first), parts=False).first
    _take(verdict, again, "executed again from its log")
    verdict.step_ms += _step_ms(LogFile(first))


def _run(scenario: Path, out: Path, driver: str, hash_seed: str, verdict: Verdict) -> Path:
    """The log of one run. Raises MissionError."""
    quick = ["--json", "--no-view", "--no-figure"]
    words = ["run", str(scenario), "--driver", driver, *quick, "--out", str(out)]
    done = subprocess.run(
        [sys.executable, "-m", "onehop", *words],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
        env={**os.environ, "PYTHONHASHSEED": hash_seed},
    )
    if not done.stdout:
        raise MissionError((done.stderr.strip() or "the run said nothing").splitlines()[-1])
    log = out / LOG
    for why in Log(LogFile(log)).table("departures")["why"].tolist():
        if why not in (RESTARTED, *verdict.failures):
            verdict.failures.append(why)
    return log


def _take(verdict: Verdict, found: Divergence | None, how: str) -> None:
    """Keep the earliest difference."""
    if found is not None and (verdict.first is None or found.tick < verdict.first.tick):
        verdict.first, verdict.how = found, how


def _difference(a: Path, b: Path) -> Divergence | None:
    found = compare(Log(LogFile(a)), Log(LogFile(b))).first
    if found is None:
        return None
    robot = int(found.channel.rpartition("/")[2]) if found.channel[-1:].isdigit() else 0
    return Divergence(found.tick, found.channel, robot, found.field, found.a, found.b)


def _step_ms(log: LogFile) -> Iterator[float]:
    """How long each step takes, every robot fed from a log [ms]; what makes it start is not in it."""
    scenario = log.bundle.scenario
    hosts: dict[tuple[int, int], Host] = {}
    for tick in log.ticks():
        for robot in scenario.team.robots:
            seen, heard = tick.get(topics.obs(robot)), tick.get(topics.rx(robot))
            if seen is None or heard is None:
                continue
            now = decode(Observation, seen)
            me = robot, now.incarnation
            if me not in hosts:
                hosts[me] = Host(robot_briefing(scenario, *me))
            given = percept(now, decode(Inbox, heard))
            began = time.perf_counter()
            with suppress(ProgramError):
                hosts[me].step(given)
            yield 1e3 * (time.perf_counter() - began)


def _print(program: str, verdict: Verdict, period_ms: float, found: Sequence[tuple[int, str]]) -> None:
    if verdict.first is None:
        print(f"{program}: the same bytes every time, in one process and in many")
    else:
        one = verdict.first
        print(f"{program}: NOT deterministic")
        print(f"  {verdict.how}: tick {one.tick}, robot {one.robot}, {one.channel}: {one.field}")
        print(f"  {printable(str(one.recorded), 100)} against {printable(str(one.replayed), 100)}")
    for why in verdict.failures:
        print(f"  a robot was lost: {printable(why)}")
    p50, p99 = verdict.percentile(50), verdict.percentile(99)
    share = 100.0 * p99 / period_ms
    print(f"step  p50 {p50:.3f} ms, p99 {p99:.3f} ms: {share:.1f} % of a tick of {period_ms:g} ms")
    if found and verdict.first is not None:
        print("what it may depend on:")
        for line, what in found:
            print(f"  line {line}: {what}")
