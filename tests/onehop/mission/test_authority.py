"""`onehop keys`: certificates as they should be, and one line for those that are not."""

import datetime
import json
import os
import re
import shutil
from pathlib import Path

import pytest
import zenoh
from cryptography import x509

from onehop.commands.keys import keys as command
from onehop.contracts.errors import InputError
from onehop.mission import authority
from onehop.node.certificates import own_certificate
from onehop.node.identity import session_id
from onehop.node.rights import rights
from tests.onehop.scenes import FIELD

NAMES = ("world", "router", "radio", "recorder", "operator", "injector", "robot-1", "robot-2")


def made(folder: Path, robots: int | None = 2, missing: bool = False, *reissue: str) -> int:
    return command(
        folder, robots, None, ["10.0.0.1", "base"], 30, "onehop", missing, list(reissue), False
    )


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    assert made(tmp_path / "keys") == 0
    return tmp_path / "keys"


def test_every_process_has_a_folder_that_is_its_own(keys: Path) -> None:
    assert sorted(path.name for path in keys.iterdir() if path.is_dir()) == sorted(NAMES)
    for path in (keys, *keys.rglob("*")):
        assert path.stat().st_mode & 0o777 == (0o700 if path.is_dir() else 0o600)
    for name in NAMES:
        own = own_certificate(keys, name)
        left = own.expires - datetime.datetime.now(datetime.UTC)
        assert datetime.timedelta(29) < left < datetime.timedelta(30)
        serves = name in ("world", "router")
        assert own.hosts == (("localhost", "base", "127.0.0.1", "::1", "10.0.0.1") if serves else ())
        found = x509.load_pem_x509_certificate((keys / name / "cert.pem").read_bytes())
        purposes = found.extensions.get_extension_for_class(x509.ExtendedKeyUsage).value
        assert (x509.ExtendedKeyUsageOID.SERVER_AUTH in purposes) == serves


def test_what_is_there_is_not_overwritten(keys: Path) -> None:
    with pytest.raises(InputError, match="an authority is there already; another folder; --missing"):
        made(keys)


def test_what_is_missing_or_expired_is_added_and_the_rest_stays(
    keys: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (keys / "robot-1" / "key.pem").read_bytes()
    authority.issue(keys, "robot-2", (), days=-1)
    capsys.readouterr()
    assert made(keys, 3, True) == 0
    issued = [line.split(",")[0] for line in capsys.readouterr().out.splitlines()]
    assert issued == [f"issued {keys}/robot-2", f"issued {keys}/robot-3"]
    assert (keys / "robot-1" / "key.pem").read_bytes() == before
    assert made(keys, 3, True) == 0
    assert capsys.readouterr().out == f"{keys}: all is there\n"


def test_one_is_issued_again_by_the_same_authority(keys: Path) -> None:
    before = {name: (keys / name / "key.pem").read_bytes() for name in NAMES}
    assert made(keys, None, False, "robot-2", "world") == 0
    changed = {name for name in NAMES if (keys / name / "key.pem").read_bytes() != before[name]}
    assert changed == {"robot-2", "world"}
    assert "10.0.0.1" in own_certificate(keys, "world").hosts
    with pytest.raises(InputError, match=r"--reissue robot-9: not in .*; injector, operator"):
        made(keys, None, False, "robot-9")


def test_for_whom_has_to_be_said(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="either --robots N or --scenario FILE"):
        made(tmp_path / "keys", None)
    assert not (tmp_path / "keys").exists()


def test_a_scenario_says_for_whom(tmp_path: Path) -> None:
    scenario = tmp_path / "team.toml"
    scenario.write_text("[map]\nwidth = 9\nheight = 9\n[start]\nx = 4\ny = 4\n[goal]\nx = 5\ny = 5\n"
                        "[team]\nids = [3, 70]\n")  # fmt: skip
    assert command(tmp_path / "keys", None, scenario, [], 1, "onehop", False, [], False) == 0
    assert (tmp_path / "keys" / "robot-70").is_dir()


def _with_other_key(keys: Path) -> None:
    shutil.copy(keys / "robot-2" / "key.pem", keys / "robot-1" / "key.pem")


def _with_other_name(keys: Path) -> None:
    shutil.copy(keys / "robot-2" / "cert.pem", keys / "robot-1" / "cert.pem")


def _of_another_authority(keys: Path) -> None:
    made(keys / "foreign")
    shutil.copy(keys / "foreign" / "ca.pem", keys / "robot-1" / "ca.pem")


def _expired(keys: Path) -> None:
    authority.issue(keys, "robot-1", (), days=0)


def _open_to_others(keys: Path) -> None:
    (keys / "robot-1" / "key.pem").chmod(0o640)


def _torn(keys: Path) -> None:
    (keys / "robot-1" / "cert.pem").write_text("-----BEGIN")


def _without_key(keys: Path) -> None:
    (keys / "robot-1" / "key.pem").unlink()


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (_with_other_key, "key.pem: is not the key to cert.pem; onehop keys DIR --reissue robot-1"),
        (_with_other_name, "cert.pem: is that of robot-2; one of robot-1"),
        (_of_another_authority, "cert.pem: not signed by the authority in ca.pem; one folder"),
        (_expired, r"cert.pem: expired on 20..-..-..; onehop keys DIR --reissue robot-1"),
        (_open_to_others, "key.pem: others may read or change it; chmod 600 "),
        (_torn, "cert.pem: is no certificate; a PEM file made by onehop keys"),
        (_without_key, "key.pem: No such file or directory; made by onehop keys; copy the folder"),
    ],
)
def test_a_certificate_that_is_of_no_use_is_told_in_one_line(
    keys: Path, spoil: object, said: str
) -> None:
    assert callable(spoil)
    spoil(keys)
    with pytest.raises(InputError, match=said) as refused:
        own_certificate(keys, "robot-1")
    assert str(refused.value).startswith(str(keys / "robot-1"))
    assert "\n" not in str(refused.value)


