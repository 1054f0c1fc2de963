"""Settings of libraries that are this project's own, whatever the shell says."""

import os


def keep_to_own_settings() -> None:
    """Forget what this shell says to libraries that take it for granted: a wrong word there ends them.

    Zenoh's threads are set by `bus.ONE_THREAD`. Figures are files; a notebook names a backend to
    matplotlib that its own environment has, and not this one.
    """
    os.environ.pop("ZENOH_RUNTIME", None)
    os.environ["MPLBACKEND"] = "agg"
