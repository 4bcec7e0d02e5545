"""A vehicle from a mass, a mesh or a size, and a list of thrusters: what is written loads, flies and passes."""

from __future__ import annotations

import dataclasses
import os
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support.command_line import call
from support.hull_shapes import ellipsoid, ellipsoid_added_mass, write_stl
from support.places import MODELS, REPO

import cube_sim
import cube_sim.vehicle.faults
from cube_sim.commands.drafted_battery import drafted_battery
from cube_sim.vehicle.known_thrusters import known_thruster

SIX = (
    "T1=0.14,-0.09,0:1,1,0:T200",
    "T2=0.14,0.09,0:1,-1,0:T200",
    "T3=-0.15,-0.09,0:-1,1,0:T200",
    "T4=-0.15,0.09,0:-1,-1,0:T200",
    "T5=0,-0.11,0.07:z:T200",
    "T6=0,0.11,0.07:+z:t200",
)
FLAGS = [word for thruster in SIX for word in ("--thruster", thruster)]
FRD = """# places and axes in FRD
name,x_m,y_m,z_m,axis_x,axis_y,axis_z,type
T1, 0.14, 0.09,0, 1,-1,0,T200
T2, 0.14,-0.09,0, 1, 1,0,T200
T3,-0.15, 0.09,0,-1,-1,0,T200
T4,-0.15,-0.09,0,-1, 1,0,T200
T5,0, 0.11,-0.07,0,0,-1,T200
T6,0,-0.11,-0.07,0,0,-1,T200
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def few_panels(monkeypatch):
    """How exact added mass is is another's test."""
    panels = import_module("cube_sim.hull_shape.added_mass")
    monkeypatch.setattr(panels, "COARSE", 400)
    monkeypatch.setattr(panels, "FINE", 1000)


@pytest.fixture
def unflown(monkeypatch, few_panels):
    """Choosing a scenario is another's test."""

    def write(model, file, hull, voltages=None):
        file.write_text("chosen\n")
        return "nothing"

    monkeypatch.setattr("cube_sim.commands.new.write_scenario", write)


def test_on_a_battery_thrusters_get_their_curves_at_several_voltages(here, monkeypatch, capsys, unflown):
    size = "--mass-kg", 11.5, "--size-m", "0.46,0.34,0.25", *FLAGS
    code, *_ = call(monkeypatch, capsys, "new", "vehicle", "rov", *size, "--battery-v", "12.8,16.8")
    assert code == 0
    model = cube_sim.load_model("rov/models/rov.xml")
    thrusters = cube_sim.Vehicle.from_model(model).thrusters
    assert thrusters.voltage.tolist() == [14.8] * 6
    np.testing.assert_allclose(thrusters.limits[0, [0, 3]], known_thruster("T200", 14.8).forces[[0, -1]], rtol=1e-4)
    data = mujoco.MjData(model)
    for volts in (12.8, 13.5, 16.8):
        cube_sim.vehicle.faults.set_supply(model, "T1", volts / 14.8)
        data.act[:] = 1.0
        mujoco.mj_forward(model, data)
        assert data.actuator_force[0] == pytest.approx(known_thruster("T200", volts).forces[-1], rel=1e-4)


@pytest.mark.flight
def test_a_vehicle_on_a_battery_has_it_in_its_scenario_and_flies_on_it(here, monkeypatch, capsys):
    size = "--mass-kg", 11.5, "--size-m", "0.46,0.34,0.25", *FLAGS
    code, *_ = call(monkeypatch, capsys, "new", "vehicle", "rov", *size, "--battery-v", "12.8,16.8")
    assert code == 0
    text = Path("rov/scenarios/rov_first.yaml").read_text()
    assert text.count("# a choice: ") == 2
    run = cube_sim.run("rov/scenarios/rov_first.yaml", record="none")
    assert run.verdict == "PASS"
    voltage, charge = (run.signals[f"power.{each}"][:, 1] for each in ("voltage", "charge"))
    assert 12.8 < voltage.min() < voltage.max() <= 16.8
    assert 0.5 < charge[-1] < 1.0


