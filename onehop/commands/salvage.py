"""`onehop salvage`: a sound log from a torn or damaged one."""

from dataclasses import asdict
from pathlib import Path

from onehop.analysis.salvage import Salvage
from onehop.analysis.salvage import salvage as salvage_log
from onehop.commands.logs import flaws_in_words
from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.contracts.printable import printable

_TOLD = 5
"""Damaged places that are told."""


def salvage(torn: Path, out: Path, as_json: bool) -> int:
    """Write the sound log and say what was lost.

    Exit status 1 when no tick could be saved, or not all that the log says that its mission had.
    """
    if out.exists():
        raise InputError(f"-o {out}", "exists already", "name a new file")
    if not out.parent.is_dir():
        raise InputError(f"-o {out}", "its folder does not exist", "make the folder first")
    saved = salvage_log(torn, out)
    if as_json:
        emit_json({**asdict(saved), "log": str(out)})
    else:
        _print(saved, out)
    return 1 if saved.flaws else 0


def _print(saved: Salvage, out: Path) -> None:
    span = f"{saved.ticks} ticks, the last of them tick {saved.last_tick}"
    print(f"saved  {saved.messages} messages of {span}, in {out}")
    for loss in _losses(saved) or ["nothing: the log was sound"]:
        print(f"lost   {loss}")
    for why in saved.damage[:_TOLD]:
        print(f"why    {printable(why)}")
    if len(saved.damage) > _TOLD:
        print(f"why    and {len(saved.damage) - _TOLD} more damaged places")
    if not saved.ended:
        print("note   the mission's outcome is not in the log: nothing says whether it is all of it")


def _losses(saved: Salvage) -> list[str]:
    losses = []
    if saved.flaws:
        losses.append(flaws_in_words(saved.flaws))
    if saved.given_up:
        losses.append(f"{saved.given_up} messages of ticks that are not whole")
    if saved.copies:
        losses.append(f"{saved.copies} messages that were there twice")
    if saved.unread_bytes:
        losses.append(f"{saved.unread_bytes} bytes that belong to no whole record")
    return losses
