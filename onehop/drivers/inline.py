"""The inline driver: the whole mission in one process. The other drivers distribute this loop."""

from collections.abc import Callable

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.briefings import radio_briefing, robot_briefing
from onehop.contracts.errors import DecodeError
from onehop.contracts.messages import Action, Carriage, Outcome, percept, running
from onehop.maps.map_file import load_map
from onehop.plugins import plugged_radio
from onehop.programs.find import require_programs, search_in
from onehop.programs.host import Host, ProgramError
from onehop.scenario.bundle import Bundle
from onehop.scenario.link_trace import link_trace
from onehop.wire.codec import encode
from onehop.wire.journal import Journal, WireMessage
from onehop.wire.spoken import action_in, failed
from radio_proxy.core.bounds import make_radio
from world_server.core.world import World

Watcher = Callable[[World, dict[int, Action], Carriage], None]


def run(
    bundle: Bundle,
    journal: Journal | None,
    watch: Watcher | None = None,
    tell: Callable[[int, ProgramError], None] | None = None,
) -> Outcome:
    """Run a mission to its outcome.

    watch is called after every tick with its actions and with what the radio did in it, tell with each
    robot whose program fails. Raises ScenarioError for what cannot be run here.
    """
    scenario = bundle.scenario
    require_programs(scenario, scenario.name)
    search_in(bundle.folder)
    walls = load_map(scenario.map, bundle.files)
    world = World(scenario, walls)
    radio = make_radio(plugged_radio(radio_briefing(scenario, walls.segments, link_trace(bundle))))
    robots: dict[tuple[int, int], Host] = {}
    limits = ActionLimits(scenario.team.robots)
    outcome = None
    while outcome is None:
        truth = world.truth()
        carried = radio.carry(truth)
        observations = world.observe()
        actions: dict[int, Action] = {}
        said: list[WireMessage] = []
        fenced: dict[int, str] = {}
        for presence in running(truth):
            me = i, incarnation = presence.robot, presence.incarnation
            if me not in robots:
                robots[me] = Host(robot_briefing(scenario, *me))
            try:
                data = robots[me].step(percept(observations[i], carried.inboxes[i]))
                action = action_in(data, limits)
                wrong = limits.breach(action, truth.tick, incarnation)
            except ProgramError as failure:
                wrong = failed(failure.reason)
                if tell is not None:
                    tell(i, failure)
            except DecodeError as error:
                wrong = str(error)
            if wrong is None:
                actions[i] = action
                said.append((topics.out(i), data))
            else:
                fenced[i] = wrong
        world.advance(actions)
        for robot, why in fenced.items():
            world.fence(robot, why)
        if journal is not None:
            messages: list[WireMessage] = [(topics.TRUTH, encode(truth))]
            messages.append((topics.RADIO_RECORD, encode(carried.record)))
            messages += [(topics.rx(i), encode(inbox)) for i, inbox in carried.inboxes.items()]
            messages += [(topics.obs(i), encode(seen)) for i, seen in observations.items()]
            messages += said
            journal.add(truth.tick, messages)
        if watch is not None:
            watch(world, actions, carried)
        outcome = world.outcome()
    return outcome
