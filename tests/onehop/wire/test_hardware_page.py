"""docs/hardware.md says what the code does: layouts, rights, times."""

import re
from pathlib import Path

import pytest

from onehop.contracts import hardware, topics
from onehop.node.rights import rights
from tests.onehop.wire.test_wire_page import NAMES, layout, tables
from world_server.core.bases import BEYOND
from world_server.realtime.bases import FIRST_S

ROOT = Path(__file__).parents[3]

PAGE = (ROOT / "docs" / "hardware.md").read_text()

LAYOUTS = {
    kind.__name__: kind
    for kind in (hardware.Measured, hardware.Drive, hardware.BaseBriefing, hardware.Taken)
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_page_has_every_field_in_its_order_with_its_type(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(NAMES, hardware.Measured, "Measured")
    assert tables(PAGE)[name] == layout(LAYOUTS[name])
    assert tables(PAGE).keys() == LAYOUTS.keys()


def test_keys_and_rights_are_those_of_the_router() -> None:
    name = topics.base_name(5)
    may = rights(name)
    rows = re.findall(r"^\| (put|subscribe|query|declare alive|watch) \| (.*) \|$", PAGE, flags=re.M)
    assert {what: re.findall(r"`(.*?)`", keys) for what, keys in rows} == {
        "put": list(may.puts),
        "subscribe": [may.hears],
        "query": [may.asks],
        "declare alive": [may.announces],
        "watch": list(may.watches),
    }
    said = re.findall(r"^\| `((?:to|from)/\S+)` \|", PAGE, flags=re.M)
    told = (topics.to(name, topics.DRIVE), topics.to(name, topics.END))
    assert said == [topics.by(name, topics.MEASURED), *told]


def test_the_times_are_those_of_the_code() -> None:
    driver = (ROOT / "examples" / "base_driver.py").read_text()
    names = "RATE_HZ", "DEADMAN_S", "REUNION_S"
    found = (re.findall(rf"^{name} = (\S+)", driver, re.M) for name in names)
    rate, deadman, reunion = (float(number) for (number,) in found)
    assert f"({rate:g} Hz: up to {1e3 / rate:g} ms)" in PAGE
    assert f"no command for {deadman:g} s (`DEADMAN_S`" in PAGE
    assert f"for {reunion:g} s (`REUNION_S`)" in PAGE
    assert f"no measurement within {FIRST_S:g} s" in PAGE
    assert f"more than {BEYOND:g} m outside of the map" in PAGE
