"""Thrusters known by name give the published thrust, at published voltages and between them."""

import numpy as np
import pytest
from support.places import CUBE

import cube_sim
from cube_sim.errors import ModelError
from cube_sim.vehicle.characteristic import Characteristic
from cube_sim.vehicle.known_thrusters import NEWTONS_IN_KGF, known_names, known_thruster
from cube_sim.vehicle.thruster_tables import read_tables

# Rows of the published tables that are not in the file: thrust [kgf] at these pulse widths [us], by voltage.
WIDTHS = [1120, 1160, 1200, 1240, 1320, 1640, 1720, 1800, 1880]
PUBLISHED = {
    10: [-2.18, -1.84, -1.54, -1.22, -0.67, 0.55, 1.18, 1.91, 2.77],
    12: [-2.76, -2.34, -1.95, -1.53, -0.87, 0.71, 1.48, 2.46, 3.50],
    16: [-3.87, -3.31, -2.71, -2.20, -1.20, 1.03, 2.12, 3.42, 5.01],
    18: [-4.35, -3.71, -2.96, -2.36, -1.33, 1.08, 2.22, 3.72, 5.67],
    20: [-4.74, -3.96, -3.13, -2.44, -1.32, 1.02, 2.25, 3.96, 6.26],
}


def curve(of):
    return Characteristic(of.commands, of.forces, of.force_dead_zone)


@pytest.mark.parametrize("voltage", PUBLISHED)
def test_a_t200_makes_the_published_thrust(voltage):
    """Within 3 % of every row, and of what the table reads to: 0.01 kgf."""
    of = curve(known_thruster("T200", voltage))
    for pulse, thrust in zip(WIDTHS, PUBLISHED[voltage], strict=True):
        made = float(of.force((pulse - 1500) / 400)) / NEWTONS_IN_KGF
        assert made == pytest.approx(thrust, rel=0.03, abs=0.01), pulse


def test_between_two_tables_it_makes_what_the_one_left_out_says():
    """14 V: 4.52 kgf ahead and 3.52 kgf back are published; the law of the square would be 10 % off from 12 V."""
    of = known_thruster("t200", 14.0)
    assert of.forces[-1] / NEWTONS_IN_KGF == pytest.approx(4.52, rel=0.03)
    assert of.forces[0] / NEWTONS_IN_KGF == pytest.approx(-3.52, rel=0.03)
    assert "interpolated between 12 and 16 V" in of.source


def test_interpolation_meets_the_tables():
    for voltage in (10.0, 12.0, 16.0, 18.0):
        there, close = known_thruster("T200", voltage), known_thruster("T200", voltage + 1e-9)
        for command in np.linspace(-0.997, 0.997, 41):
            assert curve(close).force(command) == pytest.approx(float(curve(there).force(command)), abs=1e-6)


def test_16_volts_are_what_the_shipped_models_have():
    of, shipped = known_thruster("T200"), cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE)).thrusters
    np.testing.assert_allclose([of.forces[0], *of.force_dead_zone, of.forces[-1]], shipped.limits[0], atol=0.05)
    np.testing.assert_allclose(of.power, [1.449, 0.997], rtol=0.08)


@pytest.mark.parametrize(("voltage", "back", "ahead"), [(16, -6.2, 9.3), (24, -10.5, 16.1)])
def test_a_t500_makes_the_published_full_thrust(voltage, back, ahead):
    of = known_thruster("T500", voltage)
    np.testing.assert_allclose([of.forces[0], of.forces[-1]], NEWTONS_IN_KGF * np.array([back, ahead]))
    assert of.source.endswith("(estimate)")


@pytest.mark.parametrize("name", known_names())
@pytest.mark.parametrize("voltage", [16.0, 17.3, 19.0])
def test_every_one_makes_a_model(name, voltage):
    of = known_thruster(name, voltage)
    pairs = np.column_stack([of.commands, of.forces]).ravel()
    given = {"hull:thruster_characteristic": pairs, "hull:thruster_dead_zone": of.force_dead_zone}
    thrusters = cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE, given)).thrusters
    np.testing.assert_allclose(thrusters.limits[0, [0, 3]], of.forces[[0, -1]])


