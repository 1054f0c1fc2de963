"""Who may see the page: the rules of Host, Origin, token and address."""

import socket

import pytest

from onehop.contracts.errors import InputError
from onehop.live.guard import Address, Guard, bind, content_policy, parse_address

LOCAL = Guard("127.0.0.1", 8000)
OPEN = Guard("0.0.0.0", 8000)


@pytest.mark.parametrize("host", ["127.0.0.1:8000", "localhost:8000", "LOCALHOST:8000"])
def test_this_machine_is_known_by_its_own_names(host: str) -> None:
    assert LOCAL.knows_host(host)


@pytest.mark.parametrize(
    "host",
    [
        None, "", "127.0.0.1", "127.0.0.1:8001", "evil.example:8000", "127.0.0.1.evil.example:8000",
        "127.0.0.1:8000:8000", "10.0.0.7:8000", "localhost.:8000", "localhost:8000@evil.example:8000",
    ],
)  # fmt: skip
def test_a_name_that_a_stranger_may_let_point_here_is_refused(host: str | None) -> None:
    """DNS rebinding: the browser believes that the stranger's page and this one are of one site."""
    assert not LOCAL.knows_host(host)


def test_on_every_interface_numbers_and_the_name_of_the_machine_are_known() -> None:
    assert OPEN.knows_host("10.0.0.7:8000")
    assert OPEN.knows_host("[fe80::1]:8000")
    assert OPEN.knows_host(f"{socket.gethostname()}:8000")
    assert not OPEN.knows_host("evil.example:8000")
    assert not OPEN.knows_host("10.0.0.7.evil.example:8000")


@pytest.mark.parametrize(
    "origin",
    [None, "null", "http://evil.example", "https://127.0.0.1:8000", "http://127.0.0.1:8001",
     "http://localhost:8000"],
)  # fmt: skip
def test_a_websocket_of_another_site_is_refused(origin: str | None) -> None:
    assert not LOCAL.is_own_page(origin, "127.0.0.1:8000")


def test_a_websocket_of_the_page_itself_is_taken() -> None:
    assert LOCAL.is_own_page("http://127.0.0.1:8000", "127.0.0.1:8000")
    assert not LOCAL.is_own_page("http://evil.example:8000", "evil.example:8000")


def test_the_token_is_long_new_each_time_and_compared_whole() -> None:
    assert LOCAL.token != OPEN.token
    assert len(LOCAL.token) >= 20
    assert LOCAL.knows_token(LOCAL.token)
    for wrong in (None, "", LOCAL.token[:-1], LOCAL.token + "x", "é"):
        assert not LOCAL.knows_token(wrong)
    assert LOCAL.url == f"http://127.0.0.1:8000/?token={LOCAL.token}"


def test_the_page_may_load_its_own_files_and_run_nothing_that_stands_in_its_text() -> None:
    policy = content_policy("127.0.0.1:8000")
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert "frame-ancestors 'none'" in policy


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("", Address("127.0.0.1", 0)),
        (":0", Address("127.0.0.1", 0)),
        (":8000", Address("127.0.0.1", 8000)),
        ("0.0.0.0:8000", Address("0.0.0.0", 8000)),
        ("[::1]:80", Address("::1", 80)),
        ("localhost", Address("localhost", 0)),
    ],
)
def test_an_address_is_host_and_port_and_either_may_be_left_out(text: str, address: Address) -> None:
    assert parse_address(text) == address


@pytest.mark.parametrize("text", ["127.0.0.1:port", "127.0.0.1:70000", "a:b:c"])
def test_what_is_no_address_is_one_line(text: str) -> None:
    with pytest.raises(InputError, match="no address; HOST:PORT"):
        parse_address(text)


def test_an_address_that_is_taken_is_one_line() -> None:
    with bind(Address()) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match="cannot be listened on: Address already in use"):
            bind(Address(port=port))