def test_a_drafted_battery_sags_and_lasts_as_small_vehicles_do():
    """Full power by T200's table at 14.8 V; a quarter of an hour of half of that empties it."""
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(MODELS / "bluerov2_heavy.xml"))
    thrusters = vehicle.thrusters
    keys = {name: text.partition("#")[0].strip() for name, text in drafted_battery(thrusters, 12.8, 16.8).items()}
    power = sum(max(k * abs(f) ** 1.5 for k, f in zip(ks, fs, strict=True)) for ks, fs in zip(
        thrusters.power_coefficients.tolist(), thrusters.limits[:, [0, 3]].tolist(), strict=True))  # fmt: skip
    assert float(keys["capacity_Wh"]) == pytest.approx(power * 8 / 60, rel=0.01)
    assert float(keys["resistance_ohm"]) * (0.5 * power / 14.8) == pytest.approx(1.48, rel=0.05)
    bare = dataclasses.replace(thrusters, power_coefficients=0.0 * thrusters.power_coefficients)
    assert drafted_battery(bare, 12.8, 16.8) is None


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        (("--battery-v", "16.8"), "two voltages"),
        (("--battery-v", "16.8,12.8"), "two voltages"),
        (("--battery-v", "7,16.8"), "has tables from 10 to 20 V, not at 7"),
        (("--battery-v", "16,16"), "has one table about 16 to 16 V"),
        (("--battery-v", "12.8,16.8", "--voltage-v", "19"), "the battery's, 12.8 to 16.8 V, is right"),
    ],
)
def test_a_battery_that_no_table_spans_is_refused(here, monkeypatch, capsys, flags, told):
    size = "--mass-kg", 11.5, "--size-m", "0.46,0.34,0.25", *FLAGS
    code, _, said = call(monkeypatch, capsys, "new", "vehicle", "rov", *size, *flags)
    assert code == 2
    assert told in said
    assert len(said.strip().splitlines()) == 1


@pytest.mark.flight
def test_what_is_written_is_run_and_tested_as_it_is(here, monkeypatch, capsys):
    code, stdout, _ = call(
        monkeypatch, capsys, "new", "vehicle", "rov", "--mass-kg", 11.5, "--size-m", "0.46,0.34,0.25", *FLAGS
    )
    assert code == 0
    assert stdout.splitlines()[-2:] == [
        "fly it:      cube-sim run rov/scenarios/rov_first.yaml",
        "test it:     pytest rov",
    ]
    assert cube_sim.fly("rov/scenarios/rov_first.yaml", out="out", record="none").verdict == "PASS"
    environment = {**os.environ, "PYTHONPATH": str(REPO)}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:xdist", "-p", "no:cacheprovider", "rov"]
    done = subprocess.run(command, cwd=here, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout
    assert "4 passed" in done.stdout  # three tests of its own, and the scenario
    written = [file for file in here.glob("rov/*/*.*") if file.suffix != ".pyc"]
    assert len(written) >= 3
    for file in written:
        assert max(map(len, file.read_text().splitlines())) <= 120, file


@pytest.mark.flight
def test_a_mesh_gives_all_of_the_hull(here, unflown, monkeypatch, capsys):
    axes = np.array([0.4, 0.2, 0.2])
    write_stl(here / "hull.stl", 1000.0 * (ellipsoid(axes, 3) + np.array([0.1, 0.0, -0.05])))
    (here / "thrusters.csv").write_text(FRD)
    given = ["--mass-kg", 66, "--mesh", "hull.stl", "--unit", "mm", "--frame", "frd", "--thrusters", "thrusters.csv"]
    code, _, stderr = call(monkeypatch, capsys, "new", "vehicle", "egg", *given, "--voltage-v", 14)
    assert (code, stderr) == (0, "")
    model = cube_sim.load_model("egg/models/egg.xml")
    vehicle = cube_sim.Vehicle.from_model(model)
    drawn = model.geom("hull")
    assert model.geom_type[drawn.id] == mujoco.mjtGeom.mjGEOM_MESH
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, drawn.quat)
    corners = drawn.pos + model.mesh_vert @ turn.reshape(3, 3).T
    np.testing.assert_allclose(corners.max(axis=0), [0.4, 0.2, 0.2], atol=0.005)
    volume = 4 / 3 * np.pi * axes.prod()
    assert vehicle.displaced_mass == pytest.approx(1000 * volume, rel=0.01)
    np.testing.assert_allclose(vehicle.centre_of_buoyancy, 0.0, atol=1e-9)  # the origin is moved there
    np.testing.assert_allclose(vehicle.centre_of_mass, [0.0, 0.0, -0.02], atol=1e-4)
    exact = 1000 * ellipsoid_added_mass(axes)
    np.testing.assert_allclose(vehicle.added_mass.diagonal()[:3], exact[:3], rtol=0.02)
    assert "it stands at (0.1, 0, 0.05) m" in (here / "egg/models/egg.xml").read_text().replace("\n      ", "")
    assert vehicle.thrusters.limits[0, 3] == pytest.approx(known_thruster("T200", 14).forces[-1], rel=1e-4)
    column = vehicle.actuation_matrix[:, 0]
    half = 0.5**0.5
    place = np.array([0.14 - 0.1, -0.09, -0.05])  # FRD: z of the mesh was down
    np.testing.assert_allclose(column, [half, half, 0, *np.cross(place, [half, half, 0])], atol=1e-5)


