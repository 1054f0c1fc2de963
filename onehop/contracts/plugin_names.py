"""Groups of what packages can add by name, and the type of such a name in a scenario."""

import re
from collections.abc import Iterator
from typing import TypeAlias

from onehop.contracts.problems import Problem

PLANNERS = "onehop.planners"
GAIN_POLICIES = "onehop.gain_policies"
ROUTING = "onehop.routing"
PROPAGATION = "onehop.propagation"
"""Groups of entry points; a briefing has what is plugged in under these."""

PluginName: TypeAlias = str
"""A name that an installed package offers, or "package.module:name": whether there is such a thing is
asked when a scenario file is read, and once more when a mission begins (onehop/plugins.py)."""

NAME = re.compile(r"[A-Za-z_]\w*(\.\w+)*:[A-Za-z_]\w*|[A-Za-z_][\w.-]*", re.ASCII)
"""package.module:name, or the name under which an installed package offers one."""

NAME_LETTERS = 200


def name_problems(key: str, name: str) -> Iterator[Problem]:
    """What is wrong with a name as such."""
    if not NAME.fullmatch(name) or len(name) > NAME_LETTERS:
        yield Problem(key, f"{name!r:.60} is no name", 'letters and digits, or "package.module:name"')
