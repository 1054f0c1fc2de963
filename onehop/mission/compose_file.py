"""A mission as containers: the compose file of a scenario, with a service for each process.

Certificates are made at the first start by a service that has no network; each process sees its own and
no other's. Each has a network of its own on which it reaches the world, the router, and nothing else.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from onehop.contracts import topics

PORT = 7447

BUS = f"tls/world:{PORT}"

USUAL_NETWORKS = 24
"""Networks for which the usual address pools of Docker are enough (31, less what others have)."""

NETWORKS = "10.213.{}.{}/29"
"""Where the networks of greater teams lie."""

HEAD = """\
# The mission of {scenario} as containers, written by `{command}`.
# Another mission, or a greater team: write it again.
#
#   mkdir -p runs/compose
#   docker compose up --build                the mission; its log and summary appear in runs/compose
#   docker compose --profile report up       the same, and at its end its report, beside them
#   docker compose --profile ros2 up         the same among the ROS 2 nodes of this machine, by a router
#                                            of rmw_zenoh on 127.0.0.1:7447 (else: ONEHOP_ROS_PORT)
#   ONEHOP_CLOCK=realtime docker compose up  by the wall clock; ONEHOP_CLOCK=lockstep: everyone waits for
#                                            everyone (default: {clock})
#
# The service `keys` makes certificates at the first start; docker compose down --volumes forgets them.
# ONEHOP_UID: the user of all processes, owner of runs/compose (default 1000; id -u tells yours).
# ONEHOP_RTPRIO=2: by the wall clock, each process may run as soon as it has to (SCHED_RR; default 0).
# A process that dies stays dead; docker compose up -d robot-3 lets it take part again.

x-process: &process
  image: onehop
{build}  user: "${{ONEHOP_UID:-1000}}:${{ONEHOP_UID:-1000}}"
  init: true
  read_only: true
  tmpfs: [/tmp]
  cap_drop: [ALL]
  security_opt: ["no-new-privileges:true"]
  restart: "no"
  stop_grace_period: 5s
  ulimits:
    rtprio: ${{ONEHOP_RTPRIO:-0}}
  depends_on:
    keys:
      condition: service_completed_successfully
  healthcheck:
    test: [CMD, python, -m, onehop.node.health, "{port}"]
    interval: 10s
    timeout: 10s
    start_period: 120s

services:
"""

BUILD = """\
  build:
    context: .
    args:
      BASE: ${{ONEHOP_BASE:-python:3.11-slim}}
      USER_ID: ${{ONEHOP_UID:-1000}}
      PROCESSES: {processes}
"""

KERNELS = "/var/cache/onehop"
"""Where the image has its compiled kernels; a volume without a name there, so that it can be written."""

LOG = "./runs/compose:/log"

AT_THE_END = """\
    profiles: [report]
    depends_on:
      recorder:
        condition: service_completed_successfully
"""
"""When a service starts that works on a whole log, if it is asked for."""

BESIDE = f"""\
    profiles: [ros2]
    depends_on: {{}}
    ports: ["127.0.0.1:${{ONEHOP_ROS_PORT:-{PORT}}}:{PORT}"]
"""
"""When the bridge to ROS 2 starts, if it is asked for, and where nodes out of its container find it."""

AT_THE_BEGIN = """\
    depends_on: {}