def test_others_are_refused():
    with pytest.raises(ModelError, match="T100: is no thruster that is known by name; T200, T500 are"):
        known_thruster("T100")
    with pytest.raises(ModelError, match="T200: has tables from 10 to 20 V, not at 24"):
        known_thruster("T200", 24.0)


OWN = """thruster,voltage_V,pulse_us,force_kgf,power_W
# ours, on a spring balance
M1,12,1100,-1.0,
M1,12,1450,-0.1,
M1,12,1500,0,
M1,12,1550,0.2,
M1,12,1900,2.0,
M1,14,1100,-1.4,80
M1,14,1450,-0.1,2
M1,14,1550,0.2,2
M1,14,1900,2.6,90
"""


def test_tables_of_ones_own_are_interpolated_alike(tmp_path):
    (tmp_path / "own.csv").write_text(OWN)
    tables = read_tables(tmp_path / "own.csv")
    of = known_thruster("m1", 13.0, tables)
    np.testing.assert_allclose(of.forces[[0, -1]], NEWTONS_IN_KGF * np.array([-1.2, 2.3]))
    assert of.force_dead_zone == pytest.approx((-0.1 * NEWTONS_IN_KGF, 0.2 * NEWTONS_IN_KGF))
    assert known_thruster("T200", 16.0, tables).forces[-1] == known_thruster("T200").forces[-1]
    with pytest.raises(ModelError, match="M2: is no thruster that is known by name; M1, T200, T500 are"):
        known_thruster("M2", 12.0, tables)


def test_a_table_without_a_dead_zone_gives_a_curve_that_goes_on_rising(tmp_path):
    close = OWN.replace("M1,12,1450,", "M1,12,1498,").replace("M1,12,1550,", "M1,12,1502,")
    (tmp_path / "own.csv").write_text(close)
    of = known_thruster("M1", 12.0, read_tables(tmp_path / "own.csv"))
    assert (np.diff(of.commands) > 0.0).all()
    made = curve(of).force(np.array([-0.0051, 0.0, 0.0051])) / NEWTONS_IN_KGF
    np.testing.assert_allclose(made, [-0.1, 0.0, 0.2], rtol=2e-3)


def test_a_table_of_one_voltage_serves_that_one(tmp_path):
    (tmp_path / "own.csv").write_text("".join(line for line in OWN.splitlines(True) if "M1,14" not in line))
    with pytest.raises(ModelError, match="M1: has tables at 12 V alone, not at 16; take such a voltage"):
        known_thruster("M1", None, read_tables(tmp_path / "own.csv"))


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ("M1,12,1000,-1,0", ":12: a name, a voltage above 0, a pulse of 1100 to 1900 us are right"),
        ("M1,12,one,-1,0", ":12: '12,one,-1,0' are not four numbers"),
        ("M1,12,1100", ":12: has 3 values; 5 are right"),
        ("M2,12,1100,-1,0\nM2,12,1800,2,0", ":13: M2 at 12 V has one row a side, at 1800 us; full throttle is right"),
        ("M1,12,1100,18500,0", ":12: 18500 kgf is more than a thruster makes (500); kilograms-force are right"),
        ("M1,12,1800,2.1,0", ":7: M1 at 12 V falls from 2.1 kgf at 1800 us to 2 kgf at 1900 us; force rises with"),
        ("M1,12,1800,-1.9,0", ":12: M1 at 12 V does not push back below 1500 us and ahead above"),
    ],
)
def test_mistakes_in_tables_are_one_line_with_their_place(row, told, tmp_path):
    (tmp_path / "own.csv").write_text(OWN + row + "\n")
    with pytest.raises(ModelError) as raised:
        read_tables(tmp_path / "own.csv")
    assert str(raised.value).startswith(f"{tmp_path / 'own.csv'}{told}")


