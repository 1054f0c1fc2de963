"""What a robot's radio card tells it of who is around (`radio.neighbours` of a scenario)."""

from onehop.contracts.values import Value


class Neighbour(Value, frozen=True):
    """The last frame that a robot's card received of another robot, whoever it was for.

    robot: that transmitted it. snr_db: above noise, jams and other frames. rssi_dbm: received power.
    time_ns: of its end. frames: how many the card received of this robot since its last report.
    """

    robot: int
    snr_db: float
    rssi_dbm: float
    time_ns: int
    frames: int
