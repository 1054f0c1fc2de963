"""The option --live of `onehop run`: an address behind it, or nothing."""

from typing import Any

from typer.core import TyperCommand

LIVE = "--live"

ANYWHERE = ":0"
"""A free port on loopback."""


class OptionalAddress(TyperCommand):
    """A command whose option --live takes an address, or none for a free port on loopback."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        for at, word in enumerate(args):
            following = args[at + 1] if at + 1 < len(args) else "-"
            if word == LIVE and (following.startswith("-") or ":" not in following):
                args = [*args[:at], f"{LIVE}={ANYWHERE}", *args[at + 1 :]]
                break
            if word == LIVE or word == "--":
                break
        return super().parse_args(ctx, args)
