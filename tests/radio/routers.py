"""The routers of a test network as what they are, and packets that MRDV and MRSR are given."""

from radio_proxy.core.data_message import DataMessage, DataPacket
from radio_proxy.core.routing import mrdv_packets
from radio_proxy.core.routing.mrdv import MrdvRouter
from radio_proxy.core.routing.mrsr import MrsrRouter
from tests.radio.net import Net


def mrdv_router(net: Net, robot: int) -> MrdvRouter:
    found = net.nics[robot].router
    assert isinstance(found, MrdvRouter)
    return found


def mrsr_router(net: Net, robot: int) -> MrsrRouter:
    found = net.nics[robot].router
    assert isinstance(found, MrsrRouter)
    return found


def mrdv_request(destination: int, **changes: object) -> mrdv_packets.Rreq:
    """A request of robot 9 as its neighbour 8 passes it on."""
    fields = {
        "origin": 9, "origin_sequence": 5, "number": 1, "destination": destination, "sequence": None,
        "hops": 1, "ttl": 5, "normal": False, "destination_only": False,
    }  # fmt: skip
    return mrdv_packets.Rreq(**{**fields, **changes})  # type: ignore[arg-type]


def mrsr_data(
    source: int, path: tuple[int, ...], route: tuple[int, ...], salvaged: int = 0
) -> DataPacket:
    """A message that came along `path` and carries a source route."""
    message = DataMessage(1, source, route[-1], b"", 800, 0)
    return DataPacket(message, path, (1,) * (len(path) - 1), route, salvaged)
