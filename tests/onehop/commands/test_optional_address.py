"""The option --live takes an address, or none."""

from typing import Annotated

import pytest
import typer

from onehop.commands.optional_address import ANYWHERE, LIVE, OptionalAddress

app = typer.Typer()
seen: list[tuple[str, str | None]] = []


@app.command(cls=OptionalAddress)
def run(
    scenario: str, live: Annotated[str | None, typer.Option(LIVE)] = None, out: str | None = None
) -> None:
    seen.append((scenario, live if out is None else f"{live} {out}"))


@pytest.mark.parametrize(
    ("typed", "live"),
    [
        ("map1.toml", None),
        ("map1.toml --live", ANYWHERE),
        ("map1.toml --live --out here", f"{ANYWHERE} here"),
        ("--live map1.toml", ANYWHERE),
        ("map1.toml --live 0.0.0.0:8000", "0.0.0.0:8000"),
        ("--live :8000 map1.toml", ":8000"),
        ("map1.toml --live=[::1]:8000", "[::1]:8000"),
    ],
)
def test_what_follows_it_is_an_address_if_it_looks_like_one(typed: str, live: str | None) -> None:
    seen.clear()
    typer.main.get_command(app).main(typed.split(), standalone_mode=False)
    assert seen == [("map1.toml", live)]
