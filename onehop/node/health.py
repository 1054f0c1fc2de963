"""Whether the process of this container takes part: `python -m onehop.node.health PORT`.

For health checks. Exit status 0 when something here listens on the bus's port (the world) or is
connected to it (all others). It looks at the kernel's table of connections (Linux) and opens none.
"""

import sys
from pathlib import Path

TABLES = (Path("/proc/net/tcp"), Path("/proc/net/tcp6"))

ESTABLISHED, LISTEN = 1, 10  # include/net/tcp_states.h


def takes_part(table: str, port: int) -> bool:
    """Whether a table of connections, as /proc/net/tcp shows it, has one of the bus."""
    for line in table.splitlines()[1:]:
        own, peer, state = line.split()[1:4]
        end = {LISTEN: own, ESTABLISHED: peer}.get(int(state, 16))
        if end is not None and int(end.rpartition(":")[2], 16) == port:
            return True
    return False


def main() -> int:
    port = int(sys.argv[1])
    return 0 if any(takes_part(path.read_text(), port) for path in TABLES if path.exists()) else 1


if __name__ == "__main__":
    sys.exit(main())
