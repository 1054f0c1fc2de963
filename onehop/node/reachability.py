"""Why a bus is not reached: Zenoh only says that the time is up."""

import socket
import ssl

from onehop.node.identity import AUTHORITY, CERTIFICATE, KEY, TLS, Certificate, Identity

TRY_S = 3.0
"""How long each step of the trial may take [s]."""


def why_not(endpoint: str, identity: Identity | None) -> str:
    """What is wrong with the way to an endpoint, as far as a trial shows it."""
    host, _, port = endpoint.partition("/")[2].rpartition(":")
    host = host.strip("[]")
    try:
        with socket.create_connection((host, int(port)), timeout=TRY_S) as connection:
            if endpoint.startswith(TLS) and isinstance(identity, Certificate):
                _shake_hands(connection, host, identity)
    except ssl.SSLCertVerificationError as error:
        return f"the router's certificate is refused here: {error.verify_message}"
    except ssl.SSLError as error:
        return f"this certificate is refused there: {(error.reason or str(error)).lower()}"
    except TimeoutError:
        return "nobody answers at this address"
    except OSError as error:
        return (error.strerror or str(error)).lower()
    return "it is reached, and takes no session: is the name in use, or known to this mission?"


def _shake_hands(connection: socket.socket, host: str, own: Certificate) -> None:
    """A TLS handshake as Zenoh's; what the other side refuses comes with the first byte to read."""
    context = ssl.create_default_context(cafile=str(own.folder / AUTHORITY))
    context.load_cert_chain(own.folder / CERTIFICATE, own.folder / KEY)
    with context.wrap_socket(connection, server_hostname=host) as secure:
        secure.settimeout(0.5)
        try:
            secure.recv(1)
        except TimeoutError:
            return  # it waits for us to speak: all is well
