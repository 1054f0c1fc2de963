"""The shell of the radio: hear the truth of a tick, carry what was offered, put every inbox."""

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
        bus.subscribe(topics.TRUTH)
        bus.subscribe(topics.END)
        bus.watch(topics.alive(topics.WORLD))
        briefing = decode(RadioBriefing, node.briefing(bus, topics.RADIO))
        radio = Radio(briefing)
        node.calm_garbage_collector()
        return _serve(bus, radio, briefing.robots)


def _serve(bus: Bus, radio: Radio, robots: tuple[int, ...]) -> int:
    put_inbox = {i: bus.publisher(topics.rx(i)) for i in robots}
    put_record = bus.publisher(topics.record(topics.RADIO), express=False)
    bus.announce(topics.RADIO)
    while True:
        key, data = bus.inbox.get()
        if key == topics.TRUTH:
            truth = decode(Truth, data)
            carried = radio.carry(truth)
            record: list[WireMessage] = []
            for i, inbox in carried.inboxes.items():
                encoded = encode(inbox)
                put_inbox[i](encoded)
                record.append((topics.rx(i), encoded))
            record.append((topics.ETHER, encode(carried.ether)))
            put_record(pack_record(truth.tick, record))
        elif key == topics.END:
            return 0
        elif data is GONE:
            return 1
