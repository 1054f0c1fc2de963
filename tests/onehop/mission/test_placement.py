"""Options of a mission on several hosts: what is wrong with them is one line."""

from pathlib import Path

import pytest

from onehop.contracts.errors import InputError
from onehop.mission import authority
from onehop.mission.placement import Placement, on_hosts

BUS = "tls/127.0.0.1:7447"


@pytest.fixture(scope="module")
def keys(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("placement") / "keys"
    authority.found(folder)
    authority.issue(folder, "world", ["base.example"], 7)
    return folder


def placed(keys: Path | None, bus: str = BUS, remote: str = "3", mission: str = "m") -> Placement:
    return on_hosts(bus, keys, remote, mission, 60.0, (1, 2, 3, 4))


@pytest.mark.parametrize(
    ("bus", "said"),
    [
        ("10.0.0.1:7447", "no endpoint; tls/HOST:PORT"),
        ("tls/10.0.0.1", "no endpoint"),
        ("tls/10.0.0.1:70000", "no endpoint"),
        ("tcp/127.0.0.1:7447", "passwords and what is said would cross the network in the open; tls/"),
        ("tls/10.0.0.1:7447", "the world's certificate is for localhost, base.example, 127.0.0.1, ::1"),
    ],
)
def test_a_bus_that_cannot_be_is_refused(keys: Path, bus: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as refused:
        placed(keys, bus)
    assert str(refused.value).startswith(f"--bus {bus}: ")


@pytest.mark.parametrize("remote", ["5", "3,recorder", "x", "world"])
def test_who_cannot_be_elsewhere_is_refused(keys: Path, remote: str) -> None:
    with pytest.raises(InputError, match="cannot be elsewhere; of radio, 1, 2, 3, 4"):
        placed(keys, remote=remote)


def test_other_options_are_checked(keys: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--keys is missing"):
        placed(None)
    with pytest.raises(InputError, match=r"--mission a/b: no name of a mission"):
        placed(keys, mission="a/b")
    with pytest.raises(InputError, match=r"world/ca.pem: No such file"):
        placed(tmp_path)


def test_everyone_is_told_what_it_needs(keys: Path) -> None:
    placement = placed(keys, remote="radio,3,3")
    assert placement.remote == ("radio", "robot-3")
    assert placement.world_arguments() == ["--listen", BUS, "--keys", str(keys), "--start-s", "60"]
    assert placement.client_arguments() == ["--connect", BUS, "--keys", str(keys)]
    assert placement.invitation() == (
        "waiting for radio, robot-3, 60 s at most; there: "
        f"python -m radio_proxy --connect {BUS} --mission m --keys DIR; "
        f"python -m robot_agent --id 3 --connect {BUS} --mission m --keys DIR"
    )
    assert placed(keys, "tls/base.example:1").connect == "tls/base.example:1"
    for everywhere in ("0.0.0.0", "[::]"):
        assert placed(keys, f"tls/{everywhere}:7447").connect == "tls/127.0.0.1:7447"
    assert "--start-s" not in placed(keys, remote="").world_arguments()


def test_the_driver_of_a_base_comes_from_elsewhere_unless_something_starts_it_here(keys: Path) -> None:
    bases = {2: ("python", "driver.py"), 4: ()}
    placement = on_hosts(BUS, keys, "", "onehop", 60.0, (1, 2, 3, 4), bases=bases)
    assert placement.remote == ("base-4",)
    assert placement.invitation() == (
        "waiting for base-4, 60 s at most; there: "
        f"python base_driver.py --id 4 --connect {BUS} --keys DIR"
    )
    sent_away = on_hosts(BUS, keys, "base-2,3", "onehop", 60.0, (1, 2, 3, 4), bases=bases)
    assert sent_away.remote == ("base-2", "robot-3", "base-4")
    with pytest.raises(InputError, match="cannot be elsewhere; of radio, 1, 2, 3, 4, base-2, base-4"):
        on_hosts(BUS, keys, "base-3", "onehop", 60.0, (1, 2, 3, 4), bases=bases)
