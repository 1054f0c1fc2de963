"""Who leads, and since when, from what the robots say of themselves: one rule for mission and log.

A robot acts as leader while it says that it obeys itself. Each roster on which it acts (epoch, members,
shape) is one leadership term; it lasts until the robot acts on another one, obeys somebody else, or
leaves. In a team that is split, several robots act as leaders at once.
"""

from onehop.contracts.messages import LeadershipTerm


class LeadershipHistory:
    """Every leadership term so far, and who acts as leader now. Feed it in order of time.

    terms: in the order in which they began. acting: the present term of each acting leader.
    """

    def __init__(self) -> None:
        self.terms: list[LeadershipTerm] = []
        self.acting: dict[int, LeadershipTerm] = {}

    def on_status(
        self, at_s: float, robot: int, leader: int, epoch: int, members: tuple[int, ...], shape: str
    ) -> None:
        """A robot's words about itself (team.Status) take effect at at_s [s]."""
        if leader != robot:
            self.acting.pop(robot, None)
            return
        term = self.acting.get(robot)
        if term is None or (term.epoch, term.members, term.shape) != (epoch, members, shape):
            self.acting[robot] = LeadershipTerm(at_s, robot, epoch, members, shape)
            self.terms.append(self.acting[robot])

    def on_departure(self, robot: int) -> None:
        """A robot has left the mission; should it return, its next term is a new one."""
        self.acting.pop(robot, None)
