"""The comparison of allocators flies any scenario, and says in one line what it cannot fly."""

import importlib.util
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parents[1]


@pytest.fixture
def benchmark(monkeypatch):
    """The script, with arguments in place of the command line's."""
    spec = importlib.util.spec_from_file_location("allocators", HERE / "benchmarks" / "allocators.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["allocators.py", *map(str, arguments)])
        script.main()

    run.script = script
    return run


def test_the_vehicle_is_the_scenarios_own(benchmark, monkeypatch, tmp_path, capsys):
    """Jack has four thrusters, the CUBE has eight."""
    variants = {"contraction": {"allocation.method": "contraction"}, "search": {"allocation.method": "search"}}
    monkeypatch.setattr(benchmark.script, "VARIANTS", variants)
    benchmark("--scenario", HERE / "scenarios" / "jack_exact.yaml", "--duration", 31, "--plot", tmp_path / "all.png")
    head, *rows = capsys.readouterr().out.splitlines()
    assert "energy [kJ]" in head
    assert [row.split()[0] for row in rows] == ["contraction", "search", "plot:"]
    assert (tmp_path / "all.png").stat().st_size > 10_000


def test_a_duration_too_short_for_the_checks_is_one_line(benchmark, capsys):
    with pytest.raises(SystemExit) as end:
        benchmark("--duration", 6)
    assert end.value.code == 2
    assert "the window starts at 40 s, the run ends at 6 s" in capsys.readouterr().err