"""
"""When one starts that works for all others."""


@dataclass(frozen=True, slots=True)
class Source:
    """What the containers run. folder: of the scenario, from where the file is written; file: its name.

    programs: where robots find theirs, from `folder`, None: in the image. command: what writes this
    file. builds: whether the image is built there. clock: the mode of the scenario's.
    """

    folder: str
    file: str
    robots: tuple[int, ...]
    programs: str | None
    command: str
    builds: bool
    clock: str


def compose_file(source: Source) -> str:
    """The text of the file."""
    clients = (topics.RADIO, topics.RECORDER, *map(topics.robot_name, source.robots))
    processes = (topics.WORLD, *clients)
    build = BUILD.format(processes=" ".join(processes)) if source.builds else ""
    scenario = f"{source.folder}/{source.file}".removeprefix("./")
    head = HEAD.format(
        scenario=scenario, command=source.command, build=build, port=PORT, clock=source.clock
    )
    return head + "\n".join((*_services(source, clients), *_networks(clients), *_volumes(processes)))


def _services(source: Source, clients: Sequence[str]) -> Iterator[str]:
    mission = f"{source.folder}:/mission:ro"
    scenario = f"/mission/{source.file}"
    keys = ["authority:/keys", *(f"keys-{name}:/keys/{name}" for name in (topics.WORLD, *clients))]
    make = ["python", "-m", "onehop", "keys", "/keys", "--scenario", scenario, "--host", "world"]
    yield from _service("keys", [*make, "--missing"], [*keys, mission], (), AT_THE_BEGIN)
    world = ["python", "-m", "world_server", scenario, "--listen", f"tls/0.0.0.0:{PORT}"]
    world += ["--keys", "/keys", "--driver", "compose"]
    world += ["--set", f"clock.mode='${{ONEHOP_CLOCK:-{source.clock}}}'"]
    yield from _service(topics.WORLD, world, [*_own(topics.WORLD), mission], clients)
    for name in clients:
        more, volumes = _part_of(name, source)
        command = ["python", "-m", *more, "--connect", BUS, "--keys", "/keys"]
        yield from _service(name, command, [*_own(name), *volumes], (name,))
    report = ["python", "-m", "onehop", "report", "/log/mission.mcap", "--out", "/log/report"]
    yield from _service("report", report, [KERNELS, LOG], (), AT_THE_END)
    ros2 = ["python", "-m", "onehop.ros2", "/log/mission.mcap", "--new"]
    ros2 += ["--listen", f"tcp/0.0.0.0:{PORT}"]
    yield from _service("ros2", ros2, [f"{LOG}:ro"], ("ros2",), BESIDE)


def _part_of(name: str, source: Source) -> tuple[list[str], list[str]]:
    """Program and options of a process, and the volumes that it has beside its own."""
    if name == topics.RECORDER:
        return ["onehop.recorder", "--out", "/log"], [LOG]
    programs, folder = _programs(source)
    if name == topics.RADIO:
        return ["radio_proxy", *programs], folder
    robot = name.removeprefix(topics.robot_name(""))
    return ["robot_agent", "--id", robot, *programs], folder


def _programs(source: Source) -> tuple[list[str], list[str]]:
    """Option and volume of those who need programs that are not in the image; nobody else sees a map."""
    if source.programs is None:
        return [], []
    folder = f"{source.folder}/{source.programs}".removesuffix("/.")
    return ["--programs", "/programs"], [f"{folder}:/programs:ro"]


def _own(name: str) -> list[str]:
    return [f"keys-{name}:/keys/{name}:ro", KERNELS]


def _service(
    name: str,
    command: Sequence[str],
    volumes: Sequence[str],
    networks: Sequence[str],
    when: str = "",
) -> Iterator[str]:
    yield f"  {name}:"
    yield "    <<: *process"
    yield f"    command: {json.dumps(command)}"
    yield from when.splitlines()
    if networks:
        yield f"    networks: [{', '.join(networks)}]"
    else:  # one that does its work alone, and ends
        yield "    network_mode: none"
        yield "    healthcheck:"
        yield "      disable: true"
    yield "    volumes:"
    yield from (f"      - {volume}" for volume in volumes)
    yield ""


def _networks(clients: Sequence[str]) -> Iterator[str]:
    yield "networks:"
    for number, name in enumerate(clients):
        yield f"  {name}:"
        yield "    internal: true"
        if len(clients) > USUAL_NETWORKS:
            subnet = NETWORKS.format(number // 32, number % 32 * 8)
            yield "    ipam:"
            yield "      config:"
            yield f"        - subnet: {subnet}"
    yield "  ros2: {}"
    yield ""


def _volumes(processes: Sequence[str]) -> Iterator[str]:
    yield "volumes:"
    yield "  authority:"
    yield from (f"  keys-{name}:" for name in processes)
    yield ""
