"""Machine code on disk is called without numba, to the same bits, and never after what it was made from has changed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cube_sim.native.kinds import UnknownKindError, kinds_of, text_of

LAW = """
from typing import NamedTuple
import numpy as np
from cube_sim.native.compiled import address_of, compiled, cut
from cube_sim.native.callee import Callee, call_at
from callee import scaled

SCALING = Callee(scaled, lambda: (1.0,), answers=np.float64)

class Pair(NamedTuple):
    first: np.ndarray
    second: float

@compiled
def law(pair, record, on, n):
    if n < 0:
        raise ValueError("n is below zero")
    out = np.empty((2, 3))
    for i in range(3):
        out[0, i] = np.sin(scaled(pair.first[i])) + pair.second if on else np.nan
        out[1, i] = record[0].x * n
    return out, cut(pair.first, 1, (2,), np.float64)[1], n

@compiled
def through(address, x):
    return call_at(SCALING, address, (x,)) + 1.0
"""
CALLEE = """
from cube_sim.native.compiled import compiled

@compiled
def scaled(x):
    return {factor} * x
"""
CALLER = """
import json, sys
import numpy as np
from cube_sim.native.compiled import address_of, on_disk
from callee import scaled
from law import Pair, law, through

known = on_disk(law)
record = np.zeros(1, [("x", float), ("k", np.int64)])
record["x"] = 0.1
out, last, n = law(Pair(np.array([0.1, 0.2, 0.3]), 0.5), record, True, 3)
answers = [out.tolist(), last, n, through(address_of(scaled, 1.0, answers=np.float64), 2.0)]
try:
    law(Pair(np.zeros(3), 0.5), record, False, -1)
except ValueError as error:
    said = str(error)
sets = law(Pair(np.zeros(3), 0.5), record, False, 1)[0].tolist()
before = "numba" in sys.modules
fortran = law(Pair(np.asfortranarray(np.zeros((3, 2)))[:, 0], 0.5), record, True, 1)[1]
print(json.dumps([answers, said, [str(x) for x in sets[0]], fortran, before, known]))
"""


def flown(folder: Path) -> list:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    environment |= {name: str(folder / "cache") for name in ("NUMBA_CACHE_DIR", "CUBE_SIM_CACHE_DIR")}
    environment |= {"PYTHONPATH": str(Path(__file__).parents[2]), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, "caller.py"], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.stderr == ""
    return json.loads(done.stdout)


@pytest.fixture
def laws(tmp_path):
    (tmp_path / "law.py").write_text(LAW)
    (tmp_path / "callee.py").write_text(CALLEE.format(factor=2.0))
    (tmp_path / "caller.py").write_text(CALLER)
    return tmp_path


@pytest.mark.flight
def test_another_process_calls_it_without_numba_to_the_same_bits(laws):
    *first, numba, known = flown(laws)
    assert numba
    assert not known
    assert first[0][0][0][0] == pytest.approx(np.sin(0.2) + 0.5)
    assert first[0][1:] == [0.3, 3, 5.0]
    assert first[1:] == ["n is below zero", ["nan"] * 3, 0.0]
    *again, _, known = flown(laws)
    assert again == first
    assert known
    program = (laws / "caller.py").read_text().replace("sets = law", "imported = 'numba' in sys.modules\nsets = law")
    calm = program.replace("try:\n    law", "quiet = 'numba' in sys.modules\ntry:\n    law").replace(
        "before, known", "quiet, known"
    )
    (laws / "caller.py").write_text(calm)
    *again, numba, known = flown(laws)
    assert again == first
    assert not numba  # only to raise an exception is it asked


@pytest.mark.flight
def test_it_follows_what_it_was_made_from(laws):
    first = flown(laws)[0]
    (laws / "callee.py").write_text(CALLEE.format(factor=3.25))
    *changed, _, known = flown(laws)
    assert not known
    assert changed[0][0][0][0] == pytest.approx(np.sin(0.325) + 0.5)
    assert changed[0][0] != first[0]
    assert flown(laws)[-1]


@pytest.mark.flight
@pytest.mark.parametrize("damage", [b"", b"no machine code", None], ids=["empty", "other", "cut"])
def test_what_is_damaged_is_made_again(laws, damage):
    first = flown(laws)[:4]
    files = list((laws / "cache").glob("*.door"))
    assert len(files) >= 3
    for file in files:
        file.write_bytes(file.read_bytes()[:-1] if damage is None else damage)
    *again, _, _ = flown(laws)
    assert again == first
    *again, _, known = flown(laws)
    assert again == first
    assert known


def test_arguments_that_numba_tells_apart_have_kinds_of_their_own():
    record = np.zeros(1, [("x", float), ("k", np.int64)])
    read_only = np.zeros(3)
    read_only.flags.writeable = False
    each = [
        np.zeros(3),
        np.zeros(3, np.float32),
        np.zeros((3, 3)),
        np.zeros((3, 3), order="F"),
        np.zeros((3, 3))[:, :2],
        read_only,
        np.frombuffer(bytearray(25), np.float64, offset=1),
        record,
        np.zeros(1, np.dtype([("x", float), ("k", np.int64)], align=True).newbyteorder()),
        1,
        1.0,
        True,
        None,
        (1, 2),
        (1, 2.0),
        (np.zeros(3),),
    ]
    assert len({text_of(kinds_of((one,))) for one in each}) == len(each)
    same = [(np.zeros(2), 2, False, 0.5), (np.ones(7), np.int64(3), np.True_, np.float64(1.0))]
    assert len({kinds_of(arguments) for arguments in same}) == 1
    assert text_of(kinds_of((np.zeros((1, 1)),))) == text_of(kinds_of((np.zeros((3, 3)),)))


@pytest.mark.parametrize(
    "other", ["text", 2**63, object(), np.ma.array([1.0]), [1.0], np.float32(1.0), np.zeros(2, object)]
)
def test_what_only_numba_knows_is_left_to_it(other):
    with pytest.raises(UnknownKindError):
        text_of(kinds_of(((1.0, other),)))
