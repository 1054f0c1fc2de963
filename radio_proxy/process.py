"""The shell of the radio: receive the truth of a tick, carry its messages, put all inboxes.

realtime.py has the one of a mission in real time.
"""

from onehop.contracts import topics
from onehop.contracts.briefings import RadioBriefing
from onehop.contracts.messages import Truth
from onehop.node import startup
from onehop.node.bus import GONE, Bus
from onehop.plugins import plugged_radio
from onehop.programs.find import search_in
from onehop.wire.batch import pack_tick
from onehop.wire.codec import decode, encode
from onehop.wire.journal import WireMessage
from radio_proxy.core.bounds import Carrier, make_radio
from radio_proxy.realtime import RealTimeRadio


def main() -> int:
    parser = startup.arguments("radio_proxy", "The radio between the robots of a mission.")
    startup.add_connect(parser)
    parser.add_argument("--programs", default="", metavar="DIR", help="where to look for plugins")
    options = parser.parse_args()
    startup.start(options)
    search_in(options.programs)
    with startup.connect(options, topics.RADIO) as bus:
        bus.watch(topics.WORLD)
        briefing = decode(RadioBriefing, startup.briefing(bus, topics.RADIO))
        radio = make_radio(plugged_radio(briefing))
        startup.calm_garbage_collector()
        if briefing.speed:
            startup.be_on_time()
            speed, period_ns = briefing.speed, briefing.period_ns
            realtime = RealTimeRadio(bus, radio, briefing.robots, speed, period_ns)
            bus.announce(topics.RADIO)
            return realtime.serve()
        return _serve(bus, radio)


def _serve(bus: Bus, radio: Carrier) -> int:
    put = bus.publisher(topics.by(topics.RADIO, topics.CARRIED))
    bus.announce(topics.RADIO)
    has_begun = False
    while True:
        what, data = bus.receive()
        if what == topics.TRUTH:
            has_begun = True
            truth = decode(Truth, data)
            carried = radio.carry(truth)
            messages: list[WireMessage] = [
                (topics.rx(i), encode(inbox)) for i, inbox in carried.inboxes.items()
            ]
            messages.append((topics.RADIO_RECORD, encode(carried.record)))
            put(pack_tick(truth.tick, messages))
        elif what == topics.END:
            return 0
        elif (what, data) == (topics.alive(topics.WORLD), GONE) and (
            has_begun or not startup.finds_world(bus)
        ):
            return startup.WORLD_IS_GONE
