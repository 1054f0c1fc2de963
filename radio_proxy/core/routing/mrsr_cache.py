"""The route cache of DSR: whole paths, several a destination (RFC 4728, 4.1)."""

CACHE_TIMEOUT_NS = 300 * 1_000_000_000
"""RouteCacheTimeout (RFC 4728, section 9)."""

CACHE_PATHS = 64
"""Bound of the cache; the path that was added first makes room."""


class RouteCache:
    """Paths that begin at one robot; every beginning of a path is a route as well."""

    def __init__(self, robot: int) -> None:
        self._robot = robot
        self._paths: dict[tuple[int, ...], int] = {}

    def add(self, path: tuple[int, ...], now: int) -> None:
        """Learn a path; one that visits a robot twice or does not begin here is refused."""
        if len(path) < 2 or path[0] != self._robot or len(set(path)) != len(path):
            return
        self._paths.pop(path, None)
        self._paths[path] = now + CACHE_TIMEOUT_NS
        if len(self._paths) > CACHE_PATHS:
            del self._paths[next(iter(self._paths))]

    def find(self, destination: int, now: int) -> tuple[int, ...] | None:
        """The shortest path to a destination, the newest of equally short ones."""
        best: tuple[int, ...] | None = None
        for path, expires in list(self._paths.items()):
            if expires <= now:
                del self._paths[path]
            elif destination in path[1:]:
                length = path.index(destination) + 1
                if best is None or length <= len(best):
                    best = path[:length]
        return best

    def forget_link(self, a: int, b: int) -> None:
        """Cut every path before the broken link, in whichever direction it uses it (RFC 4728, 8.3.5)."""
        paths, self._paths = self._paths, {}
        for path, expires in paths.items():
            keep = len(path)
            for i in range(len(path) - 1):
                if path[i : i + 2] in ((a, b), (b, a)):
                    keep = i + 1
                    break
            if keep > 1:
                self._paths.setdefault(path[:keep], expires)

    def paths(self) -> tuple[tuple[int, ...], ...]:
        """Everything that is cached, oldest first."""
        return tuple(self._paths)
