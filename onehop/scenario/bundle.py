"""Everything that a mission is made from, and its way into a log and back."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field

from onehop.contracts.errors import ScenarioError
from onehop.contracts.scenario import Scenario
from onehop.scenario.changes import apply_change
from onehop.scenario.structure import structure


@dataclass(frozen=True, slots=True)
class Bundle:
    """Everything that a mission is made from: a scenario and the bytes of its map's files by name.

    folder: where its programs are looked for that are not installed (onehop/programs); empty for none.
    """

    scenario: Scenario
    files: dict[str, bytes]
    folder: str = field(default="", compare=False)

    def scenario_json(self) -> str:
        """The whole scenario with every default written out; `bundle_from_json` reads it back."""
        return json.dumps(asdict(self.scenario), indent=1)


def bundle_from_json(text: str, files: Mapping[str, bytes], origin: str, folder: str = "") -> Bundle:
    """The mission that a log carries as attachments. Raises ScenarioError."""
    try:
        table = json.loads(text)
    except ValueError as error:
        raise ScenarioError(origin, f"not JSON ({error})", "an attachment written by onehop") from None
    return Bundle(structure(table, origin), dict(files), folder)


def changed(scenario: Scenario, settings: Iterable[str]) -> Scenario:
    """The same scenario with some keys changed ("key.path=value"). Raises ScenarioError."""
    table = json.loads(json.dumps(asdict(scenario)))
    for setting in settings:
        apply_change(table, setting)
    altered = structure(table, "--set")
    if altered.profile != scenario.profile:
        raise ScenarioError(
            "--set profile", "a log has every key of its profile written out", "set the keys themselves"
        )
    return altered
