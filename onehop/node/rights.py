"""Who may put, hear, ask, announce and watch what on the bus: one table, and Zenoh's form of it.

The world is the router and may do everything; what stands here is held against everyone else by the
router, which knows each of them by the password of its user name, or by its certificate. Expressions
stand without the mission's prefix.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from onehop.contracts import topics


@dataclass(frozen=True, slots=True)
class Rights:
    """What one identity may do.

    puts: what it may send. hears: what it may subscribe to. asks: what it may query. announces: the
    liveliness token that it may declare. watches: whose tokens it may see. audience: what those declare
    who hear its puts; Zenoh sends nothing of a publisher that may not see its subscribers.
    """

    puts: tuple[str, ...]
    hears: str
    asks: str
    announces: str
    watches: tuple[str, ...]
    audience: tuple[str, ...]


def rights(name: str) -> Rights:
    """The table."""
    puts, audience = [topics.by(name, "*")], [topics.heard(topics.WORLD)]
    if name.startswith(topics.base_name("")):
        puts = [topics.by(name, topics.MEASURED)]
    if name == topics.RECORDER:
        puts.append(topics.to(topics.OPERATOR, topics.DIGEST))
        audience.append(topics.heard(topics.OPERATOR))
    if name == topics.RADIO:
        puts.append(topics.to(topics.robot_name("$*"), topics.HEARD))
        audience.append(topics.heard(topics.robot_name("$*")))
    return Rights(
        puts=tuple(puts),
        hears=topics.heard(name),
        asks=topics.config(name),
        announces=topics.alive(name),
        watches=(topics.alive("*"), topics.alive(topics.WORLD)),
        audience=tuple(audience),
    )


WORLD_MESSAGES = (
    "put", "delete", "declare_subscriber", "query", "reply", "declare_queryable", "liveliness_token",
    "declare_liveliness_subscriber", "liveliness_query",
)  # fmt: skip
"""All that a world may say and hear that is no router itself."""


def access_control(
    mission: str, sessions: Mapping[str, str], known_by: str, world: str | None = None
) -> dict[str, Any]:
    """Zenoh's `access_control` that grants each name its rights and nothing else.

    sessions: the one session id of each name. The router takes no second session with an id that is
    there already, so a name cannot be used twice at once. known_by: what Zenoh calls that by which it
    knows a name, "usernames" (with passwords) or "cert_common_names". world: session id of a world that
    is no router itself.
    """
    rules: list[dict[str, Any]] = []
    subjects: list[dict[str, Any]] = []
    policies: list[dict[str, Any]] = []
    granted_to = {name: list(_rules(mission, name)) for name in sessions}
    if world is not None:
        sessions = {**sessions, topics.WORLD: world}
        granted_to[topics.WORLD] = [_everything(mission)]
    for name, session in sessions.items():
        granted = granted_to[name]
        rules += granted
        subjects.append({"id": name, known_by: [name], "zids": [session]})
        policies.append({"id": name, "rules": [rule["id"] for rule in granted], "subjects": [name]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _rules(mission: str, name: str) -> Iterator[dict[str, Any]]:
    """Zenoh's rules for one name; ingress is what it sends to the router, egress what it is sent."""
    may = rights(name)
    for number, (flow, messages, keys) in enumerate(
        (
            ("ingress", ("put", "delete"), may.puts),
            ("egress", ("declare_subscriber",), may.audience),
            ("ingress", ("declare_subscriber",), (may.hears,)),
            ("egress", ("put", "delete"), (may.hears,)),
            ("ingress", ("query",), (may.asks,)),
            ("egress", ("reply",), (may.asks,)),
            ("egress", ("declare_queryable",), (topics.config("*"),)),
            ("ingress", ("liveliness_token",), (may.announces,)),
            ("ingress", ("declare_liveliness_subscriber", "liveliness_query"), may.watches),
            ("egress", ("liveliness_token",), may.watches[:1]),
        )
    ):
        yield {
            "id": f"{name} {number}",
            "permission": "allow",
            "flows": [flow],
            "messages": list(messages),
            "key_exprs": [f"{mission}/{key}" for key in keys],
        }


def _everything(mission: str) -> dict[str, Any]:
    return {
        "id": topics.WORLD,
        "permission": "allow",
        "flows": ["ingress", "egress"],
        "messages": list(WORLD_MESSAGES),
        "key_exprs": [f"{mission}/**"],
    }