NUMBER = re.compile(r"(?<![\w.:])-?\d+\.?\d*(?:e-?\d+)?")


def numbers_of(model):
    """All numbers of a model but those of its remarks."""
    return np.array([float(told) for told in NUMBER.findall(re.sub(r"<!--.*?-->", "", model.read_text(), flags=re.S))])


@pytest.mark.flight
@pytest.mark.parametrize("mass_there", [False, True])
def test_the_point_that_all_is_measured_from_is_of_no_account(mass_there, here, unflown, monkeypatch, capsys):
    """A hull without any symmetry fore and aft, and its thrusters, moved together are the same vehicle."""
    shape = ellipsoid((0.4, 0.25, 0.2), 2)
    shape[..., 2] *= 1.0 + 0.5 * shape[..., 0]
    found = []
    for name, by in (("near", [0.0, 0.0, 0.0]), ("aside", [0.1, 0.0, 0.3]), ("far", [-2.0, 1.0, 5.0])):
        write_stl(here / f"{name}.stl", shape + np.array(by))
        flags = [f"{flag.partition('=')[0]}={moved(flag, by)}:{flag.partition(':')[2]}" for flag in SIX]
        told = [word for flag in flags for word in ("--thruster", flag)]
        if mass_there:
            told += ["--centre-of-mass-m", ",".join(map(str, np.array([0.01, 0.0, -0.03]) + by))]
        given = ["--mass-kg", 83, "--mesh", f"{name}.stl", *told]
        assert call(monkeypatch, capsys, "new", "vehicle", name, *given)[0] == 0
        found.append(numbers_of(here / f"{name}/models/{name}.xml"))
    assert len(found[0]) > 150
    np.testing.assert_allclose(found[1], found[0], rtol=2e-4, atol=2e-6)
    np.testing.assert_allclose(found[2], found[0], rtol=2e-4, atol=2e-6)


def moved(flag, by):
    place = np.array([float(word) for word in flag.partition("=")[2].partition(":")[0].split(",")])
    return ",".join(f"{value:.9g}" for value in place + by)


@pytest.mark.flight
def test_a_vehicle_that_flies_nothing_leaves_its_model_and_a_word(here, monkeypatch, capsys):
    given = ["--mass-kg", 27, "--size-m", "0.3,0.3,0.3", "--thruster", "A=0,0.1,0:z:T200"]
    code, _, stderr = call(monkeypatch, capsys, "new", "vehicle", "one", *given)
    assert code == 2
    assert stderr.splitlines()[0].startswith(
        "one/models/one.xml: no scenario is written; `cube-sim analyze one/models/one"
    )
    assert stderr.splitlines()[1] == "one/models/one.xml: flies none of the paths that were tried"
    tried = stderr.splitlines()[2:]
    assert len(set(tried)) == len(tried) == 8
    assert all(re.search(r": -?[0-9.e+-]+ m, at most [0-9.]+ m is right$|: [a-z]", line) for line in tried), tried
    assert sorted(path.name for path in here.glob("one/*")) == ["conftest.py", "models", "tests"]


