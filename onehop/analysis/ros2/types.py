"""The ROS 2 message types of an exported bag, and the one that is ours.

CDR, definitions and type hashes are the work of the rosbags library (`pip install 'onehop[ros2]'`). The
types are those of Jazzy; that of no type here has changed from Iron to today.
"""

import importlib.util
from functools import cache
from typing import Any

from onehop.contracts.errors import InputError

LINK = "onehop_msgs/msg/Link"

LINK_DEFINITION = """\
# A follower's radio link to its leader, as the robot measures it.
std_msgs/Header header
int32 robot
int32 leader
# Of the last Next or other command of the leader, thesis eq. 3.15 [bit/s]; 0 if it did not come.
float64 throughput_bps
# Below it the follower hurries [bit/s].
float64 threshold_bps
# Of the last message that arrived at the robot, from whomever; nan before the first.
float64 snr_db
float64 bit_error_rate
int32 hops
# Gain of the controller [1/s], and distance from its slot [m].
float64 k_rho
float64 error_m
"""


@cache
def typestore() -> Any:
    """rosbags' types with our own. Raises InputError when rosbags is not installed."""
    for library in ("rosbags", "xxhash"):
        if importlib.util.find_spec(library) is None:
            raise InputError("ROS 2", f"{library} is not installed", "pip install 'onehop[ros2]'")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg(LINK_DEFINITION, LINK))
    return store
