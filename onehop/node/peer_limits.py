"""What one slow or hostile peer can cost: its own place on the bus within a second, nobody else's.

A robot's link is written from the thread of the sender. Zenoh sets no limit to such a write, so a peer
that lets the buffers of its connection fill up would stop the world for as long as it likes. The kernel
does set one, TCP_USER_TIMEOUT (RFC 5482): it cuts a connection whose peer has taken nothing for that
long. Connections inherit it from the socket that listens. Other systems than Linux have only the lease.
"""

from typing import Any

UNREAD_MS = 1000
"""How long what was sent to a peer may lie unread once the buffers of its connection are full. A process
that runs reads all the time: Zenoh's own thread does, whatever the rest of the process is at."""

PENDING = 1000
"""Connections that may have yet to say who they are; each has 10 s for it. With Zenoh's 100 some hundred
silent ones keep everyone else out."""

LONGEST_MESSAGE_BYTES = 1 << 26
"""Longest message that the router puts together, instead of Zenoh's 1 GiB: what the radio carries for a
team of 300 in a second is shorter."""

SETTINGS: dict[str, Any] = {
    "transport/unicast/accept_pending": PENDING,
    "transport/link/rx/max_message_size": LONGEST_MESSAGE_BYTES,
    "transport/link/tx/queue/congestion_control/block/wait_before_close": 1000 * UNREAD_MS,
}
"""Zenoh's own settings of the router that serve the same end."""
