"""Who is told of a campaign while it goes on."""

from typing import Protocol

from onehop.campaign.lines import Row


class Listener(Protocol):
    """Is told of a campaign's missions as they end."""

    def begin(self, before: int) -> None:
        """Missions are tried from now on; so many of those that are wanted were before."""

    def show(self, row: Row) -> None:
        """One more mission is done."""
