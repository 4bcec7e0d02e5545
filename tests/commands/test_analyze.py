"""``cube-sim analyze``: what it prints, its JSON, its exit codes."""

import json
import subprocess
import sys

import numpy as np
import pytest
from support.propelled_torpedo import FASTEST, propelled_torpedo, thrust
from typer.testing import CliRunner

from cube_sim.commands import analysis_report
from cube_sim.commands.cli import app
from cube_sim.control.foreseen import in_metres

CUBE = "models/cube.xml"


def analyze(*arguments):
    return CliRunner().invoke(app, ["analyze", *arguments])


def test_text_says_what_is_lost_and_what_remains():
    result = analyze(CUBE, "--lost", "T1,T2", "--losses", "1")
    assert result.exit_code == 0
    assert "1 more lost: 6 of 6 can follow a path; 4 keep rank 5, 2 keep rank 4" in result.output
    assert "cube: 6 thrusters, without T1, T2" in result.output
    assert "…" not in result.output
    assert "rank 5 of 6, 1 redundant" in result.output
    assert "only together" in result.output
    assert "path following: yes (steered)" in result.output
    assert result.output.count(">= 1 ") == 7


def test_fins_are_told_beside_the_thrusters():
    """9.64 N/rad and 6.15 N m/rad at 1 m/s, for 13.6 degrees; a ninth of it by default, at 0.3 m/s."""
    lines = analyze("models/remus100.xml", "--speed", "1").output.splitlines()
    start = next(i for i, line in enumerate(lines) if "fins count by what they make at 1 m/s straight ahead" in line)
    assert lines[start + 1 : start + 3] == ["    stern_planes: Fz 2.29, My 1.46", "    rudder: Fy -2.29, Mz 1.46"]
    told = json.loads(analyze("models/remus100.xml", "--json").output)
    assert told["fins"]["names"] == ["stern_planes", "rudder"]
    assert told["fins"]["speed_m_s"] == 0.3
    assert np.allclose(told["fins"]["limits"], np.array([[-1.0, 1.0]] * 2) * 9.64 * 0.09 * np.radians(13.6))
    assert told["rank"] == 3
    assert told["verdict"]["outcome"] == "stuck"
    assert "; nor do its fins steer it at 0.5, 1, 1.5, 2, 3 m/s (--speed)" in told["verdict"]["reason"]
    assert any("it cannot hold a point" in line for line in lines)


def test_a_scenario_is_told_from_a_model():
    result = analyze("scenarios/remus100_line.yaml")
    assert result.exit_code == 2
    assert "remus100_line.yaml: is a scenario, and analyze takes a model: cube-sim analyze " in result.output
    assert "models/remus100.xml --speed 1.2" in result.output.replace("\n", "")


def test_fins_steer_from_a_speed_on():
    """With 3 N to spare REMUS 100 keeps no course at 0.3 m/s, and all at 1.2 m/s."""
    ballasted = "models/remus100.xml", "--set", "hull:volume=0.029888", "--json", "--speed"
    slow, fast = (json.loads(analyze(*ballasted, speed).output) for speed in ("0.3", "1.2"))
    assert not slow["verdict"]["follows"]
    assert "needs more force than thrusters and fins have" in slow["verdict"]["reason"]
    assert "give --speed" not in slow["verdict"]["reason"]
    by_itself = json.loads(analyze(*ballasted[:-1]).output)
    assert by_itself["fins"]["speed_m_s"] == 0.3
    assert by_itself["verdict"]["reason"].endswith("; its fins steer it at 1 m/s: give --speed 1")
    assert fast["verdict"]["follows"]
    assert all(course["velocity"][0] > 1.0 for course in fast["verdict"]["courses"])  # nose ahead
    assert fast["turning"]["radius_m"] < 8.0
    assert "fins" not in analyze("models/torpedo.xml").output


def test_propellers_count_by_what_the_inflow_leaves(tmp_path):
    """T = rho D^4 K_T(J) n^2 at full speed: 22.7 N at rest, 13.4 N at 0.8 m/s, none beyond its pitch speed."""
    model = str(propelled_torpedo(tmp_path))
    for speed in (0.3, 0.8, 1.5):
        told = json.loads(analyze(model, "--speed", str(speed), "--json").output)
        assert told["propellers"]["names"] == ["propeller"]
        limits, rest = told["propellers"]["limits"][0], told["propellers"]["limits_at_rest"][0]
        assert limits[3] == pytest.approx(thrust(FASTEST, speed), rel=1e-9)
        assert rest[3] == pytest.approx(thrust(FASTEST, 0.0), rel=1e-9)
        surge = next(each for each in told["extents"] if each["component"] == "Fx")
        assert surge["at_most"][1] == pytest.approx(limits[3], rel=1e-9)
    lines = analyze(model, "--speed", "0.8").output.splitlines()
    start = next(i for i, line in enumerate(lines) if "propellers count by what they make at 0.8 m/s" in line)
    assert lines[start + 1] == "    propeller: -23.6 to 13.4, none between -0.429 and 0; at rest -15.8 to 22.7"
    assert json.loads(analyze(CUBE, "--json").output)["propellers"] is None


