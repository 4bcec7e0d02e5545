"""A run too long for the memory: judged and read from its record, the same to the bit."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import HELIX

import cube_sim
from cube_sim.errors import RecordingError
from cube_sim.recording import long_run, recorder
from cube_sim.recording.batch import Batch
from cube_sim.recording.channels import channel_table
from cube_sim.recording.header import RunHeader
from cube_sim.recording.long_run import RecordedSignals
from cube_sim.recording.mcap.sink import McapSink


@pytest.mark.flight
def test_signals_read_from_the_record_are_those_kept_in_memory(tmp_path, monkeypatch):
    error = {"kind": "signal", "signal": "path_error.cross_track", "at_most": 9.0}
    checks = [{"kind": "allowed_forces"}, {"kind": "exact_wrench"}]
    checks += [error | {"statistic": statistic, "from_s": 1.5} for statistic in ("rms", "mean", "max", "final")]
    short = {"duration_s": 6.0, "checks": checks}
    kept = cube_sim.run(HELIX, short, tmp_path / "kept")
    monkeypatch.setattr(recorder, "MOST_KEPT_BYTES", 100_000)
    monkeypatch.setattr(long_run, "CHUNKS_AT_ONCE", 2)
    spilt = cube_sim.run(HELIX, short, tmp_path / "spilt")
    assert isinstance(kept.signals, dict)
    assert isinstance(spilt.signals, RecordedSignals)
    assert spilt.signals._recorded._kept == {}  # judged without a whole channel in memory
    assert list(spilt.signals) == list(kept.signals)
    for name, rows in kept.signals.items():
        assert spilt.signals[name].tobytes() == rows.tobytes(), name
    assert spilt.checks == kept.checks
    assert (tmp_path / "kept" / "run.mcap").read_bytes() == (tmp_path / "spilt" / "run.mcap").read_bytes()
    assert len(spilt.signals._recorded._kept) == long_run.CHANNELS_KEPT
    with pytest.raises(KeyError):
        spilt.signals["pose.place"]
    (tmp_path / "spilt" / "run.mcap").unlink()
    with pytest.raises(RecordingError, match="cannot be read"):
        _ = spilt.signals["pose.position"]


def test_of_another_run_in_the_same_place_nothing_is_read(tmp_path):
    path, channels = tmp_path / "run.mcap", channel_table(("T1",), 2, ("EXACT",), ("HOLONOMIC",))
    header = RunHeader(scenario="", resolved="", model="m.xml", inputs={"m.xml": b""})

    def recorded(energy):
        sink = McapSink(path, header, channels, "hull")
        sink.write(Batch({"power": np.array([[0.0, 1.0, energy, 12.0, 1.0]])}))
        sink.close()
        return RecordedSignals(path, channels)

    first = recorded(1.0)
    path.unlink()  # as a run does with what stands in its folder
    second = recorded(2.0)
    assert second["power.energy"][0, 1] == 2.0
    with pytest.raises(RecordingError, match="another recording stands there now"):
        _ = first["power.energy"]
    with pytest.raises(RecordingError, match="another recording stands there now"):
        next(first.blocks({"power.energy"}))
