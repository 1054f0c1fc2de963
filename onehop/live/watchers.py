"""Who looks on, and who of them has the buttons: the first one, until somebody takes over."""

from typing import Generic, Protocol, TypeVar


class Watcher(Protocol):
    """Somebody who looks on."""

    def stir(self) -> None:
        """There may be something new."""


W = TypeVar("W", bound=Watcher)


class Watchers(Generic[W]):
    """holder: who has the buttons, None when nobody looks on."""

    def __init__(self) -> None:
        self._all: list[W] = []
        self.holder: W | None = None

    def __len__(self) -> int:
        return len(self._all)

    def join(self, one: W) -> None:
        """Somebody begins to look on."""
        self._all.append(one)
        self.holder = self.holder or one
        self.stir()

    def leave(self, one: W) -> None:
        """Somebody goes; the buttons go to who has looked on for longest."""
        self._all.remove(one)
        if self.holder is one:
            self.holder = self._all[0] if self._all else None
        self.stir()

    def give(self, one: W) -> None:
        """Somebody takes over the buttons."""
        self.holder = one
        self.stir()

    def stir(self) -> None:
        """Tell everyone that there may be something new."""
        for one in self._all:
            one.stir()
