"""Logs: damaged bytes, damaged chunks, forged messages; every way to read one."""

from pathlib import Path
from random import Random

from onehop.analysis import open_log
from onehop.analysis.columns import TABLES
from onehop.analysis.derived import DERIVED
from onehop.contracts.errors import OnehopError
from tests.fuzz.commands import call
from tests.onehop.log_forms import CHUNK_DAMAGES, FORMS, mutated, ticks_of, with_extreme, write_form
from tests.onehop.scenes import field, log_of


def record(path: Path) -> None:
    """Write the log of a short mission in which much happens."""
    faults = "faults=[{kind='kill', at_s=0.5, robots=[2]}, {kind='hold', at_s=0.2, robots=[1]}]"
    settings = ("clock.limit_s=1.5", "team.next_period=0.2", "team.leader_timeout=0.4", faults)
    log_of(field(path.parent, *settings), path)


class Logs:
    """Logs made of a recorded one."""

    def __init__(self, recorded: Path) -> None:
        self._recorded = recorded

    def make(self, folder: Path, random: Random) -> None:
        """Write mutant.mcap, and in `choices` what is asked of it."""
        path = folder / "mutant.mcap"
        self._mutant(path, random)
        (folder / "choices").write_text(f"{random.random()}")

    def read(self, folder: Path) -> None:
        """Run every command that reads logs, and build every table. Raises the first refusal."""
        path, recorded = folder / "mutant.mcap", self._recorded
        random = Random((folder / "choices").read_text())
        commands: list[tuple[object, ...]] = [
            ("replay", path),
            ("replay", path, "--robot", 3, "--json", "--from", 0.5),
            ("check", path),
            ("check", path, "--json"),
            ("explain", path, "--robot", random.choice((1, 2, 3, 4)), "--at", 0.9),
            ("explain", path, "--robot", random.choice((1, 2, 3, 4)), "--at", 1.2, "--json"),
            ("diff", path, recorded),
            ("diff", recorded, path, "--json"),
            ("salvage", path, "-o", folder / "saved.mcap"),
            ("view", path, "-o", folder / "view.mcap", "--json"),
        ]
        if random.random() < 0.1:
            commands.append(("report", path, "--out", folder / "report"))
        refusals = [refusal for command in commands if (refusal := _refusal(folder, *command))]
        for saved in (folder / "saved.mcap", folder / "view.mcap"):
            if saved.exists():
                _refusal(folder, "diff", saved, recorded)
        log = open_log(path)
        for name in (*TABLES, *DERIVED):
            log.table(name, start_s=0.4, end_s=0.8)
        if refusals:
            raise refusals[0]

    def _mutant(self, path: Path, random: Random) -> None:
        form = random.choice([*FORMS.values()])
        ticks = ticks_of(self._recorded)
        if random.random() < 0.5:
            for _ in range(random.choice((0, 1, 1, 5, 40))):
                _, messages = random.choice(ticks)
                at = random.randrange(len(messages))
                key, data = messages[at]
                messages[at] = key, with_extreme(data, random)
            write_form(self._recorded, path, form, ticks)
            return
        write_form(self._recorded, path, form, ticks)
        data = path.read_bytes()
        if form.chunked and random.random() < 0.3:
            data = random.choice([*CHUNK_DAMAGES.values()])(data, random, path)
        else:
            data = mutated(data, random, path)
        path.write_bytes(data)


def _refusal(folder: Path, *command: object) -> OnehopError | None:
    try:
        call(folder, *command)
    except OnehopError as refusal:
        return refusal
    return None
