"""The routing protocol that the scenario names, on one robot."""

from collections.abc import Callable

from onehop.contracts.radio_section import RadioSection
from onehop.contracts.units import nanoseconds
from radio_proxy.core.routing.direct import DirectRouter
from radio_proxy.core.routing.interface import NicServices, Router
from radio_proxy.core.routing.mrdv import MrdvRouter
from radio_proxy.core.routing.mrsr import MrsrRouter

RouterMaker = Callable[[NicServices, RadioSection, int], Router]
"""Makes the protocol of one robot from its NIC, the scenario's section, and the time [ns]."""


def direct(nic: NicServices, section: RadioSection, now: int) -> Router:  # noqa: ARG001
    """One hop and no routing."""
    return DirectRouter(nic)


def mrsr(nic: NicServices, section: RadioSection, now: int) -> Router:  # noqa: ARG001
    """Source routes, on DSR."""
    return MrsrRouter(nic, section.gamma_distance)


def mrdv(nic: NicServices, section: RadioSection, now: int) -> Router:
    """Distance vectors, on AODV."""
    return MrdvRouter(nic, section.gamma_distance, now, nanoseconds(section.hello_s))


BUILT_IN: dict[str, RouterMaker] = {"direct": direct, "mrsr": mrsr, "mrdv": mrdv}
