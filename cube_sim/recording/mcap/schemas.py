"""Protobuf schemas of what a recording holds, as the descriptor sets an MCAP carries.

A channel's schema follows from the channel table. ``foxglove.FrameTransform``, ``foxglove.Log`` and, but for texts and
models, ``foxglove.SceneUpdate`` are the public schemas of those names (github.com/foxglove/foxglove-sdk,
schemas/proto/foxglove): any viewer that knows them shows the vehicle and the log of a run without knowing this program.
"""

from __future__ import annotations

from collections.abc import Sequence

from google.protobuf import duration_pb2, timestamp_pb2
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
SCENE_UPDATE = "foxglove.SceneUpdate"
LOG_LEVELS = ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL")

_Kind = FieldDescriptorProto.Type.ValueType
_DOUBLE, _STRING, _BOOL = (
    FieldDescriptorProto.TYPE_DOUBLE,
    FieldDescriptorProto.TYPE_STRING,
    FieldDescriptorProto.TYPE_BOOL,
)
_INT, _FIXED32 = FieldDescriptorProto.TYPE_INT32, FieldDescriptorProto.TYPE_FIXED32
_DELETION = ("SceneEntityDeletion", ("MATCHING_ID", "ALL"))


def channel_schema_name(channel: Channel) -> str:
    """Full protobuf name of a channel's message, e.g. ``cube_sim.PathError``."""
    return f"{_package(channel)}.{_camel(_own_name(channel))}"


def channel_schema(channel: Channel) -> bytes:
    """Serialise the descriptor set of a channel's message."""
    file = _file(_package(channel), _own_name(channel))
    message = file.message_type.add(name=_camel(_own_name(channel)))
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


def scene_update_schema() -> bytes:
    """Serialise the descriptor set of ``foxglove.SceneUpdate``, whole but for what takes an entity away again."""
    file = _file("foxglove", "SceneUpdate", timestamp_pb2.DESCRIPTOR.name, duration_pb2.DESCRIPTOR.name)
    parts = {
        "Vector3": [("x", _DOUBLE), ("y", _DOUBLE), ("z", _DOUBLE)],
        "Point3": [("x", _DOUBLE), ("y", _DOUBLE), ("z", _DOUBLE)],
        "Quaternion": [("x", _DOUBLE), ("y", _DOUBLE), ("z", _DOUBLE), ("w", _DOUBLE)],
        "Color": [("r", _DOUBLE), ("g", _DOUBLE), ("b", _DOUBLE), ("a", _DOUBLE)],
        "Pose": [("position", "Vector3"), ("orientation", "Quaternion")],
        "ArrowPrimitive": [
            *(("pose", "Pose"), ("shaft_length", _DOUBLE), ("shaft_diameter", _DOUBLE), ("head_length", _DOUBLE)),
            *(("head_diameter", _DOUBLE), ("color", "Color")),
        ],
        "CubePrimitive": [("pose", "Pose"), ("size", "Vector3"), ("color", "Color")],
        "SpherePrimitive": [("pose", "Pose"), ("size", "Vector3"), ("color", "Color")],
        "CylinderPrimitive": [
            *(("pose", "Pose"), ("size", "Vector3"), ("bottom_scale", _DOUBLE), ("top_scale", _DOUBLE)),
            ("color", "Color"),
        ],
        "LinePrimitive": [
            *(("type", _INT), ("pose", "Pose"), ("thickness", _DOUBLE), ("scale_invariant", _BOOL)),
            *(("points", "Point3*"), ("color", "Color"), ("colors", "Color*"), ("indices", _FIXED32)),
        ],
        "TriangleListPrimitive": [
            *(("pose", "Pose"), ("points", "Point3*"), ("color", "Color"), ("colors", "Color*")),
            ("indices", _FIXED32),
        ],
        "KeyValuePair": [("key", _STRING), ("value", _STRING)],
        "SceneEntity": [
            *(("timestamp", "Timestamp"), ("frame_id", _STRING), ("id", _STRING), ("lifetime", "Duration")),
            *(("frame_locked", _BOOL), ("metadata", "KeyValuePair*"), ("arrows", "ArrowPrimitive*")),
            *(("cubes", "CubePrimitive*"), ("spheres", "SpherePrimitive*"), ("cylinders", "CylinderPrimitive*")),
            *(("lines", "LinePrimitive*"), ("triangles", "TriangleListPrimitive*")),
        ],
        "SceneEntityDeletion": [("timestamp", "Timestamp"), ("type", _INT), ("id", _STRING)],
        "SceneUpdate": [("deletions", "SceneEntityDeletion*"), ("entities", "SceneEntity*")],
    }
    for name, fields in parts.items():
        part = file.message_type.add(name=name)
        for number, (field, kind) in enumerate(fields, start=1):
            _declare_part(part, number, field, kind)
    for name, values in (("LinePrimitive", ("LINE_STRIP", "LINE_LOOP", "LINE_LIST")), _DELETION):
        (part,) = (each for each in file.message_type if each.name == name)
        kinds = part.enum_type.add(name="Type")
        for number, value in enumerate(values):
            kinds.value.add(name=value, number=number)
        (field,) = (each for each in part.field if each.name == "type")
        field.type, field.type_name = FieldDescriptorProto.TYPE_ENUM, f".foxglove.{name}.Type"
    return _set(_duration_file(), _timestamp_file(), file)


def _declare_part(part: DescriptorProto, number: int, field: str, kind: str | _Kind) -> None:
    if not isinstance(kind, str):
        declared = _scalar(part, number, field, kind)
        if kind == _FIXED32:
            declared.label = FieldDescriptorProto.LABEL_REPEATED
        return
    name = kind.rstrip("*")
    package = "google.protobuf" if name in ("Timestamp", "Duration") else "foxglove"
    _message(part, number, field, f".{package}.{name}")
    if kind.endswith("*"):
        part.field[-1].label = FieldDescriptorProto.LABEL_REPEATED


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


def _package(channel: Channel) -> str:
    """Of one vehicle among several, a package of its own."""
    vehicle = channel.name.rpartition("/")[0]
    return f"{PACKAGE}.{vehicle}" if vehicle else PACKAGE


def _own_name(channel: Channel) -> str:
    return channel.name.rpartition("/")[2]


def _camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def _file(package: str, name: str, *imports: str) -> FileDescriptorProto:
    return FileDescriptorProto(name=f"{package}/{name}.proto", package=package, syntax="proto3", dependency=imports)


def _timestamp_file() -> FileDescriptorProto:
    file = FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(file)
    return file


def _duration_file() -> FileDescriptorProto:
    file = FileDescriptorProto()
    duration_pb2.DESCRIPTOR.CopyToProto(file)
    return file


def _scalar(message: DescriptorProto, number: int, name: str, kind: _Kind) -> FieldDescriptorProto:
    return message.field.add(name=name, number=number, type=kind, label=FieldDescriptorProto.LABEL_OPTIONAL)


def _message(message: DescriptorProto, number: int, name: str, type_name: str) -> None:
    _scalar(message, number, name, FieldDescriptorProto.TYPE_MESSAGE).type_name = type_name


def _set(*files: FileDescriptorProto) -> bytes:
    return FileDescriptorSet(file=files).SerializeToString(deterministic=True)
