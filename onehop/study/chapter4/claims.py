"""The qualitative claims of chapter 4, each held against missions."""

from collections.abc import Iterator, Sequence

from onehop.campaign.lines import Row
from onehop.study.chapter4.missions import CONSTANT, VARIABLE
from onehop.study.chapter4.reported import REPORTED
from onehop.study.claims import Claim, Expects, Judgement, judge
from onehop.study.comparison import Where, chosen, difference, mean, strata
from onehop.study.statistics import estimate

TO_VARIABLE: tuple[Where, Where] = ({"policy": CONSTANT}, {"policy": VARIABLE})
"""From constant to variable k_rho."""

TO_MRSR: tuple[Where, Where] = ({"routing": "mrdv"}, {"routing": "mrsr"})

SAME_LOST = 0.5
"""Half a robot a mission: nearer than this, two cells lose the same [robots]."""

ROUTING_WORD = {"mrsr": "MRSR", "mrdv": "MRDV"}


def policy_claims(rows: Sequence[Row]) -> Iterator[Judgement]:
    """Constant against variable k_rho. rows: of the delayed missions."""
    cells = strata(rows, "map", "routing")
    for cell in cells:
        where = f"{cell['map']} and {ROUTING_WORD[cell['routing']]}"
        source = REPORTED[cell["map"], cell["routing"], CONSTANT].figure.partition(",")[0]
        claim = Claim(
            f"On {where} the variable k_rho loses fewer robots than the constant.",
            source.replace(" a", ""), "lost", Expects.LESS, "robots",
        )  # fmt: skip
        yield _changed(rows, claim, TO_VARIABLE, [cell])
    for claim in (
        Claim("The variable k_rho loses fewer robots.", "4.2", "lost", Expects.LESS, "robots"),
        Claim(
            "It raises the throughput of the followers.", "4.2.1, 4.2.2", "throughput_bps",
            Expects.MORE, "kb/s", 1e3,
        ),
        Claim(
            "Whenever the throughput drops below the threshold it rises almost at once: less time "
            "below it.", "4.2.1", "below_threshold_s", Expects.LESS, "s",
        ),
        Claim("It lowers the bit error rate (3.25).", "4.2.1, 4.2.3", "ber", Expects.LESS),
    ):  # fmt: skip
        yield _changed(rows, claim, TO_VARIABLE, cells)
    for (ground, routing, policy), reported in REPORTED.items():
        cell = {"map": ground, "routing": routing, "policy": policy}
        own = chosen(rows, cell)
        if policy == VARIABLE and reported.lost == 0 and own:
            says = f"On {ground} with {ROUTING_WORD[routing]} the variable k_rho loses nobody."
            claim = Claim(says, reported.figure.partition(",")[0], "lost", Expects.NONE, "robots")
            yield judge(claim, mean(own, "lost"), len(own))


def routing_claims(rows: Sequence[Row]) -> Iterator[Judgement]:
    """MRSR against MRDV, as the difference MRSR - MRDV. rows: of the delayed missions."""
    everywhere = strata(rows, "map", "policy")
    yield _changed(
        rows,
        Claim(
            "MRSR has a slightly lower overhead than MRDV.", "4.2", "routing_bytes", Expects.LESS,
            "kB", 1e3,
        ),
        TO_MRSR,
        everywhere,
    )  # fmt: skip
    yield _changed(
        rows,
        Claim("MRSR has a slightly higher delay than MRDV.", "4.2", "delay_ms", Expects.MORE, "ms"),
        TO_MRSR,
        everywhere,
    )
    for ground, expects, says in (
        ("map1", Expects.SAME, "On map1 both routings lose the same."),
        ("map2", Expects.MORE, "On map2 with constant k_rho MRDV loses fewer robots than MRSR."),
        ("map3", Expects.LESS, "On map3 with constant k_rho MRSR loses fewer robots than MRDV."),
    ):
        cells = [{"map": ground, "policy": CONSTANT}]
        claim = Claim(
            says, "4.2." + ground[-1], "lost", expects, "robots",
            margin=SAME_LOST if expects is Expects.SAME else 0.0,
        )  # fmt: skip
        yield _changed(rows, claim, TO_MRSR, cells)
    variable = [cell for cell in everywhere if cell["policy"] == VARIABLE]
    yield _changed(
        rows,
        Claim(
            "With variable k_rho MRDV has less throughput than MRSR in the long run.", "4.2.3, 5",
            "throughput_bps", Expects.MORE, "kb/s", 1e3,
        ),
        TO_MRSR,
        variable,
    )  # fmt: skip


def ideal_claim(rows: Sequence[Row]) -> Judgement:
    """Without a delay. rows: of the undelayed missions."""
    claim = Claim(
        "Without an imposed delay all followers arrive.", "4.2", "lost", Expects.NONE, "robots"
    )
    of_seed: dict[int, list[int]] = {}
    for row in rows:
        of_seed.setdefault(row["seed"], []).append(row["lost"])
    means = [sum(lost) / len(lost) for lost in of_seed.values()]
    return judge(claim, estimate(means), len(means))


def _changed(
    rows: Sequence[Row], claim: Claim, change: tuple[Where, Where], cells: Sequence[Where]
) -> Judgement:
    before, after = change
    found = difference(rows, claim.measure, before, after, cells)
    return judge(claim, found.estimate, found.seeds)
