"""`python -m onehop.ros2 LOG`: publish a log to ROS 2 nodes, while it is written or afterwards."""

import argparse
import os
import threading
from pathlib import Path

from onehop.analysis.ros2.types import typestore
from onehop.node import startup
from onehop.ros2 import DEFAULT_ROUTER
from onehop.ros2.bridge import Bridge
from onehop.ros2.node import RosNode, open_router, open_session

MOST_DOMAIN = 232
"""The largest ROS_DOMAIN_ID: beyond it DDS would have no port left."""


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m onehop.ros2", description=__doc__)
    parser.add_argument("log", type=Path, metavar="LOG", help="mission.mcap; it is waited for")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--router", default=DEFAULT_ROUTER, metavar="ENDPOINT", help="of rmw_zenoh")
    place.add_argument("--listen", metavar="ENDPOINT", help="be that router, for other hosts too")
    parser.add_argument("--domain", type=_domain, default=0, metavar="N", help="ROS_DOMAIN_ID")
    parser.add_argument("--distro", choices=("humble", "jazzy"), default="jazzy", help="jazzy: or later")
    parser.add_argument("--new", action="store_true", help="a log that is there already is not meant")
    parser.add_argument("--until-stdin-closes", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    older_ns = options.log.stat().st_mtime_ns if options.new and options.log.exists() else None
    store = typestore()
    if options.listen is not None:
        session, at, where = open_router(options.listen), options.listen, "a router of our own"
    else:
        session, is_own = open_session(options.router)
        at, where = options.router, "by the router there"
        if is_own:
            where = "a router of our own, since none was there"
    print(f"ROS 2 topics at {at}: {where}", flush=True)
    ended = threading.Event()
    if options.until_stdin_closes:
        threading.Thread(target=_wait, args=(ended,), name="stdin", daemon=True).start()
    with RosNode(session, "onehop", store, options.domain, options.distro != "humble") as node:
        Bridge(options.log, node, store, older_ns).run(ended.is_set)
    return 0


def _domain(text: str) -> int:
    if not (text.isascii() and text.isdigit() and int(text) <= MOST_DOMAIN):
        raise argparse.ArgumentTypeError(f"{text!r} is no domain: 0 to {MOST_DOMAIN}")
    return int(text)


def _wait(ended: threading.Event) -> None:
    while os.read(0, 1):
        pass
    ended.set()


if __name__ == "__main__":
    startup.main(main)
