"""Machine code of somebody's own counts as old once something is changed that it was made from, in whatever file."""

from __future__ import annotations

import importlib.util

import pytest

from cube_sim.native.stamps import stamp_of

OWN = """\
import numpy as np
from numba import njit

{begin}


def law(x):
    return {body}
"""


def module_of(file):
    """A file run as a module."""
    spec = importlib.util.spec_from_file_location(file.stem, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("begin", "body", "number"),
    [
        ("import gains", "gains.higher(x)", 0),
        ("from gains import higher", "higher(x)", 1),
        ("from gains import GAINS", "GAINS * x", 2),
        ("from gains import GAIN", "GAIN * x", 3),
        ("from gains import further", "further(x)", 4),
    ],
)
def test_what_another_file_says_is_part_of_it(begin, body, number, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "own.py").write_text(OWN.format(begin=begin, body=body))
    stamps = []
    for k, gain in enumerate((1.0, 1.0, 2.0)):
        folder = tmp_path / f"turn_{number}_{k}"
        folder.mkdir()
        gains = "import numpy as np\nfrom numba import njit\nGAIN = {0}\nGAINS = np.full(2, {0})\n"
        gains += "@njit\ndef higher(x):\n    return {0} * x if x > 0 else further(x)\n"
        gains += "@njit\ndef further(x):\n    return higher(-x)\n"
        (folder / "gains.py").write_text(gains.format(gain))
        monkeypatch.setitem(__import__("sys").modules, "gains", module_of(folder / "gains.py"))
        stamps.append(stamp_of(module_of(tmp_path / "own.py").law))
    assert stamps[0] == stamps[1] != stamps[2]


def test_a_function_that_calls_itself_has_a_stamp(tmp_path):
    (tmp_path / "own.py").write_text(
        OWN.format(begin="", body="law(x - 1) if x > 0 else 0").replace("def", "@njit\ndef")
    )
    law = module_of(tmp_path / "own.py").law
    assert stamp_of(law.py_func) == stamp_of(law.py_func)
