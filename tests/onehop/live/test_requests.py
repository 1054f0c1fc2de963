"""What a page may say; who has the buttons."""

import json
from typing import Any

import pytest

from onehop.contracts.errors import DecodeError
from onehop.contracts.fault_section import FaultSection
from onehop.live.requests import Order, SetPace, Want, decode_request, fault_of
from onehop.live.watchers import Watchers


def test_a_request_is_what_its_kind_says() -> None:
    assert decode_request('{"kind":"want","tick":-1,"since":5}') == Want(-1, 5, 0)
    pace = decode_request('{"kind":"pace","ticks_per_s":20,"paused":true,"steps":1}')
    assert pace == SetPace(20.0, True, 1)


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "{}", '{"kind":"shutdown"}', '{"kind":"want","tick":-2,"since":0}',
        '{"kind":"want","tick":1,"since":0,"more":1}', '{"kind":"pace","ticks_per_s":-1,"paused":false}',
        '{"kind":"pace","ticks_per_s":1e99,"paused":false}', '{"kind":"want","tick":"1","since":0}',
        '{"kind":"explain","robot":1,"at_s":-1}',
        '{"kind":"road map","robot":1,"tick":-1}', "[" * 100_000,
    ],
)  # fmt: skip
def test_anything_else_is_refused(text: str) -> None:
    with pytest.raises(DecodeError, match="no request of a page"):
        decode_request(text)


def test_an_order_is_a_fault_with_the_keys_of_a_scenario() -> None:
    order = Order(1, {"kind": "hold", "robots": [3, 1], "duration_s": 2})
    assert fault_of(order) == FaultSection("hold", robots=(3, 1), duration_s=2.0)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        ({}, "no kind of fault"),
        ({"kind": "explode"}, "no kind of fault"),
        ({"kind": "kill"}, "robots: kill of nobody"),
        ({"kind": "kill", "robots": ["3"]}, "Expected `int`"),
        ({"kind": "jam", "x": 1, "y": 2}, "radius: a jam without extent"),
        ({"kind": "jam", "x": 1, "y": 2, "radius": -1}, "radius: -1"),
        ({"kind": "hold", "robots": [1], "delay_ticks": 3}, "hold takes no delay_ticks"),
    ],
)
def test_an_order_that_makes_no_sense_is_one_line(fault: dict[str, Any], said: str) -> None:
    with pytest.raises(DecodeError, match=said):
        fault_of(Order(1, json.loads(json.dumps(fault))))


class Page:
    def __init__(self) -> None:
        self.stirred = 0

    def stir(self) -> None:
        self.stirred += 1


def test_the_first_page_has_the_buttons_until_another_takes_over_or_it_goes() -> None:
    pages: Watchers[Page] = Watchers()
    first, second, third = Page(), Page(), Page()
    for page in (first, second, third):
        pages.join(page)
    assert pages.holder is first
    pages.give(third)
    assert pages.holder is third
    pages.leave(second)
    assert pages.holder is third
    before = first.stirred
    pages.leave(third)
    assert pages.holder is first
    assert first.stirred > before
    pages.leave(first)
    assert (pages.holder, len(pages)) == (None, 0)