@pytest.mark.flight
def test_two_types_of_thrusters_and_a_hull_that_does_not_float_are_told(here, unflown, monkeypatch, capsys):
    write_stl(here / "hull.stl", ellipsoid((0.4, 0.2, 0.2), 1), binary=True)
    given = [
        "--mass-kg",
        80,
        "--mesh",
        "hull.stl",
        "--centre-of-mass-m",
        "0.05,0,0.02",
        *FLAGS[:-1],
        "T6=0,0.11,0:z:T500",
    ]
    code, _, stderr = call(monkeypatch, capsys, "new", "vehicle", "brick", *given)
    assert code == 0
    notes = stderr.splitlines()
    assert [note.startswith("NOTE: ") for note in notes] == [True] * 3
    assert "it sinks with" in notes[0]
    assert "the hull leans" in notes[1]
    assert "upside down" in notes[2]
    model = cube_sim.load_model("brick/models/brick.xml")
    limits = cube_sim.Vehicle.from_model(model).thrusters.limits
    np.testing.assert_allclose(limits[[0, 5], 3], [5.25 * 9.80665, 9.3 * 9.80665], rtol=1e-4)


MASS, SIZE = ("--mass-kg", "11.5"), ("--size-m", "0.46,0.34,0.25")
URDF = """<robot name="r">
  <link name="base_link">
    <inertial><origin xyz="0 0 -0.02"/><mass value="10"/>
      <inertia ixx="0.2" iyy="0.3" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://nowhere/hull.dae"/></geometry></visual>
  </link>
  <link name="arm">
    <inertial><origin xyz="0.1 0 0"/><mass value="2"/>
      <inertia ixx="0.001" iyy="0.002" izz="0.003" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base_link"/><child link="arm"/><origin xyz="0.2 0 0" rpy="0 0 1.5707963267948966"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>
"""


def test_a_urdf_gives_mass_and_inertia_of_its_links(here, unflown, monkeypatch, capsys):
    (here / "robot.urdf").write_text(URDF)
    code, _, stderr = call(monkeypatch, capsys, "new", "vehicle", "rov", "--urdf", "robot.urdf", *SIZE, *FLAGS)
    assert code == 0
    assert "the hull leans" in stderr
    model = cube_sim.load_model("rov/models/rov.xml")
    at = np.array([[0.0, 0.0, -0.02], [0.2, 0.1, 0.0]])
    centre = (10 * at[0] + 2 * at[1]) / 12
    own = np.diag([0.2, 0.3, 0.4]) + np.diag([0.002, 0.001, 0.003])  # the arm is turned by a right angle
    away = at - centre
    shifted = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip((10, 2), away, strict=True))
    body = model.body("hull")
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, body.iquat)
    turn = turn.reshape(3, 3)
    assert body.mass[0] == pytest.approx(12.0)
    np.testing.assert_allclose(body.ipos, centre, atol=1e-5)
    np.testing.assert_allclose(turn @ np.diag(body.inertia) @ turn.T, own + shifted, atol=1e-5)


