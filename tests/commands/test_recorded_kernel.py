"""A replay under the recorded kernel of OpenBLAS, in processes that each choose theirs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from support.scenario_files import FLIGHT

import cube_sim
from cube_sim.commands.recorded_kernel import asked_for
from cube_sim.mission.run_header import KERNEL

AVX2 = {"sse3", "sse4.2", "avx", "avx2", "fma"}


def command(folder: Path, *words: str, kernel: str = "") -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    environment["PYTHONPATH"] = str(Path(cube_sim.__file__).parents[1])
    if kernel:
        environment["OPENBLAS_CORETYPE"] = kernel
    line = [sys.executable, "-m", "cube_sim", *words]
    return subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.flight
def test_a_record_is_flown_again_under_its_own_kernel_unless_one_is_asked_for(tmp_path):
    (tmp_path / "a.yaml").write_text(FLIGHT)
    for name, kernel in (("here", ""), ("other", "Nehalem")):
        command(tmp_path, "run", "a.yaml", "--out", name, kernel=kernel)
    here, other = (cube_sim.load_run(tmp_path / name).header.versions.get(KERNEL) for name in ("here", "other"))
    if here is None or other != "Nehalem" or here == other:
        pytest.skip("this machine has one kernel to choose from")
    again = command(tmp_path, "replay", "other")
    assert again.returncode == 0, again.stdout + again.stderr
    assert f"OpenBLAS's kernel Nehalem, as recorded; this machine takes {here} by itself" in again.stdout
    told = json.loads(command(tmp_path, "replay", "other", "--json").stdout)
    assert (told["openblas_kernel"], told["other_versions"]) == ({"flown": "Nehalem", "here": here}, [])
    assert "kernel" not in command(tmp_path, "replay", "here").stdout
    asked = command(tmp_path, "replay", "other", kernel=here)
    assert f"version: {KERNEL} Nehalem, now {here}" in asked.stdout
    assert "as recorded" not in asked.stdout


@pytest.mark.parametrize(
    ("recorded", "ours", "asked"),
    [
        ("Haswell", "Haswell", ""),
        ("Nehalem", "Haswell", "Nehalem"),
        ("Katmai", "Haswell", "Prescott"),
        ("SkylakeX", "Haswell", ""),  # this processor has no AVX-512
        ("Haswell", "SkylakeX", "Haswell"),
        ("neoversen1", "Haswell", ""),
        ("", "Haswell", ""),
        ("Haswell", "", ""),
    ],
)
def test_a_kernel_is_asked_for_where_the_processor_can_run_it(recorded, ours, asked):
    assert asked_for(recorded, ours, AVX2) == asked
