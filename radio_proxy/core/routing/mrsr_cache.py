"""The route cache of DSR: whole paths, several a destination (RFC 4728, 4.1)."""

from radio_proxy.core.addresses import RobotId

CACHE_TIMEOUT_NS = 300 * 1_000_000_000
"""RouteCacheTimeout (RFC 4728, section 9)."""

PATHS_PER_DESTINATION = 4
"""Bound of the cache; longer and older paths make room."""

Path = tuple[RobotId, ...]


class RouteCache:
    """Paths that begin at one robot: when each expires [ns], by destination."""

    def __init__(self, robot: RobotId) -> None:
        self._robot = robot
        self._paths: dict[RobotId, dict[Path, int]] = {}

    def add(self, path: Path, now: int) -> None:
        """Learn a path to everyone on it; one with a loop or from elsewhere is refused."""
        if path[0] != self._robot or len(set(path)) != len(path):
            return
        for length in range(2, len(path) + 1):
            known = self._paths.setdefault(path[length - 1], {})
            known[path[:length]] = now + CACHE_TIMEOUT_NS
            if len(known) > PATHS_PER_DESTINATION:
                del known[_ranked(known)[-1]]

    def find(self, destination: RobotId, now: int) -> Path | None:
        """The best path to a destination: the shortest, the newest among equals."""
        known = self._paths.get(destination)
        if known is not None:
            for path in _ranked(known) if len(known) > 1 else known:
                if known[path] > now:
                    return path
        return None

    def remove_link(self, a: RobotId, b: RobotId) -> None:
        """Drop every path that uses the broken link in either direction (RFC 4728, 8.3.5).

        The part of a path before the break stands under its own destination.
        """
        for destination, known in tuple(self._paths.items()):
            for path in tuple(known):
                if a in path and b in path and abs(path.index(a) - path.index(b)) == 1:
                    del known[path]
            if not known:
                del self._paths[destination]

    def paths(self) -> tuple[Path, ...]:
        """Everything that is cached, by destination, the best first."""
        return tuple(path for to in sorted(self._paths) for path in _ranked(self._paths[to]))


def _ranked(known: dict[Path, int]) -> list[Path]:
    return sorted(known, key=lambda path: (len(path), -known[path], path))