def test_a_hull_of_an_unlikely_size_is_taken_where_its_owner_insists_and_told(here, unflown, monkeypatch, capsys):
    size = ("--size-m", "1.8,1.3,1.0", "--neutral")
    code, _, stderr = call(monkeypatch, capsys, "new", "vehicle", "rov", *MASS, *size, *FLAGS)
    assert code == 0
    assert "displaces 2.34e+03 kg of water, and the vehicle weighs 11.5 kg; is the unit right" in stderr


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (("ro-v",), "ro-v: is no name of a vehicle; letters, digits and _ are right, a letter first"),
        (("there",), "there: is there already; give another name"),
        (("rov", *MASS), "missing: --mesh or --size-m, --thruster or --thrusters; see cube-sim new vehicle --help"),
        (("rov", *MASS, "--size-m", "1,2", *FLAGS), "--size-m 1,2: three numbers [m] are right, for example"),
        (("rov", *MASS, "--size-m", "1,2,0", *FLAGS), "--size-m 1,2,0: length, width and height [m] are positive"),
        (("rov", "--mass-kg", "-1", *SIZE, *FLAGS), "--mass-kg -1: a mass [kg] is positive"),
        (("rov", *MASS, *SIZE, "--mesh", "x.stl", *FLAGS), "--mesh and --size-m: one of the two says what the hull is"),
        (
            ("rov", *MASS, *SIZE, "--unit", "in", *FLAGS),
            "--unit and --size-m: the unit is that of a mesh; a size is in metres",
        ),
        (
            ("rov", *MASS, "--size-m", "18,13,10", "--neutral", *FLAGS),
            "a closed box of 18 x 13 x 10 m: displaces 2.34e+06 kg of water, and the vehicle weighs 11.5 kg; is the "
            "unit right (--size-m is in metres)? --neutral does not mend that",
        ),
        (
            ("rov", *MASS, "--mesh", "mm.stl", *FLAGS),
            "mm.stl: displaces 9.13e+10 kg of water, and the vehicle weighs 11.5 kg; is the unit right (a smaller "
            "--unit)? Say --neutral if it is",
        ),
        (
            ("rov", *MASS, "--mesh", "mm.stl", "--unit", "mm", "--mass-kg", "1e6", *FLAGS),
            "mm.stl: displaces 91.3 kg of water, and the vehicle weighs 1e+06 kg; is the unit right (a larger --unit)?",
        ),
        (
            ("rov", *MASS, "--size-m", "460,340,250", *FLAGS),
            "a closed box of 460 x 340 x 250 m: displaces 3.91e+10 kg of water, and the vehicle weighs 11.5 kg; is the "
            "unit right (--size-m is in metres)?",
        ),
        (
            ("rov", *MASS, *SIZE, *FLAGS, "--centre-of-mass-m", "0,0,-5"),
            "centre of mass at 0, 0, -5 m: is far outside a closed box of 0.46 x 0.34 x 0.25 m",
        ),
        (("rov", *MASS, "--urdf", "r.urdf", *SIZE, *FLAGS), "--mass-kg and --urdf: one of the two says what the"),
        (("rov", *MASS, "--mesh", "x.stl", *FLAGS), "x.stl: cannot be read: No such file or directory"),
        (("rov", "--urdf", "cut.urdf", *SIZE, *FLAGS), "cut.urdf:7:20: is no XML"),
        (("rov", "--urdf", "none.urdf", *SIZE, *FLAGS), "none.urdf: cannot be read: No such file or directory"),
        (("rov", *MASS, *SIZE, "--frame", "NED", *FLAGS), "--frame NED: FLU or FRD is right"),
        (("rov", *MASS, *SIZE, "--unit", "km", *FLAGS), "--unit km: m, cm, mm, in, ft are right"),
        (
            ("rov", *MASS, *SIZE, "--thruster", "T1=0,0:x:T200"),
            "--thruster T1=0,0:x:T200: '0,0' is not a place [m]; three numbers are",
        ),
        (
            ("rov", *MASS, *SIZE, "--thruster", "T1=0,0,0:w:T200"),
            "--thruster T1=0,0,0:w:T200: 'w' is not an axis; three numbers are",
        ),
        (
            ("rov", *MASS, *SIZE, "--thruster", "T1=0,0,0:x:T100"),
            "--thruster T1=0,0,0:x:T100: 'T100' is no thruster that is known by name; T200, T500 are",
        ),
        (
            ("rov", *MASS, *SIZE, "--thruster", "T1 0,0,0:x"),
            "--thruster T1 0,0,0:x: is not of the form NAME=x,y,z:axis:TYPE, for example T1=0.15,-0.11,0:1,1,0:T200",
        ),
        (("rov", *MASS, *SIZE, *FLAGS, *FLAGS[:2]), f"{' '.join(FLAGS[:2])}: the name T1 is taken already; each"),
        (("rov", *MASS, *SIZE, "--thruster", "T1=150,0,0:x:T200"), "--thruster T1=150,0,0:x:T200: thruster T1 is 150"),
        (("rov", *MASS, *SIZE, *FLAGS, "--voltage-v", "nan"), "T200: has tables from 10 to 20 V, not at nan"),
        (("rov", "--mass-kg", "nan", *SIZE, *FLAGS), "--mass-kg nan: a mass [kg] is positive"),
        (("rov", *MASS, "--mesh", "there.stl", *FLAGS), "there.stl: cannot be read: Is a directory"),
        (("rov", *MASS, *SIZE, "--thrusters", "few.csv"), "few.csv:3: has 7 values; 8 are right"),
        (("rov", *MASS, *SIZE, "--thrusters", "far.csv"), "far.csv:4: thruster T2 is 140 m from the middle of a hull"),
        (("rov", *MASS, *SIZE, "--thrusters", "zero.csv"), "zero.csv:4: its axis has no length; the direction in"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_and_nothing_is_written(given, told, here, unflown, monkeypatch, capsys):
    (here / "there").mkdir()
    (here / "there.stl").mkdir()
    (here / "there" / "mine").write_text("mine")
    write_stl(here / "mm.stl", ellipsoid((400.0, 300.0, 300.0), 0))
    (here / "cut.urdf").write_text(URDF[:300])
    (here / "few.csv").write_text(FRD.replace("1,-1,0,T200", "1,-1,0"))
    (here / "far.csv").write_text(FRD.replace("T2, 0.14", "T2, 140"))
    (here / "zero.csv").write_text(FRD.replace(" 1, 1,0", " 0, 0,0"))
    before = sorted(here.rglob("*"))
    code, stdout, stderr = call(monkeypatch, capsys, "new", "vehicle", *given)
    assert (code, stdout, stderr.count("\n")) == (2, "", 1), stderr
    assert stderr.startswith(told), stderr
    assert sorted(here.rglob("*")) == before


OWN = """thruster,voltage_V,pulse_us,force_kgf,power_W
M1,12,1100,-2,
M1,12,1380,-0.4,
M1,12,1620,0.5,
M1,12,1900,2.5,
"""


def test_a_table_of_ones_own_is_taken_at_its_voltage_and_without_power(here, unflown, monkeypatch, capsys):
    (here / "own.csv").write_text(OWN)
    flags = [flag.replace("T200", "M1").replace("t200", "M1") for flag in FLAGS]
    given = [*MASS, *SIZE, *flags, "--thruster-table", "own.csv"]
    code, _, stderr = call(monkeypatch, capsys, "new", "vehicle", "rov", *given)
    assert code == 0
    assert [note.partition(",")[0].partition(";")[0] for note in stderr.splitlines()] == [
        "NOTE: M1 at 12 V: back",
        "NOTE: M1 at 12 V: ahead",
        "NOTE: M1 at 12 V: its table has no power",
    ]
    text = (here / "rov/models/rov.xml").read_text()
    assert "thruster_power" not in text
    assert 'name="hull:thruster_voltage" data="12"' in text
    low, dead_low, dead_high, high = cube_sim.Vehicle.from_model(
        cube_sim.load_model("rov/models/rov.xml")
    ).thrusters.limits[0]
    np.testing.assert_allclose([low, high], [-2 * 9.80665, 2.5 * 9.80665], rtol=1e-4)
    assert -0.5 < dead_low < 0.0 < dead_high < 0.5


@pytest.mark.parametrize("there", [False, True])
def test_where_writing_fails_nothing_stays(there, here, few_panels, monkeypatch, capsys):
    def write(model, file, hull, voltages=None):
        assert model.exists()
        file.write_text("half")
        raise OSError(28, "No space left on device", str(file))

    monkeypatch.setattr("cube_sim.commands.new.write_scenario", write)
    if there:
        (here / "rov").mkdir()
    before = sorted(here.rglob("*"))
    code, stdout, stderr = call(monkeypatch, capsys, "new", "vehicle", "rov", *MASS, *SIZE, *FLAGS)
    assert (code, stdout) == (2, "")
    assert stderr == "rov/scenarios/rov_first.yaml: cannot be written: No space left on device\n"
    assert sorted(here.rglob("*")) == before


def test_on_a_terminal_what_is_missing_is_asked_for(here, unflown, monkeypatch, capsys):
    answers = iter(["11.5", "0.3,0.3,0.3", *SIX[:3], "T4=nowhere", *SIX[3:], ""])
    monkeypatch.setattr("typer.prompt", lambda text, type=str, **_: type(next(answers)))
    monkeypatch.setattr("sys.stdin", type("Terminal", (), {"isatty": lambda self: True})())
    code, stdout, stderr = call(monkeypatch, capsys, "new", "vehicle", "cubic")
    assert code == 0
    assert stderr.startswith("--thruster T4=nowhere: is not of the form")
    assert "models/cubic.xml" in stdout
    assert len(cube_sim.Vehicle.from_model(cube_sim.load_model("cubic/models/cubic.xml")).thrusters.names) == 6