# Published rows of 12 V, kgf as they stand: 1104 us gives more back than 1100, 1892 more ahead than 1896.
PULSES = [1100, 1104, 1108, 1464, 1536, 1540, 1892, 1896, 1900]
FORCES = [-2.90, -2.92, -2.89, 0.0, 0.0, 0.04, 3.71, 3.69, 3.71]


def test_a_table_that_falls_by_its_last_digits_is_taken_at_their_mean():
    pairs = np.column_stack([(np.array(PULSES) - 1500) / 400, NEWTONS_IN_KGF * np.array(FORCES)])
    zone = [pairs[2, 1], pairs[5, 1]]
    given = {"hull:thruster_characteristic": pairs.ravel(), "hull:thruster_dead_zone": zone}
    thrusters = cube_sim.Vehicle.from_model(cube_sim.load_model(CUBE, given)).thrusters
    np.testing.assert_allclose(thrusters.limits[0, [0, 3]], NEWTONS_IN_KGF * np.array([-2.91, 3.71]), rtol=1e-9)
    assert thrusters.force(np.full(8, (1894 - 1500) / 400))[0] == pytest.approx(3.70 * NEWTONS_IN_KGF)


def test_a_table_that_falls_further_is_refused_with_the_row():
    pairs = np.column_stack([(np.array(PULSES) - 1500) / 400, NEWTONS_IN_KGF * np.array(FORCES)])
    pairs[7, 1] -= 1.0
    given = {"hull:thruster_characteristic": pairs.ravel(), "hull:thruster_dead_zone": [-28.0, 0.4]}
    with pytest.raises(ModelError, match=r"fall from 36.38\d* to 35.18\d* N at pair 8 \(command 0.99\)"):
        cube_sim.load_model(CUBE, given)


def test_below_a_table_that_begins_at_much_throttle_it_has_the_shape_of_a_t200(tmp_path):
    """Rows at 30, 60 and 100 %, twice a T200's: all of the curve is twice a T200's, first thrust as well."""
    like = known_thruster("T200")
    rows = [-1.0, -0.6, -0.3, 0.3, 0.6, 1.0]
    kgf = 2.0 * np.interp(rows, like.commands, like.forces) / NEWTONS_IN_KGF
    lines = [f"M1,12,{1500 + 400 * at:g},{force:.9g}," for at, force in zip(rows, kgf, strict=True)]
    own = tmp_path / "own.csv"
    own.write_text("\n".join([OWN.splitlines()[0], *lines]))
    of = known_thruster("M1", 12.0, read_tables(own))
    low = np.linspace(-0.3, 0.3, 61)
    np.testing.assert_allclose(curve(of).force(low), 2.0 * curve(like).force(low), rtol=1e-6, atol=1e-6)
    assert of.force_dead_zone == pytest.approx(tuple(2.0 * np.array(like.force_dead_zone)))
    assert [remark.partition(";")[0] for remark in of.remarks[:2]] == [
        "M1 at 12 V: back, its table begins at 1380 us",
        "M1 at 12 V: ahead, its table begins at 1620 us",
    ]
    own.write_text(own.read_text() + "\nM1,12,1600,0,\nM1,12,1400,0,\n")
    measured = known_thruster("M1", 12.0, read_tables(own))
    assert measured.force_dead_zone == pytest.approx((NEWTONS_IN_KGF * kgf[2], NEWTONS_IN_KGF * kgf[3]))
    assert len(measured.remarks) == 1  # of its power


def test_power_that_is_left_empty_is_not_none(tmp_path):
    own = tmp_path / "own.csv"
    own.write_text(OWN.replace("M1,12,1900,2.0,", "M1,12,1900,2.0,90"))
    of = known_thruster("M1", 12.0, read_tables(own))
    assert of.power is None  # of one direction nothing is known
    assert of.remarks == ("M1 at 12 V: its table has no power, so there is no model of a battery",)
    own.write_text(own.read_text().replace("M1,12,1100,-1.0,", "M1,12,1100,-1.0,95"))
    assert known_thruster("M1", 12.0, read_tables(own)).power == pytest.approx(
        (95 / NEWTONS_IN_KGF**1.5, 90 / (2 * NEWTONS_IN_KGF) ** 1.5)
    )
