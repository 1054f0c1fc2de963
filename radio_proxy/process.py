"""The shell of the radio: hear the truth of a tick, carry what was offered, put all inboxes."""

from onehop.contracts import topics
from onehop.contracts.messages import Truth
from onehop.contracts.scenario import RadioBriefing
from onehop.drive import node
from onehop.drive.bus import GONE, Bus
from onehop.drive.codec import decode, encode
from onehop.drive.journal import WireMessage
from onehop.drive.record import pack_record
from radio_proxy.core.radio import Radio


def main() -> int:
    parser = node.arguments("radio_proxy", "The radio between the robots of a mission.")
    node.add_connect(parser)
    options = parser.parse_args()
    node.start(options)
    with node.connect(options, topics.RADIO) as bus:
        bus.watch(topics.WORLD)
        radio = Radio(decode(RadioBriefing, node.briefing(bus, topics.RADIO)))
        node.calm_garbage_collector()
        return _serve(bus, radio)


def _serve(bus: Bus, radio: Radio) -> int:
    put = bus.publisher(topics.by(topics.RADIO, topics.AIR))
    bus.announce(topics.RADIO)
    while True:
        what, data = bus.receive()
        if what == topics.TRUTH:
            truth = decode(Truth, data)
            carried = radio.carry(truth)
            messages: list[WireMessage] = [
                (topics.rx(i), encode(inbox)) for i, inbox in carried.inboxes.items()
            ]
            messages.append((topics.ETHER, encode(carried.ether)))
            put(pack_record(truth.tick, messages))
        elif what == topics.END:
            return 0
        elif data == GONE:
            return 1
