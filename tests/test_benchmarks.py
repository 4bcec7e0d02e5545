"""Benchmarks take what they are given, and say in one line what they cannot take."""

import importlib.util
import sys

import pytest
from support.places import REPO, SCENARIOS


def script(name):
    spec = importlib.util.spec_from_file_location(name, REPO / "benchmarks" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.flight
def test_allocators_are_compared_on_the_vehicle_of_the_scenario(monkeypatch, tmp_path, capsys):
    """Jack has four thrusters, the CUBE has eight."""
    jack, plot = SCENARIOS / "jack_exact.yaml", tmp_path / "all.png"
    monkeypatch.setattr(sys, "argv", ["", "--scenario", str(jack), "--duration", "31", "--plot", str(plot)])
    benchmark = script("allocators")
    every, names = benchmark.variants, ("exact, F_opt of +-15 N (11)", "contraction")
    monkeypatch.setattr(benchmark, "variants", lambda thrusters: {name: every(thrusters)[name] for name in names})
    benchmark.main()
    head, *rows = capsys.readouterr().out.splitlines()
    assert "energy [kJ]" in head
    assert [row.split()[0] for row in rows] == ["exact,", "contraction", "plot:"]
    assert plot.stat().st_size > 10_000


@pytest.mark.flight
def test_many_flights_are_compared_with_single_ones(monkeypatch, capsys):
    arguments = "--flights 3 --seconds 1 --threads 2 --rounds 1"
    monkeypatch.setattr(sys, "argv", ["", *arguments.split()])
    script("many_flights").main()
    title, head, *rows, against_one, floor_of_one, floor_of_two = capsys.readouterr().out.splitlines()
    assert title == "3 flights of 1 s of cube_helix"
    assert "x real time" in head
    assert [row[:24].strip() for row in rows] == [
        "ticks in Python",
        "one by one",
        "bare, 1 thread",
        "bare, 2 threads",
        "fly_many, 1 thread",
        "fly_many, 2 threads",
    ]
    assert against_one.startswith("2 threads against one: ")
    assert floor_of_one.startswith("fly_many, 1 thread, of bare MuJoCo: ")
    assert floor_of_two.startswith("fly_many, 2 threads, of bare MuJoCo: ")


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("allocators", "--duration 6", "the window starts at 40 s, the run ends at 6 s"),
        ("allocation", "--wrenches 0", "--wrenches and --rounds must be 1 at least"),
        ("allocation", "--rounds 0", "--wrenches and --rounds must be 1 at least"),
        ("stuck", "--jobs 0", "--jobs must be 1 at least, --draws and --seed 0"),
        ("stuck", "--vehicles submarine", "--vehicles submarine: no such vehicle without losses"),
        ("margins", "--jobs 0", "--jobs must be 1 at least"),
        ("margins", "--vehicles submarine", "--vehicles submarine: no such vehicle"),
        ("loop", "--rounds 0", "--seconds must be positive, --rounds 1 at least"),
        ("loop", "--vehicles submarine", "--vehicles submarine: no such vehicle"),
        ("many_flights", "--flights 0", "--flights, --threads and --rounds must be 1 at least"),
        ("allocation", "--dead-zone 2", "--dead-zone 2: must lie in 0 to 1"),
    ],
)
def test_a_mistake_is_one_line(name, arguments, message, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [name, *arguments.split()])
    with pytest.raises(SystemExit) as end:
        script(name).main()
    assert end.value.code == 2
    assert message in capsys.readouterr().err


@pytest.mark.flight
def test_a_compiled_model_and_a_copy_of_it_are_timed_side_by_side(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["", "--samples", "2", "--rounds", "1"])
    script("model_parameters").main()
    title, head, *rows = capsys.readouterr().out.splitlines()
    assert title == "2 sets of numbers for the vehicle of cube_helix, ms each"
    assert head.split() == ["compiled", "copied", "ratio"]
    assert [row.split()[0] for row in rows] == ["model", "flight", "reset"]
    for row in rows:
        compiled, copied = map(float, row.split()[1:3])
        assert 0.0 < copied < compiled
