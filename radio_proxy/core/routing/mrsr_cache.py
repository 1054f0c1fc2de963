"""The route cache of DSR: whole paths, several a destination (RFC 4728, 4.1)."""

CACHE_TIMEOUT_NS = 300 * 1_000_000_000
"""RouteCacheTimeout (RFC 4728, section 9)."""

PATHS_PER_DESTINATION = 4
"""Bound of the cache; longer and older paths make room."""

Path = tuple[int, ...]


class RouteCache:
    """Paths that begin at one robot, the shortest first, the newest first among equals."""

    def __init__(self, robot: int) -> None:
        self._robot = robot
        self._paths: dict[int, list[tuple[Path, int]]] = {}

    def add(self, path: Path, now: int) -> None:
        """Learn a path to everyone on it; one with a loop or from elsewhere is refused."""
        if path[0] != self._robot or len(set(path)) != len(path):
            return
        for length in range(2, len(path) + 1):
            self._add_one(path[:length], now + CACHE_TIMEOUT_NS)

    def find(self, destination: int, now: int) -> Path | None:
        """The best path to a destination."""
        for path, expires in self._paths.get(destination, ()):
            if expires > now:
                return path
        return None

    def forget_link(self, a: int, b: int) -> None:
        """Drop every path that uses the broken link in either direction (RFC 4728, 8.3.5).

        The part of a path before the break stands under its own destination.
        """
        for destination in sorted(self._paths):
            kept = [entry for entry in self._paths[destination] if not _uses(entry[0], a, b)]
            if kept:
                self._paths[destination] = kept
            else:
                del self._paths[destination]

    def paths(self) -> tuple[Path, ...]:
        """Everything that is cached, by destination."""
        return tuple(path for to in sorted(self._paths) for path, _ in self._paths[to])

    def _add_one(self, path: Path, expires: int) -> None:
        others = [entry for entry in self._paths.get(path[-1], ()) if entry[0] != path]
        ranked = sorted([(path, expires), *others], key=lambda entry: len(entry[0]))
        self._paths[path[-1]] = ranked[:PATHS_PER_DESTINATION]


def _uses(path: Path, a: int, b: int) -> bool:
    return any(path[i : i + 2] in ((a, b), (b, a)) for i in range(len(path) - 1))
