"""Work for workers: functions of a module that their processes can import."""

import os
import signal
import time


def double(number: int) -> int:
    return 2 * number


def fail_at_three(number: int) -> int:
    if number == 3:
        raise ValueError("three")
    return number


def die_at_three(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.05)
    return number


def own_pid(seconds: float) -> int:
    time.sleep(seconds)
    return os.getpid()
