"""What all tests with processes share."""

from collections.abc import Iterator

import pytest

from tests.live.mission import STARTED


@pytest.fixture(autouse=True)
def _no_mission_outlives_its_test() -> Iterator[None]:
    """A test that fails must not leave a mission to the next one."""
    yield
    while STARTED:
        child = STARTED.pop().child
        if child.poll() is None:
            child.kill()
        if child.stdout is not None and not child.stdout.closed:
            child.communicate()