def test_json_is_the_whole_analysis():
    result = analyze(CUBE, "--json", "--lost", "T4")
    assert result.exit_code == 0
    content = json.loads(result.output)
    assert content["lost"] == ["T4"]
    assert content["rank"] == 6
    A, P = np.array(content["actuation_matrix"]), np.array(content["projector"])
    assert A.shape == (6, 7)
    assert np.allclose(P, np.eye(6))
    assert np.allclose(A @ np.array(content["pseudo_inverse"]), np.eye(6))
    assert content["verdict"]["follows"] is True
    assert all(course["share"] > 1 and course["within_limits"] for course in content["verdict"]["courses"])
    assert [e["component"] for e in content["extents"]] == ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
    assert content["losses"] is None


def test_every_single_fault_is_tabulated_with_what_is_foreseen_and_the_bound_or_why_there_is_none(monkeypatch):
    usual, found = analysis_report.fault_cases, []

    def once(*arguments, **named):  # it takes seconds, and both forms tell of the same
        found.extend(() if found else usual(*arguments, **named))
        return found

    monkeypatch.setattr(analysis_report, "fault_cases", once)
    result = analyze(CUBE, "--stuck", "--lost", "T8")
    assert result.exit_code == 0
    rows = [line.split() for line in result.output.splitlines() if line.startswith("T")]
    assert len(rows) == 7 * 5
    cases = json.loads(analyze(CUBE, "--stuck", "--lost", "T8", "--json").output)["stuck"]
    assert f"single faults: {sum(case['follows'] for case in cases)} of 35 follow the path" in result.output
    for case, row in zip(cases, rows, strict=True):
        assert case["thruster"] == row[0]
        bound = case["transient"]
        assert (bound["bound_m"] is None) == (bound["no_bound"] is not None)
        assert 0.0 < bound["foreseen_m"] < bound["with_margin_m"]
        first = row.index("/")
        assert row[first - 1].rstrip("+") == in_metres(bound["foreseen_m"])
        at_most = max(bound["bound_m"] or 0.0, bound["with_margin_m"])
        assert row[first + 1].lstrip("~") == f"{at_most:.2g}"
        assert row[first + 1].startswith("~") == (bound["bound_m"] is None)
    assert any(case["transient"]["bound_m"] for case in cases)
    assert any(case["transient"]["no_bound"] for case in cases)
    assert json.loads(analyze(CUBE, "--json").output)["stuck"] is None


def test_single_faults_are_not_judged_in_the_plane():
    result = analyze("models/jack.xml", "--stuck", "--planar")
    assert result.exit_code == 2
    assert "--stuck looks at all six components: leave --planar out" in result.output


def test_directions_are_dropped_by_rank_or_by_a_limit_on_their_cost_and_the_reason_is_given():
    as_built = ["models/cube_as_built.xml", "--lost"]
    by_rank = analyze(*as_built, "T1,T2")
    assert "rank 5 of 6" in by_rank.output
    assert "too costly but together" in by_rank.output
    assert "always" not in by_rank.output
    assert "dropped by rank: more than 100 times as costly as the cheapest" in by_rank.output
    assert "rank 6 of 6" in analyze(*as_built, "T1,T2", "--cost-limit", "100").output
    by_cost = analyze(*as_built, "T2,T3", "--cost-limit", "10")
    assert "rank 5 of 6" in by_cost.output
    assert "dropped by cost: above 10 N/N" in by_cost.output
    last = json.loads(analyze(*as_built, "T2,T3", "--cost-limit", "10", "--json").output)["costs"]["final_approach"][-1]
    assert last["dropped"] == "cost"
    assert last["kept"] is False


def test_losses_come_on_top_of_those_named():
    further = json.loads(analyze(CUBE, "--lost", "T1,T2", "--losses", "1", "--json").output)["losses"]
    named = json.loads(analyze(CUBE, "--lost", "T1,T2,T3", "--json").output)
    assert [case["lost"] for case in further] == [[], *([f"T{i}"] for i in range(3, 9))]
    assert (further[1]["rank"], further[1]["verdict"]) == (named["rank"], named["verdict"])
    assert further[1]["extents"] == named["extents"]


