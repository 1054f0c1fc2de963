"""A child process that never outlives the launcher, whatever kills it.

The launcher keeps the writing end of a pipe open and never writes. When it dies, by whatever signal, the
kernel closes the pipe and the children read end of file. On Linux the kernel also kills them outright,
which reaches even a child that is stopped.
"""

import ctypes
import os
import signal
import sys
import threading

_PR_SET_PDEATHSIG = 1  # linux/prctl.h


def hold(descriptor: int) -> None:
    """Leave at once when the other end of the pipe `descriptor` closes."""
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    threading.Thread(target=_wait, args=(descriptor,), name="lifeline", daemon=True).start()


def _wait(descriptor: int) -> None:
    while os.read(descriptor, 1):
        pass
    os._exit(1)
