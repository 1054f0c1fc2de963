"""A health check from the kernel's table of connections."""

import socket

from onehop.node.health import TABLES, takes_part


def test_who_listens_or_is_connected_takes_part() -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        assert takes_part(TABLES[0].read_text(), port)
        client = socket.create_connection(("127.0.0.1", port))
        taken, _ = server.accept()
    with taken, client:
        assert takes_part(TABLES[0].read_text(), port)
    assert not takes_part(TABLES[0].read_text(), port)
