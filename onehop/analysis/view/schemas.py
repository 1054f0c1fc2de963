"""Protobuf schemas of the viewer layer: Foxglove's own, and one of ours for the link of a robot."""

from typing import Any

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LaserScan_pb2 import LaserScan
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf import descriptor_pool, message_factory, timestamp_pb2
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet

LINK_FIELDS = (
    "throughput_bps", "threshold_bps", "snr_db", "bit_error_rate", "k_rho_per_s", "error_m",
    "distance_m",
)  # fmt: skip
"""Numbers of onehop.Link, after its timestamp; nan where there is nothing to tell."""


def _link_file() -> FileDescriptorProto:
    file = FileDescriptorProto(
        name="onehop/link.proto", package="onehop", syntax="proto3",
        dependency=[timestamp_pb2.DESCRIPTOR.name],
    )  # fmt: skip
    message = file.message_type.add(name="Link")
    message.field.add(
        name="timestamp", number=1, label=FieldDescriptorProto.LABEL_OPTIONAL,
        type=FieldDescriptorProto.TYPE_MESSAGE, type_name=".google.protobuf.Timestamp",
    )  # fmt: skip
    for number, name in enumerate(LINK_FIELDS, start=2):
        message.field.add(
            name=name, number=number, label=FieldDescriptorProto.LABEL_OPTIONAL,
            type=FieldDescriptorProto.TYPE_DOUBLE,
        )  # fmt: skip
    return file


def _link_class() -> Any:
    pool = descriptor_pool.DescriptorPool()
    pool.AddSerializedFile(timestamp_pb2.DESCRIPTOR.serialized_pb)
    pool.Add(_link_file())
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("onehop.Link"))


Link: Any = _link_class()
"""Quality of a robot's link to its leader: plotted by Foxglove and Rerun alike."""


def schema_of(kind: Any) -> tuple[str, bytes]:
    """Full name and serialized FileDescriptorSet, as MCAP wants it for encoding `protobuf`."""
    files = FileDescriptorSet()
    seen: set[str] = set()

    def add(descriptor: Any) -> None:
        if descriptor.name in seen:
            return
        seen.add(descriptor.name)
        for dependency in descriptor.dependencies:
            add(dependency)
        descriptor.CopyToProto(files.file.add())

    add(kind.DESCRIPTOR.file)
    return kind.DESCRIPTOR.full_name, files.SerializeToString()


__all__ = [
    "FrameTransforms", "LaserScan", "Link", "Log", "PointCloud", "PoseInFrame", "SceneUpdate",
    "schema_of",
]  # fmt: skip