def test_a_router_of_its_own_gives_everyone_the_same_rights(
    keys: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As zenohd reads the file: Zenoh takes it, and its rules are those of the table."""
    monkeypatch.chdir(keys / "router")
    config = zenoh.Config.from_file("zenohd.json5")
    assert json.loads(config.get_json("mode")) == "router"
    control = json.loads(config.get_json("access_control"))
    assert (control["enabled"], control["default_permission"]) == (True, "deny")
    subjects = {one["id"]: one for one in control["subjects"]}
    assert sorted(subjects) == sorted(set(NAMES) - {"router"})
    assert subjects["robot-2"]["cert_common_names"] == ["robot-2"]
    assert subjects["robot-2"]["zids"] == [session_id("robot-2")]
    rules = {one["id"]: one for one in control["rules"]}
    (policy,) = (one for one in control["policies"] if one["subjects"] == ["robot-2"])
    puts = {
        key
        for rule in map(rules.__getitem__, policy["rules"])
        if rule["flows"] == ["ingress"] and "put" in rule["messages"]
        for key in rule["key_exprs"]
    }
    assert puts == {f"onehop/{key}" for key in rights("robot-2").puts}
    assert os.path.exists(json.loads(config.get_json("transport/link/tls/listen_private_key")))


def test_the_driver_of_a_base_has_a_certificate_and_may_say_what_it_measures(tmp_path: Path) -> None:
    scenario = tmp_path / "real.toml"
    scenario.write_text(f'{FIELD}[clock]\nmode = "realtime"\n[[robots]]\nid = 3\nbase = "hardware"\n')
    folder = tmp_path / "keys"
    assert command(folder, None, scenario, [], 30, "onehop", False, [], False) == 0
    assert own_certificate(folder, "base-3").name == "base-3"
    assert not (folder / "base-2").exists()
    may = rights("base-3")
    assert (may.puts, may.hears) == (("from/base-3/measured",), "to/base-3/**")
    assert (may.asks, may.announces) == ("config/base-3", "alive/base-3")
    granted = json.loads(re.sub(r"//.*", "", (folder / "router" / "zenohd.json5").read_text()))
    rules = {one["id"]: one["key_exprs"] for one in granted["access_control"]["rules"]}
    assert rules["base-3 0"] == ["onehop/from/base-3/measured"]
