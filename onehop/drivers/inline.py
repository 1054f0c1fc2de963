"""The inline driver: the whole mission in one process. The other drivers distribute this loop."""

from collections.abc import Callable

from onehop.contracts import topics
from onehop.contracts.action_limits import ActionLimits
from onehop.contracts.briefings import radio_briefing, robot_briefing
from onehop.contracts.messages import Action, Carriage, Outcome, percept, running
from onehop.maps.map_file import load_map
from onehop.scenario.bundle import Bundle
from onehop.wire.codec import encode
from onehop.wire.journal import Journal, WireMessage
from radio_proxy.core.radio import Radio
from robot_agent.core.robot import Robot
from world_server.core.world import World

Watcher = Callable[[World, dict[int, Action], Carriage], None]


def run(bundle: Bundle, journal: Journal | None, watch: Watcher | None = None) -> Outcome:
    """Run a mission to its outcome. watch is called after every tick with its actions and
    with what the radio did in it.
    """
    scenario = bundle.scenario
    walls = load_map(scenario.map, bundle.files)
    world = World(scenario, walls)
    radio = Radio(radio_briefing(scenario, walls.segments))
    robots: dict[tuple[int, int], Robot] = {}
    limits = ActionLimits(scenario.team.robots)
    outcome = None
    while outcome is None:
        truth = world.truth()
        carried = radio.carry(truth)
        observations = world.observe()
        actions: dict[int, Action] = {}
        fenced: dict[int, str] = {}
        for presence in running(truth):
            me = presence.robot, presence.incarnation
            if me not in robots:
                robots[me] = Robot(robot_briefing(scenario, *me))
            observation = observations[presence.robot]
            inbox = carried.inboxes[presence.robot]
            action = robots[me].step(percept(observation, inbox))
            wrong = limits.breach(action, truth.tick, presence.incarnation)
            if wrong is None:
                actions[presence.robot] = action
            else:
                fenced[presence.robot] = wrong
        world.advance(actions)
        for robot, why in fenced.items():
            world.fence(robot, why)
        if journal is not None:
            messages: list[WireMessage] = [(topics.TRUTH, encode(truth))]
            messages.append((topics.RADIO_RECORD, encode(carried.record)))
            messages += [(topics.rx(i), encode(inbox)) for i, inbox in carried.inboxes.items()]
            messages += [(topics.obs(i), encode(seen)) for i, seen in observations.items()]
            messages += [(topics.out(i), encode(action)) for i, action in actions.items()]
            journal.add(truth.tick, messages)
        if watch is not None:
            watch(world, actions, carried)
        outcome = world.outcome()
    return outcome
