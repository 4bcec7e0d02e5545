"""A run's channels as frames of pandas and polars: the numbers of the record, under the names of the export."""

from __future__ import annotations

import importlib.util
import sys

import numpy as np
import pyarrow.parquet
import pytest
from support.helix_run import HEADER, STATUS, fly, model, table

import cube_sim
from cube_sim.errors import RecordingError
from cube_sim.recording.recorder import Recorder
from cube_sim.runs.tables import pandas_frame, polars_frame, table_of, tables_of, write_csv, write_parquet

LIBRARIES = ("pandas", "polars")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    with Recorder(folder, HEADER, table(), model(), view=False) as recorder:
        fly(recorder, 100)
    return cube_sim.load_run(folder)


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_channel_is_a_frame_with_units_in_its_names(run, library):
    pytest.importorskip(library)
    frame = getattr(run, f"to_{library}")("path_error")
    names = ["t [s]", "along [m]", "lateral.y1 [m]", "lateral.z1 [m]", "cross_track [m]", "attitude [rad]"]
    assert list(frame.columns) == names
    assert np.array_equal(frame["cross_track [m]"].to_numpy(), run.signals["path_error.cross_track"][:, 1])
    for each in tables_of(run):
        frame = getattr(run, f"to_{library}")(each.name)
        words = [name for name in frame.columns if name.endswith(" [name]")]
        assert words == (["status [name]"] if each.name == "allocation" else [])
        assert tuple(name for name in frame.columns if name not in words) == each.columns
        assert np.array_equal(frame[list(each.columns)].to_numpy(), each.rows)


@pytest.mark.parametrize("library", LIBRARIES)
def test_a_code_has_its_word_beside_its_number(run, library):
    pytest.importorskip(library)
    frame = getattr(run, f"to_{library}")("allocation")
    codes = run.signals["allocation.status"][:, 1]
    assert set(codes) == {0.0, 1.0}
    assert list(frame["status [name]"]) == [STATUS[int(code)] for code in codes]
    known = frame["status [name]"].cat.categories if library == "pandas" else frame.schema["status [name]"].categories
    assert tuple(known) == STATUS


def test_a_code_without_a_word_has_none(run, tmp_path):
    table = table_of(run, "allocation")
    table.rows[0, 3], table.rows[1, 3] = 7.0, np.nan
    assert write_csv(table, tmp_path).read_text().splitlines()[1].split(",")[3:5] == ["7.0", ""]
    assert pyarrow.parquet.read_table(write_parquet(table, tmp_path)).column(4).to_pylist()[:3] == [None, None, "exact"]
    for frame, none in ((pandas_frame, "isna"), (polars_frame, "is_null")):
        assert list(getattr(frame(table)["status [name]"], none)()[:3]) == [True, True, False]


@pytest.mark.parametrize("library", LIBRARIES)
def test_without_the_library_one_line_says_how_to_get_it(run, library, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(RecordingError, match=f"^{library} is not installed: pip install {library}$"):
        getattr(run, f"to_{library}")("pose")


def test_a_channel_that_is_none_is_refused_and_one_without_rows_is_empty(run):
    with pytest.raises(RecordingError, match="no channel 'path_eror'; did you mean path_error"):
        run.to_pandas("path_eror")
    if importlib.util.find_spec("pandas"):
        assert run.to_pandas("health").empty
