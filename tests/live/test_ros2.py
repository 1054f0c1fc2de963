"""A running team among ROS 2 nodes: another implementation of rmw_zenoh's wire sees and drives it."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from onehop.analysis.log import open_log
from onehop.analysis.ros2.types import typestore
from onehop.checking import judge
from onehop.drivers.replay import replay
from onehop.mission.processes import free_endpoint
from onehop.wire.log_reader import LogFile
from onehop.wire.log_writer import LOG_EPOCH_NS
from tests.live.mission import DEADLINE_S, Mission

pytestmark = pytest.mark.live

peer = pytest.importorskip("zenoh_ros2_sdk", reason="the peer (zenoh-ros2-sdk) is not installed")

ODOMETRY, TWIST, LINK = "nav_msgs/msg/Odometry", "geometry_msgs/msg/Twist", "onehop_msgs/msg/Link"
TYPES = {
    "/clock": "rosgraph_msgs/msg/Clock",
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/robot_1/odom": ODOMETRY,
    "/robot_1/scan": "sensor_msgs/msg/LaserScan",
    "/robot_1/cmd_vel": TWIST,
    "/robot_1/mode": "std_msgs/msg/String",
}


def wait(what: str, done: Callable[[], Any]) -> Any:
    deadline = time.monotonic() + DEADLINE_S
    while not (found := done()):
        assert time.monotonic() < deadline, f"in vain until {what}"
        time.sleep(0.05)
    return found


@pytest.fixture(scope="module")
def endpoint() -> str:
    return free_endpoint()


@pytest.fixture
def driven(endpoint: str, tmp_path: Path) -> Mission:
    """A mission in real time whose robot 4 is driven by ROS 2; it lasts until it is told to end."""
    parameters = f'parameters={{router="{endpoint}", hold_s=1.0}}'
    robots = f'robots=[{{id=4, program="onehop.ros2.robot:Ros2Robot", {parameters}}}]'
    options = ("--clock", "realtime", "--ros2", "--ros-router", endpoint)
    return Mission(tmp_path, robots, "goal.x=39", "goal.y=39", options=options)


def test_a_peer_sees_the_team_and_drives_one_of_it(driven: Mission, endpoint: str) -> None:
    from zenoh_ros2_sdk import discovery
    from zenoh_ros2_sdk.publisher import ROS2Publisher
    from zenoh_ros2_sdk.subscriber import ROS2Subscriber

    store, port = typestore(), int(endpoint.rpartition(":")[2])
    at = {"router_ip": "127.0.0.1", "router_port": port}
    driven.await_ticks(1)

    def listed() -> dict[str, str]:
        return {name: kinds[0] for name, kinds in discovery.get_topic_names_and_types(timeout=1.0, **at)}

    topics = wait("all topics are there", lambda: (found := listed()).keys() >= TYPES.keys() and found)
    assert {name: topics[name] for name in TYPES} == TYPES
    about = discovery.get_topic_info("/robot_1/scan", timeout=1.0, **at)
    assert about is not None

    def listen(topic: str, kind: str, qos: str) -> list[Any]:
        heard: list[Any] = []
        own = {"msg_definition": store.generate_msgdef(kind)[0], "type_hash": store.hash_rihs01(kind)}
        ROS2Subscriber(topic, kind, heard.append, router_port=port, qos=qos, **own)
        return heard

    ground = listen("/map", TYPES["/map"], ":1:,1:,:,:,,")
    odometry = listen("/robot_4/odom", ODOMETRY, "::,10:,:,:,,")
    links = listen("/robot_1/link", LINK, "::,10:,:,:,,")
    wait("the map came, though it was published before", lambda: ground)
    definition = store.generate_msgdef(TWIST)[0]
    publisher = ROS2Publisher(
        "/robot_4/cmd_vel", TWIST, msg_definition=definition, router_port=port,
        type_hash=store.hash_rihs01(TWIST),
    )  # fmt: skip
    vector = store.types["geometry_msgs/msg/Vector3"]

    def turns() -> bool:
        publisher.publish(linear=vector(0.0, 0.0, 0.0), angular=vector(0.0, 0.0, 0.5))
        return len(odometry) > 5 and odometry[-1].twist.twist.angular.z == 0.5

    wait("robot 4 turns as it is told", turns)
    wait("nobody tells it any more, and it stands", lambda: odometry[-1].twist.twist.angular.z == 0.0)
    wait("a follower tells of its link", lambda: links)
    driven.child.send_signal(signal.SIGTERM)
    driven.child.communicate(timeout=DEADLINE_S)
    assert driven.child.returncode == 128 + signal.SIGTERM
    path = driven.out / "mission.mcap"
    again = replay(LogFile(path))
    assert (again.divergences, again.foreign) == (0, (4,))
    assert judge(LogFile(path)).violations == ()
    poses = open_log(path).table("poses").of(4)
    of_tick = dict(zip(poses["tick"].tolist(), poses.rows("x", "y"), strict=True))
    heard_of = set()
    for message in odometry:
        stamp = message.header.stamp
        tick = (stamp.sec * 1_000_000_000 + stamp.nanosec - LOG_EPOCH_NS) // 50_000_000
        where = message.pose.pose.position
        assert (where.x, where.y) == of_tick[tick]
        heard_of.add(tick)
    assert len(heard_of) > 0.9 * (max(heard_of) - min(heard_of))  # at 20 ticks a second none is left out


def test_a_log_is_published_afterwards_too_with_the_keys_of_humble(tmp_path: Path) -> None:
    """Humble has no type hashes: its nodes see topics with a word in their place."""
    import zenoh

    Mission(tmp_path, "clock.limit_s=1").finish()
    router = free_endpoint()
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", f'["{router}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    heard: list[str] = []
    with zenoh.open(config) as session:
        session.declare_subscriber("7/**", lambda sample: heard.append(str(sample.key_expr)))
        command = [sys.executable, "-m", "onehop.ros2", str(tmp_path / "out" / "mission.mcap")]
        command += ["--router", router, "--domain", "7", "--distro", "humble"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        assert (done.returncode, done.stdout) == (0, f"ROS 2 topics at {router}: by the router there\n")
        wait("it came", lambda: "7/clock/rosgraph_msgs::msg::dds_::Clock_/TypeHashNotSupported" in heard)
    assert {key.rpartition("/")[2] for key in heard} == {"TypeHashNotSupported"}


def test_without_a_router_nothing_starts(tmp_path: Path) -> None:
    """On another host no router of our own is opened; 192.0.2.1 is nobody's (RFC 5737)."""
    scenario = Path(__file__).parents[2] / "scenarios" / "map1.toml"
    command = [sys.executable, "-m", "onehop", "run", str(scenario), "--out", str(tmp_path / "out")]
    command += ["--ros2", "--ros-router", "tcp/192.0.2.1:7447"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert "no router at tcp/192.0.2.1:7447: start rmw_zenohd there, or give its address" in done.stderr
    assert "the bridge to ROS 2 did not start" in done.stderr
    assert not (tmp_path / "out" / "mission.mcap").exists()