def test_the_module_of_the_command_line_is_one_too():
    said = subprocess.run(
        [sys.executable, "-m", "cube_sim.commands.cli", "--version"], capture_output=True, text=True, check=True
    )
    assert said.stdout.strip()


@pytest.mark.parametrize("model", ["models/bluerov2_heavy.xml", CUBE])
def test_the_least_forces_are_there_for_idle_thrusters_too(model):
    extents = json.loads(analyze(model, "--planar", "--json").output)["extents"]
    assert [e["component"] for e in extents] == ["Fx", "Fy", "Mz"]
    assert [e["finest"] for e in extents] == [[0, 0]] * 3


def test_losses_are_tabulated_and_counted():
    result = analyze(CUBE, "--losses", "1", "--json")
    losses = json.loads(result.output)["losses"]
    assert [case["lost"] for case in losses] == [[], *([f"T{i}"] for i in range(1, 9))]
    assert all(case["verdict"]["follows"] for case in losses)


def test_planar_vehicle_is_judged_in_its_plane():
    flying, swimming = (
        json.loads(analyze("models/infante.xml", "--json", *more).output)
        for more in ([], ["--planar", "--speed", "1.5"])
    )
    assert flying["verdict"]["follows"] is False
    assert swimming["verdict"]["outcome"] == "steered"
    assert swimming["components"] == ["Fx", "Fy", "Mz"]
    assert [c["text"] for c in swimming["unreachable"]] == ["cannot push sideways: Fy = 0 always"]


@pytest.mark.flight
@pytest.mark.parametrize("model", ["models/infante.xml", "models/jack.xml"])
def test_a_vehicle_kept_at_its_depth_is_pointed_to_its_plane(model):
    assert "by other means it follows planar paths (--planar)" in analyze(model).output
    planar = analyze(model, "--planar")
    assert "looked at are Fx, Fy and Mz only" in planar.output
    assert "path following: yes" in planar.output
    assert "--planar" not in analyze(CUBE, "--speed", "5").output


@pytest.mark.flight
@pytest.mark.parametrize("limit", ["0.1", "1", "2"])
@pytest.mark.parametrize("model", ["models/infante.xml", "models/jack.xml"])
def test_the_plane_is_pointed_to_where_a_path_can_be_followed_there_at_the_same_cost(model, limit):
    said, planar = (analyze(model, "--cost-limit", limit, *more).output for more in ([], ["--planar"]))
    assert "path following: no" in said
    assert ("(--planar)" in said) == ("path following: yes" in planar)


@pytest.mark.flight
@pytest.mark.filterwarnings("error")
def test_thrusters_across_the_plane_do_nothing_in_it():
    upright = ["models/bluerov2_heavy.xml", "--planar", "--lost", "T1,T2,T3,T4", "--losses", "1"]
    content = json.loads(analyze(*upright, "--json").output)
    assert (content["rank"], content["verdict"]["outcome"], len(content["losses"])) == (0, "stuck", 5)
    assert np.array_equal(content["actuation_matrix"], np.zeros((3, 4)))
    said = analyze(*upright)
    assert said.exit_code == 0
    assert "cannot push sideways: Fy = 0 always" in said.output
    assert "can be kept in no attitude tried" in said.output


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("speed", ["1e300", "0", "nan", "inf", "-1", "1e-9"])
def test_a_speed_out_of_range_is_one_line(speed):
    result = analyze(CUBE, "--speed", speed)
    assert result.exit_code == 2
    assert result.stderr.strip().endswith(f"--speed {float(speed):g}: between 0.001 and 100 m/s")
    assert len(result.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([CUBE, "--lost", "T9"], "no thruster 'T9'; there are T1, T2, T3, T4, T5, T6, T7, T8"),
        ([CUBE, "--lost", "T1,T1"], "--lost T1,T1: give each thruster once"),
        ([CUBE, "--lost", ","], "--lost ,: give each thruster once"),
        ([CUBE, "--losses", "4"], "between 0 and 3"),
        ([CUBE, "--cost-limit", "0"], "the cost limit is 0.0; it must be positive"),
        ([CUBE, "--cost-limit", "nan"], "the cost limit is nan; it must be positive"),
        ([CUBE, "--hull", "sub"], "sub"),
        ([CUBE, "--picture", "a.gif"], "one of .png, .svg, .pdf"),
        ([CUBE, "--lost", ",".join(f"T{i}" for i in range(1, 9))], "no thruster is left"),
        (["models/no_such.xml"], "no such model file"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_two(arguments, message):
    result = analyze(*arguments)
    assert result.exit_code == 2
    assert message in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert result.stdout == ""
