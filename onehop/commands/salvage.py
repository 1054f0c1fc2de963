"""`onehop salvage`: a sound log from a torn one."""

from dataclasses import asdict
from pathlib import Path

from onehop.analysis.salvage import salvage as salvage_log
from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.wire.log_reader import LogFile


def salvage(torn: Path, out: Path, as_json: bool) -> int:
    """Write the sound log and say what was lost; exit status 1 when no tick could be saved."""
    if out.exists():
        raise InputError(f"-o {out}", "exists already", "name a new file")
    if not out.parent.is_dir():
        raise InputError(f"-o {out}", "its folder does not exist", "make the folder first")
    period = LogFile(torn).bundle.scenario.clock.period_ns / 1e9
    saved = salvage_log(torn, out)
    if as_json:
        emit_json({**asdict(saved), "log": str(out)})
    else:
        print(
            f"saved  {saved.messages} messages, ticks 0..{saved.last_tick} "
            f"({(saved.last_tick + 1) * period:.2f} s), in {out}"
        )
        print(f"lost   {_loss(saved.given_up, saved.unread_bytes, saved.last_tick + 1)}")
        if saved.damage:
            print(f"why    {saved.damage}")
        if not saved.ended:
            print("note   the mission's outcome is not in the log: it ends before the mission did")
    return 0 if saved.last_tick >= 0 else 1


def _loss(given_up: int, unread_bytes: int, next_tick: int) -> str:
    losses = []
    if given_up:
        losses.append(f"{given_up} messages of the unfinished tick {next_tick}")
    if unread_bytes:
        losses.append(f"{unread_bytes} bytes that belong to no whole record")
    return " and ".join(losses) or "nothing: the log was sound"
