"""Blocks of a run to MCAP messages."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cube_sim.recording.batch import Batch, Rows
from cube_sim.recording.channels import Channel
from cube_sim.recording.header import RunHeader
from cube_sim.recording.mcap.fixed_width import channel_layout
from cube_sim.recording.mcap.foxglove import FrameTransformLayout, log_message
from cube_sim.recording.mcap.schemas import (
    FRAME_TRANSFORM,
    LOG,
    channel_schema,
    channel_schema_name,
    frame_transform_schema,
    log_schema,
)
from cube_sim.recording.mcap.writer import McapWriter, MessageBatch, message_records
from cube_sim.run_log import LogLine

# 2000-01-01T00:00:00Z. Simulated time starts here in every recording: a recording has no wall clock.
EPOCH_NS = 946_684_800 * 1_000_000_000

FORMAT = "1"
TRANSFORM_TOPIC = "/tf"
LOG_TOPIC = "/log"
SCENARIO, RESOLVED, MODEL, ASSETS, CODE = "scenario.yaml", "resolved.yaml", "model.xml", "assets/", "python/"
RUN_METADATA, VERSIONS_METADATA, CODE_METADATA, CODE_DIGESTS = "cube_sim", "versions", "python", "python_sha256"
CHANNEL_METADATA = "channel"


class McapSink:
    """Writes a run to an MCAP file: the header first, then one chunk per batch."""

    def __init__(self, path: Path, header: RunHeader, channels: Sequence[Channel], vehicle: str) -> None:
        self._writer = McapWriter(path)
        self._vehicle = vehicle
        self._write_header(header)
        self._layouts = {channel.name: channel_layout(channel) for channel in channels}
        self._ids = {
            channel.name: self._writer.add_channel(
                topic(channel),
                channel_schema_name(channel),
                channel_schema(channel),
                {CHANNEL_METADATA: json.dumps(asdict(channel), sort_keys=True)},
            )
            for channel in channels
        }
        self._transform = FrameTransformLayout(vehicle)
        self._transform_id = self._writer.add_channel(TRANSFORM_TOPIC, FRAME_TRANSFORM, frame_transform_schema())
        self._log_id = self._writer.add_channel(LOG_TOPIC, LOG, log_schema())
        self._sequences = dict.fromkeys(range(1, self._log_id + 1), 0)

    def write(self, batch: Batch) -> None:
        """Write a batch as one chunk and hand it to the operating system."""
        self._writer.write_chunk(self._encode(batch))

    def close(self) -> None:
        """Write the index and close the file."""
        self._writer.close()

    def _encode(self, batch: Batch) -> Iterator[MessageBatch]:
        for name, rows in batch.rows.items():
            layout, channel_id = self._layouts[name], self._ids[name]
            stamps = _stamps(rows)
            records, messages = message_records(channel_id, stamps, self._count(channel_id, rows), layout.length)
            layout.write(rows, messages)
            yield _message_batch(channel_id, stamps, records)
        if "pose" in batch.rows:
            rows = batch.rows["pose"]
            stamps = _stamps(rows)
            first = self._count(self._transform_id, rows)
            records, messages = message_records(self._transform_id, stamps, first, self._transform.length)
            self._transform.write(rows, stamps, messages)
            yield _message_batch(self._transform_id, stamps, records)
        if batch.log:
            yield self._encode_log(batch.log)

    def _encode_log(self, log: Sequence[LogLine]) -> MessageBatch:
        stamps = np.array([stamp_ns(line.t) for line in log], np.uint64)
        first, parts = self._count(self._log_id, log), []
        for i, line in enumerate(log):
            data = log_message(int(stamps[i]), line.level, line.text, self._vehicle)
            records, messages = message_records(self._log_id, stamps[i : i + 1], first + i, len(data))
            messages[0] = np.frombuffer(data, np.uint8)
            parts.append(records.tobytes())
        ends = np.cumsum([len(part) for part in parts])
        return MessageBatch(self._log_id, stamps, b"".join(parts), (ends - ends[0]).astype(np.uint64))

    def _count(self, channel_id: int, new: Rows | Sequence[LogLine]) -> int:
        """Give the sequence number of the first of the new messages."""
        first = self._sequences[channel_id]
        self._sequences[channel_id] = first + len(new)
        return first

    def _write_header(self, header: RunHeader) -> None:
        self._writer.add_metadata(RUN_METADATA, {"format": FORMAT, "seed": str(header.seed), "vehicle": self._vehicle})
        self._writer.add_metadata(VERSIONS_METADATA, dict(sorted(header.versions.items())))
        if header.code:
            self._writer.add_metadata(CODE_METADATA, {code.key: code.name for code in header.code})
            self._writer.add_metadata(CODE_DIGESTS, {code.key: code.digest for code in header.code})
        files = [
            (SCENARIO, "application/yaml", header.scenario.encode()),
            (RESOLVED, "application/yaml", header.resolved.encode()),
            (MODEL, "application/xml", header.mjcf.encode()),
        ]
        files += [(ASSETS + name, "application/octet-stream", data) for name, data in sorted(header.assets.items())]
        files += [(CODE + code.file, "text/x-python", code.source.encode()) for code in header.code if code.source]
        for name, media_type, data in files:
            self._writer.add_attachment(name, media_type, data, EPOCH_NS)


def topic(channel: Channel) -> str:
    """MCAP topic of a channel."""
    return f"/{channel.name}"


def stamp_ns(t: float) -> int:
    """Time stamp [ns] of a simulated time t [s]."""
    return EPOCH_NS + round(t * 1e9)


def _stamps(rows: Rows) -> NDArray[np.uint64]:
    return (np.rint(rows[:, 0] * 1e9).astype(np.int64) + EPOCH_NS).astype(np.uint64)


def _message_batch(channel_id: int, stamps: NDArray[np.uint64], records: NDArray[np.uint8]) -> MessageBatch:
    n, length = records.shape
    return MessageBatch(channel_id, stamps, records.tobytes(), np.arange(n, dtype=np.uint64) * np.uint64(length))
