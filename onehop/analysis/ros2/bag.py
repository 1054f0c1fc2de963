"""Write a log as a rosbag2 folder: metadata.yaml, and an MCAP file of profile ros2."""

import os
import tempfile
from pathlib import Path
from typing import Any, Literal

from onehop.analysis.log import Log
from onehop.analysis.ros2.publications import DEPTH, LASTING_DEPTH, Publications, lasts
from onehop.analysis.ros2.types import typestore
from onehop.contracts.errors import DecodeError, InputError
from onehop.wire.audit import Audit
from onehop.wire.log_reader import forged
from onehop.wire.output_folder import explained

VERSION: Literal[9] = 9
"""Of the folder's metadata (Jazzy and later); Humble and Iron read it after `ros2 bag reindex`."""

REMEDY = "a new folder, where one can be made"


def write_bag(log: Log, out: Path) -> tuple[dict[str, int], list[str]]:
    """Write a log as a new folder, whole or not at all.

    Returns messages by topic, and the flaws of the log (audit.py). Raises InputError for a folder that
    is there already, LogError when the log is damaged.
    """
    store = typestore()
    from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

    if out.exists():
        raise InputError(str(out), "exists already", REMEDY)
    audit = Audit(log.file)
    with explained(out, REMEDY):
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=out.parent, prefix=".onehop-") as draft:
            folder = Path(draft) / out.name
            writer = Writer(folder, version=VERSION, storage_plugin=StoragePlugin.MCAP)
            writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
            with writer:
                counts = _fill(writer, store, log, audit)
            os.rename(folder, out)
    return dict(sorted(counts.items())), audit.flaws


def _fill(writer: Any, store: Any, log: Log, audit: Audit) -> dict[str, int]:
    """Write every tick; returns messages by topic."""
    publications = Publications(log, store)
    connections: dict[str, Any] = {}
    counts: dict[str, int] = {}
    try:
        for tick in audit.ticks():
            for topic, kind, at_ns, message in publications.of(tick):
                if topic not in connections:
                    connections[topic] = writer.add_connection(
                        topic, kind, typestore=store, offered_qos_profiles=[_qos(topic)]
                    )
                writer.write(connections[topic], at_ns, store.serialize_cdr(message, kind))
                counts[topic] = counts.get(topic, 0) + 1
    except DecodeError as error:
        raise forged(log.path, error) from None
    return counts


def _qos(topic: str) -> Any:
    """What a publisher of this topic offers: reliable, and kept for late listeners where it lasts."""
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    never = QosTime(9223372036, 854775807)
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=LASTING_DEPTH if lasts(topic) else DEPTH,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if lasts(topic) else QosDurability.VOLATILE,
        deadline=never,
        lifespan=never,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=never,
        avoid_ros_namespace_conventions=False,
    )
