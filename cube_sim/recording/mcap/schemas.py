"""Protobuf schemas of what a recording holds, as the descriptor sets an MCAP carries.

A channel's schema follows from the channel table. ``foxglove.FrameTransform`` and ``foxglove.Log`` are the
public schemas of those names (github.com/foxglove/foxglove-sdk, schemas/proto/foxglove): any viewer that
knows them shows the vehicle and the log of a run without knowing this program.
"""

from __future__ import annotations

from collections.abc import Sequence

from google.protobuf import timestamp_pb2
from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

from cube_sim.recording.channels import Channel
from cube_sim.recording.mcap.named_fields import Code, Group, Numbers, Part, identifier, parts_of

PACKAGE = "cube_sim"
FRAME_TRANSFORM = "foxglove.FrameTransform"
LOG = "foxglove.Log"
LOG_LEVELS = ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL")

_Kind = FieldDescriptorProto.Type.ValueType


def channel_schema_name(channel: Channel) -> str:
    """Full protobuf name of a channel's message, e.g. ``cube_sim.PathError``."""
    return f"{PACKAGE}.{_camel(channel.name)}"


def channel_schema(channel: Channel) -> bytes:
    """Serialise the descriptor set of a channel's message."""
    file = _file(PACKAGE, channel.name)
    message = file.message_type.add(name=_camel(channel.name))
    _scalar(message, 1, "t", FieldDescriptorProto.TYPE_DOUBLE)
    _declare(message, parts_of(channel), 2, f".{channel_schema_name(channel)}")
    return _set(file)


def _declare(message: DescriptorProto, parts: Sequence[Part], first: int, scope: str) -> None:
    """Add fields to a message, and what they are made of.

    Args:
        message: the message.
        parts: the fields.
        first: number of the first.
        scope: full name of the message.
    """
    for number, part in enumerate(parts, start=first):
        name = identifier(part.name)
        if isinstance(part, Group):
            inner = message.nested_type.add(name=f"{_camel(name)}Columns")
            _message(message, number, name, f"{scope}.{inner.name}")
            if part.listed:
                message.field[-1].label = FieldDescriptorProto.LABEL_REPEATED
            _declare(inner, part.elements[0], 1, f"{scope}.{inner.name}")
        elif isinstance(part, Code):
            inner = message.nested_type.add(name=f"{_camel(name)}Code")  # labels of two codes may be the same
            values = inner.enum_type.add(name="Code")
            for value, label in enumerate(part.labels):
                values.value.add(name=identifier(label), number=value)
            field = _scalar(message, number, name, FieldDescriptorProto.TYPE_ENUM)
            field.type_name = f"{scope}.{inner.name}.Code"
        else:
            field = _scalar(message, number, name, FieldDescriptorProto.TYPE_DOUBLE)
            if isinstance(part, Numbers):
                field.label = FieldDescriptorProto.LABEL_REPEATED
                field.options.packed = True


def frame_transform_schema() -> bytes:
    """Serialise the descriptor set of ``foxglove.FrameTransform``."""
    file = _file("foxglove", "FrameTransform", timestamp_pb2.DESCRIPTOR.name)
    for name, axes in (("Vector3", "xyz"), ("Quaternion", "xyzw")):
        part = file.message_type.add(name=name)
        for number, axis in enumerate(axes, start=1):
            _scalar(part, number, axis, FieldDescriptorProto.TYPE_DOUBLE)
    message = file.message_type.add(name="FrameTransform")
    _message(message, 1, "timestamp", ".google.protobuf.Timestamp")
    _scalar(message, 2, "parent_frame_id", FieldDescriptorProto.TYPE_STRING)
    _scalar(message, 3, "child_frame_id", FieldDescriptorProto.TYPE_STRING)
    _message(message, 4, "translation", ".foxglove.Vector3")
    _message(message, 5, "rotation", ".foxglove.Quaternion")
    return _set(_timestamp_file(), file)


def log_schema() -> bytes:
    """Serialise the descriptor set of ``foxglove.Log``."""
    file = _file("foxglove", "Log", timestamp_pb2.DESCRIPTOR.name)
    levels = file.enum_type.add(name="LogLevel")
    for number, level in enumerate(LOG_LEVELS):
        levels.value.add(name=level, number=number)
    message = file.message_type.add(name="Log")
    _message(message, 1, "timestamp", ".google.protobuf.Timestamp")
    level_field = _scalar(message, 2, "level", FieldDescriptorProto.TYPE_ENUM)
    level_field.type_name = ".foxglove.LogLevel"
    _scalar(message, 3, "message", FieldDescriptorProto.TYPE_STRING)
    _scalar(message, 4, "name", FieldDescriptorProto.TYPE_STRING)
    _scalar(message, 5, "file", FieldDescriptorProto.TYPE_STRING)
    _scalar(message, 6, "line", FieldDescriptorProto.TYPE_FIXED32)
    return _set(_timestamp_file(), file)


def _camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def _file(package: str, name: str, *imports: str) -> FileDescriptorProto:
    return FileDescriptorProto(name=f"{package}/{name}.proto", package=package, syntax="proto3", dependency=imports)


def _timestamp_file() -> FileDescriptorProto:
    file = FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(file)
    return file


def _scalar(message: DescriptorProto, number: int, name: str, kind: _Kind) -> FieldDescriptorProto:
    return message.field.add(name=name, number=number, type=kind, label=FieldDescriptorProto.LABEL_OPTIONAL)


def _message(message: DescriptorProto, number: int, name: str, type_name: str) -> None:
    _scalar(message, number, name, FieldDescriptorProto.TYPE_MESSAGE).type_name = type_name


def _set(*files: FileDescriptorProto) -> bytes:
    return FileDescriptorSet(file=files).SerializeToString(deterministic=True)
