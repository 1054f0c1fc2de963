"""`onehop keys`: an authority of one's own, and a certificate for every process of a mission."""

from pathlib import Path

from onehop.commands.output import emit_json
from onehop.contracts.errors import InputError
from onehop.mission.authority import ROUTER, found, is_good, issue, names_of
from onehop.mission.router_file import write_router_file
from onehop.node.certificates import own_certificate
from onehop.node.identity import AUTHORITY
from onehop.scenario import scenario_file


def keys(
    folder: Path,
    robots: int | None,
    scenario: Path | None,
    hosts: list[str],
    days: int,
    mission: str,
    missing: bool,
    reissue: list[str],
    as_json: bool,
) -> int:
    """Make the folder, or what it lacks, or single certificates anew; returns the exit status."""
    if reissue:
        _require_known(folder, reissue)
        known = issued = tuple(reissue)
    else:
        known = _names(robots, scenario)
        if not (missing and (folder / AUTHORITY).exists()):
            found(folder)
        issued = tuple(name for name in known if not is_good(folder, name))
    for name in issued:
        issue(folder, name, hosts, days)
    certificates = [own_certificate(folder, name) for name in known]
    if not reissue:
        write_router_file(own_certificate(folder, ROUTER), mission, known)
    if as_json:
        listed = [
            {"name": one.name, "folder": str(one.folder), "expires": one.expires.isoformat(),
             "hosts": list(one.hosts)}
            for one in certificates
        ]  # fmt: skip
        emit_json({"issued": list(issued), "certificates": listed})
        return 0
    for one in certificates:
        if one.name in issued:
            where = f", for {', '.join(one.hosts)}" if one.hosts else ""
            print(f"issued {folder / one.name}, good until {one.expires:%Y-%m-%d}{where}")
    if not issued:
        print(f"{folder}: all is there")
    return 0


def _names(count: int | None, path: Path | None) -> tuple[str, ...]:
    if (count is None) == (path is None):
        raise InputError("keys", "for whom?", "either --robots N or --scenario FILE")
    if path is not None:
        scenario = scenario_file.load(path, []).scenario
        return names_of(scenario.team.robots, scenario.bases)
    assert count is not None
    return names_of(range(1, count + 1))


def _require_known(folder: Path, names: list[str]) -> None:
    """Raise InputError unless everyone of these has a folder there."""
    inside = sorted(path.parent.name for path in folder.glob(f"*/{AUTHORITY}"))
    for name in names:
        if name not in inside:
            whom = ", ".join(inside) or "a name in the folder of an onehop keys"
            raise InputError(f"--reissue {name}", f"not in {folder}", whom)
