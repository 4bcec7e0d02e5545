"""Batches of a run to MCAP messages."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Batch
from cube_sim.recording.channels import Channel
from cube_sim.recording.digests import ChannelDigest, head_digests, log_digest
from cube_sim.recording.header import RunHeader
from cube_sim.recording.mcap.encoding import INDEX_ENTRY, INDEX_HEAD, STREAM, ReadyMade, Templates, encode
from cube_sim.recording.mcap.fixed_width import Layout, channel_layout, message_record
from cube_sim.recording.mcap.fleet_scene import FleetSceneRows
from cube_sim.recording.mcap.foxglove import frame_transform_layout, log_message
from cube_sim.recording.mcap.names import (
    CHANNEL_METADATA,
    CODE,
    CODE_DIGESTS,
    CODE_METADATA,
    END_METADATA,
    EPOCH_NS,
    FORMAT,
    LOG_TOPIC,
    MODEL_NAME,
    RESOLVED,
    RUN_METADATA,
    SCENARIO,
    TRANSFORM_TOPIC,
    VEHICLES_METADATA,
    VERSIONS_METADATA,
    declaration,
    stamp_ns,
    topic,
)
from cube_sim.recording.mcap.scene import SceneRows
from cube_sim.recording.mcap.schemas import (
    FRAME_TRANSFORM,
    LOG,
    channel_schema,
    channel_schema_name,
    frame_transform_schema,
    log_schema,
)
from cube_sim.recording.mcap.writer import McapWriter, Messages
from cube_sim.recording.run_end import RunEnd, to_texts
from cube_sim.run_log import LogLine

_NOTHING_SAID = ReadyMade(np.empty(0, np.uint8), np.empty(0, np.int64))
_POSE = "pose"
AnySceneRows = SceneRows | FleetSceneRows


class McapSink:
    """Writes a run to an MCAP file: the header first, then one chunk per batch, at last how the run ended."""

    def __init__(
        self,
        path: Path,
        header: RunHeader,
        channels: Sequence[Channel],
        vehicle: str,
        scene: AnySceneRows | None = None,
    ) -> None:
        self._writer = McapWriter(path)
        self._vehicle = vehicle
        self._head = self._write_header(header)
        self._digests = {channel.name: ChannelDigest(channel) for channel in channels}
        self._said: list[LogLine] = []
        layouts = [(channel_layout(channel), -1) for channel in channels]
        self._ids = [
            self._writer.add_channel(
                topic(channel),
                channel_schema_name(channel),
                channel_schema(channel),
                {CHANNEL_METADATA: declaration(channel)},
            )
            for channel in channels
        ]
        self._numbers = {channel.name: k for k, channel in enumerate(channels)}
        self._scene = scene
        for drawn in () if scene is None else scene.topics:
            self._numbers[drawn.topic] = len(layouts)
            layouts.append((drawn.layout, drawn.seconds))
            self._ids.append(self._writer.add_channel(drawn.topic, drawn.schema_name, drawn.schema))
        if not header.vehicles:  # of several each has its own, in its scene
            layouts.append(frame_transform_layout(vehicle))
            self._ids.append(self._writer.add_channel(TRANSFORM_TOPIC, FRAME_TRANSFORM, frame_transform_schema()))
        self._log_id = self._writer.add_channel(LOG_TOPIC, LOG, log_schema())
        self._templates, self._streams = _templates(self._ids, layouts)
        self._lengths = self._streams["length"].tolist()
        self._sequences = [0] * len(self._ids)
        self._lines = 0

    def move_to(self, path: Path) -> None:
        """Go on at another place, in the same folder; what is there is replaced.

        Raises:
            OSError: it cannot be put there.
        """
        self._writer.move_to(path)

    def write(self, batch: Batch) -> None:
        """Write a batch as one chunk and hand it to the operating system."""
        tables = [*batch.rows.items(), *(() if self._scene is None else self._scene.of(batch).items())]
        which, places, at = [], [], 0
        for name, table in tables:
            n, width = table.shape
            which.append(self._numbers[name])
            places.append((at, width, n))
            at += n * width
        if _POSE in batch.rows:
            which.append(len(self._ids) - 1)
            places.append(places[which.index(self._numbers[_POSE])])
        parts, said = [table.reshape(-1) for _, table in tables], _NOTHING_SAID
        numbers = [self._sequences[k] for k in which]
        for k, (_, _, n) in zip(which, places, strict=True):
            self._sequences[k] += n
        if batch.log:
            said = self._say(batch.log)
            parts.append(np.array([line.t for line in batch.log]))
            which.append(len(self._ids))
            places.append((at, 1, len(batch.log)))
            numbers.append(0)
        if parts:
            streams = self._streams[which]
            changing = [(*place, number) for place, number in zip(places, numbers, strict=True)]
            streams.view(np.int64).reshape(len(which), -1)[:, -4:] = changing  # the last four of a `STREAM`
            counts = [n for _, _, n in places]
            size = sum(n * self._lengths[k] for k, n in zip(which, counts, strict=True)) + len(said.records)
            self._writer.write_chunk(self._encoded(streams, counts, size, np.concatenate(parts), said))
        # What is in the file, no more: a full disk may have kept this batch out of it.
        for name, table in batch.rows.items():
            self._digests[name].take(table)
        self._said += batch.log

    def _encoded(
        self, streams: NDArray[np.void], counts: Sequence[int], size: int, numbers: NDArray[np.float64], said: ReadyMade
    ) -> Messages:
        ahead = self._writer.ahead
        chunk = np.empty(ahead + size, np.uint8)
        index = np.empty(len(counts) * INDEX_HEAD + INDEX_ENTRY * sum(counts), np.uint8)
        numbers = np.asarray(numbers, "<f8")
        start, end, fit = encode(streams, self._templates, numbers, numbers.view(np.uint8), said, ahead, chunk, index)
        if not fit:
            raise RecordingError(
                f"{self._writer.path}: a code is a whole number from 0 to 127; one of this second is none"
            )
        channels = list(zip(streams["channel_id"].tolist(), counts, strict=True))
        return Messages(chunk, index, channels, start, end)

    def _say(self, log: Sequence[LogLine]) -> ReadyMade:
        records = []
        for line in log:
            stamp = stamp_ns(line.t)
            message = log_message(stamp, line.level, line.text, self._vehicle)
            records.append(message_record(self._log_id, message, self._lines, stamp))
            self._lines += 1
        ends = np.cumsum([len(record) for record in records])
        return ReadyMade(np.frombuffer(b"".join(records), np.uint8).copy(), ends)

    def finish(self, end: RunEnd) -> None:
        """Write how the run ended; nothing but closing comes after, and once it is closed nothing is written."""
        if self._writer.closed:
            return
        channels = {name: digest.told() for name, digest in self._digests.items()}
        digests = {**self._head, "channels": channels, "log": log_digest(self._said)}
        self._writer.add_metadata(END_METADATA, to_texts(end, digests))

    def close(self) -> None:
        """Write the index and close the file."""
        self._writer.close()

    def _write_header(self, header: RunHeader) -> dict[str, Any]:
        """Write what comes before the rows; returns its digests."""
        run = {"format": FORMAT, "seed": str(header.seed), "vehicle": self._vehicle, MODEL_NAME: header.model}
        tables = {RUN_METADATA: run, VERSIONS_METADATA: dict(sorted(header.versions.items()))}
        if header.vehicles:
            tables[VEHICLES_METADATA] = dict(header.vehicles)
        if header.code:
            tables[CODE_METADATA] = {code.key: code.name for code in header.code}
            tables[CODE_DIGESTS] = {code.key: code.digest for code in header.code}
        for name, table in tables.items():
            self._writer.add_metadata(name, table)
        files = [
            (SCENARIO, "application/yaml", header.scenario.encode()),
            (RESOLVED, "application/yaml", header.resolved.encode()),
        ]
        files += [(name, _media_type(name), data) for name, data in sorted(header.inputs.items())]
        files += [(CODE + code.file, "text/x-python", code.source.encode()) for code in header.code if code.source]
        for name, media_type, data in files:
            self._writer.add_attachment(name, media_type, data, EPOCH_NS)
        return head_digests(tables, {name: data for name, _, data in files})


def _media_type(name: str) -> str:
    return {".xml": "application/xml", ".csv": "text/csv"}.get(Path(name).suffix, "application/octet-stream")


def _templates(ids: Sequence[int], layouts: Sequence[tuple[Layout, int]]) -> tuple[Templates, NDArray[np.void]]:
    """What is the same in every chunk: templates, and a `STREAM` of each channel; the log's is the last.

    Args:
        ids: of the channels; the log's is the next one.
        layouts: of each a layout, and where in a message its stamp's seconds are written, or -1.
    """
    streams, records, spans = np.zeros(len(ids) + 1, STREAM), b"", []
    for stream, channel_id, (layout, seconds) in zip(streams, ids, layouts, strict=False):
        record = message_record(channel_id, layout.template.tobytes())
        head = len(record) - layout.length
        stream["channel_id"], stream["template"], stream["length"] = channel_id, len(records), len(record)
        stream["span"], stream["span_end"] = len(spans), len(spans) + len(layout.spans)
        stream["seconds"] = head + seconds if seconds >= 0 else -1
        records += record
        spans += [(head + start, column, count) for start, column, count in layout.spans]
    streams[-1]["channel_id"], streams[-1]["template"] = ids[-1] + 1, -1
    return Templates(np.frombuffer(records, np.uint8).copy(), np.array(spans, np.int64)), streams
