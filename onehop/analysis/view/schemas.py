"""Protobuf schemas of the viewer layer: Foxglove's own, and ours for a robot's link and its values."""

from typing import Any

from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.LaserScan_pb2 import LaserScan
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf import descriptor_pool, message_factory, timestamp_pb2
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

LINK_FIELDS = (
    "throughput_bps", "threshold_bps", "snr_db", "bit_error_rate", "k_rho_per_s", "error_m",
    "distance_m",
)  # fmt: skip
"""Numbers of onehop.Link, after its timestamp; nan where there is nothing to tell."""


def _link_file() -> FileDescriptorProto:
    file, message = _stamped_file("Link")
    for number, name in enumerate(LINK_FIELDS, start=2):
        message.field.add(
            name=name, number=number, label=FieldDescriptorProto.LABEL_OPTIONAL,
            type=FieldDescriptorProto.TYPE_DOUBLE,
        )  # fmt: skip
    return file


def _values_file() -> FileDescriptorProto:
    file, message = _stamped_file("Values")
    one = file.message_type.add(name="Value")
    for number, (name, kind) in enumerate(
        (("name", FieldDescriptorProto.TYPE_STRING), ("value", FieldDescriptorProto.TYPE_DOUBLE)),
        start=1,
    ):
        one.field.add(name=name, number=number, label=FieldDescriptorProto.LABEL_OPTIONAL, type=kind)
    message.field.add(
        name="values", number=2, label=FieldDescriptorProto.LABEL_REPEATED,
        type=FieldDescriptorProto.TYPE_MESSAGE, type_name=".onehop.Value",
    )  # fmt: skip
    return file


def _stamped_file(name: str) -> tuple[FileDescriptorProto, DescriptorProto]:
    """A file with one message, which begins with a timestamp."""
    file = FileDescriptorProto(
        name=f"onehop/{name.lower()}.proto", package="onehop", syntax="proto3",
        dependency=[timestamp_pb2.DESCRIPTOR.name],
    )  # fmt: skip
    message = file.message_type.add(name=name)
    message.field.add(
        name="timestamp", number=1, label=FieldDescriptorProto.LABEL_OPTIONAL,
        type=FieldDescriptorProto.TYPE_MESSAGE, type_name=".google.protobuf.Timestamp",
    )  # fmt: skip
    return file, message


def _class_of(file: FileDescriptorProto) -> Any:
    """The class of the first message in a file."""
    pool = descriptor_pool.DescriptorPool()
    pool.AddSerializedFile(timestamp_pb2.DESCRIPTOR.serialized_pb)
    pool.Add(file)
    name = f"onehop.{file.message_type[0].name}"
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


Link: Any = _class_of(_link_file())
"""Quality of a robot's link to its leader: plotted by Foxglove and Rerun alike."""

Values: Any = _class_of(_values_file())
"""What a program shows of itself: numbers by name."""


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
    "Values", "schema_of",
]  # fmt: skip
