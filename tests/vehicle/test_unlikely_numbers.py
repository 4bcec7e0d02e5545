"""Numbers that are most likely not meant are named when a model is loaded, and to whoever flies it."""

import warnings
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from support.ballasted import MODEL
from support.catalogue.steered import steered_by_fins
from support.catalogue.vehicles import catalogue
from support.drawn_torpedo import drawn_torpedo
from support.lifting import Fin, Lifted
from support.places import MODEL_FILES, MODELS
from support.water_bodies import Body

import cube_sim
from cube_sim.vehicle.loading import load_unsaid
from cube_sim.vehicle.mjcf.open_water import best_efficiency
from cube_sim.vehicle.remarks import cautions, remarks
from cube_sim.vehicle.unlikely.words import unlikely_words

X, Y, Z = np.eye(3)
RUDDER = Fin("rudder", np.array([-0.6, 0.0, 0.0]), X, Y, 0.01, 3.0, servo=(0.1, 0.5))
HULL = Body(added=np.diag([1.0, 10.0, 10.0, 0.1, 1.0, 1.0])).neutral()


@pytest.mark.parametrize(
    ("fin", "told"),
    [
        (replace(RUDDER, area=200.0), "has an area of 200 m.2, on a hull of"),
        (replace(RUDDER, slope=0.06), "has a lift slope of 0.06 per radian"),
        (replace(RUDDER, servo=(0.1, 45.0)), "turns by 45 rad/s"),
        (replace(RUDDER, chord=-X), "chord pointing astern"),
        (replace(RUDDER, chord=Z), "chord across the hull's x axis"),
    ],
)
def test_what_is_most_likely_not_meant_is_named(fin, told):
    with pytest.warns(UserWarning, match=f"fin 'rudder' .*{told}"):
        model = cube_sim.load_model(Lifted(HULL, (fin,)).spec())
    said = cautions(model, cube_sim.Vehicle.from_model(model))
    assert said[0].startswith("fin 'rudder' ")


@pytest.mark.parametrize("change", [{}, {"chord": X - 0.5 * Z}, {"slope": 1.1}, {"servo": (0.1, 9.0)}])
def test_what_may_well_be_meant_is_not(change):
    fin = replace(RUDDER, **change)
    fin = replace(fin, chord=fin.chord / np.linalg.norm(fin.chord))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cube_sim.load_model(Lifted(HULL, (fin,)).spec())


@pytest.mark.parametrize(("places", "told"), [((0.6, 0.5), True), ((0.6, -0.6), False)])
def test_fins_that_all_lie_ahead_are_told(places, told):
    fins = tuple(replace(RUDDER, name=f"fin{x:g}", place=np.array([x, 0.0, 0.0])) for x in places)
    model = cube_sim.load_model(Lifted(HULL, fins).spec())
    said = remarks(model, cube_sim.Vehicle.from_model(model))
    assert any(each.startswith("all its fins lie ahead of its centre of mass") for each in said) is told


def test_who_says_it_himself_hears_nothing_of_python():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = load_unsaid(Lifted(HULL, (replace(RUDDER, area=200.0),)).spec())
    assert "has an area of 200 m^2" in unlikely_words(model)[0]


ARM, REMUS = MODELS / "bluerov2_arm.xml", MODELS / "remus100_propeller.xml"


def edited(old, new, text=MODEL):
    assert text.count(old) == 1
    return mujoco.MjSpec.from_string(text.replace(old, new))


@pytest.mark.parametrize(
    ("spec", "told"),
    [
        (edited("-1e-3 1e-3", "-30e-3 30e-3"), "ballast 'bladder' takes up to 0.03 m^3, on a vehicle that displaces"),
        (edited("-1e-3 1e-3", "-0.5 0.1"), "ballast 'bladder' takes up to -0.5 m^3"),
        (edited("0 2e-3", "0 2"), "ballast 'tank' takes up to 2 m^3"),
        (edited("0.5 5e-5", "0.5 0.05"), "ballast 'bladder' is pumped by 0.05 m^3/s"),
        (edited('density" data="1000"/>\n  </c', 'density" data="1"/></c'), "tank:ballast_density is 1 kg/m^3"),
        (edited('density" data="1000"/>\n  </c', 'density" data="1e6"/></c'), "tank:ballast_density is 1e+06 kg/m^3"),
        (edited('"bladder" pos="0.1 0 0"', '"bladder" pos="150 0 0"'), "site 'bladder' lies 150 m from"),
        (edited('"bow" pos="0.4 0 0"', '"bow" pos="400 0 0"'), "site 'bow' lies 400 m from"),
        (edited('volume" data="0.054"', 'volume" data="54"'), "hull:volume is 54 m^3, and 'hull' has a mass of 54 kg"),
        (edited('mass="50"', 'mass="50000"'), "hull:volume is 0.054 m^3, and 'hull' has a mass of 5e+04 kg"),
        (edited('water:density" data="1000"', 'water:density" data="1.025"'), "water:density is 1.025 kg/m^3"),
        (edited('gravity="0 0 -9.81"', 'gravity="0 0 -9810"'), "gravity is 9810 m/s^2"),
        (edited('inertia="0.6 9 9"', 'inertia="6e5 9e6 9e6"'), "inertia of 'hull' is 6e+05 9e+06 9e+06 kg m^2"),
        (edited('inertia="0.6 9 9"', 'inertia="6e-4 9e-3 9e-3"'), "inertia of 'hull' is 0.0006 0.009 0.009 kg m^2"),
    ],
)
def test_ballast_sites_and_volumes_in_another_unit_are_named(spec, told):
    with pytest.warns(UserWarning, match=r"\[.*\]") as warned:
        model = cube_sim.load_model(spec)
    said = [str(each.message) for each in warned]
    assert [each.startswith(told) for each in said] == [True], said
    assert cautions(model, cube_sim.Vehicle.from_model(model))[0] == said[0]


@pytest.mark.parametrize("gear", ["1", "-2"])
@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('kp="2000"', 'kp="-2000"', "servo 'battery' has a kp of -2000: it pushes joint 'slide' away from where it is"),
        ('ctrlrange="-0.3 0.3"', 'ctrlrange="-300 300"', "servo 'battery' takes commands from -300 to 300 m, and its"),
        ('ctrlrange="-0.3 0.3"', 'ctrlrange="-0.3 17"', "servo 'battery' takes commands from -0.3 to 17 m, and its"),
        ('ctrlrange="-0.3 0.3"', 'ctrlrange="-2 5"', None),
    ],
)
def test_servos_that_push_away_and_commands_far_beyond_the_joint_are_named(old, new, gear, told):
    text = MODEL.replace(old, new).replace('kv="400" gear="1 0 0 0 0 0"', f'kv="400" gear="{gear} 0 0 0 0 0"')
    said = unlikely_words(load_unsaid(mujoco.MjSpec.from_string(text)))
    assert [each.startswith(str(told)) for each in said] == ([True] if told else [])


@pytest.mark.parametrize(("reactions", "told"), [((0.0, 0.0), 1), ((0.1, 0.1), 1), ((0.1, -0.1), 0)])
def test_thrusters_at_one_site_are_named_unless_they_turn_against_one_another(reactions, told):
    text = MODEL
    for name, reaction in zip(("port", "starboard"), reactions, strict=True):
        text = text.replace(f'name="{name}" site="{name}"', f'name="{name}" site="port" gear="0 0 1 0 0 {reaction}"')
    said = unlikely_words(load_unsaid(mujoco.MjSpec.from_string(text)))
    assert [each.startswith("thrusters 'port' and 'starboard' both push at site 'port'") for each in said] == told * [
        True
    ]


def test_gravity_that_points_up_is_named():
    with pytest.warns(UserWarning, match=r"^gravity is 0 0 9\.81 m/s\^2 and points up"):
        cube_sim.load_model(edited('gravity="0 0 -9.81"', 'gravity="0 0 9.81"'))


@pytest.mark.parametrize(
    ("parameter", "values", "told"),
    [
        ("propeller_open_water", (0, 0.45, 0.65, 0.4, 0.3, 0.48, 0.9, 0.06, 0.18), "turns 5.8% of its .* not 10 K_Q"),
        (
            "propeller_open_water",
            (0, 4.5, 0.065, 0.4, 3.0, 0.048, 0.9, 0.6, 0.018),
            "turns [0-9]+% of .* which none does",
        ),
        ("propeller_open_water", (0, 0.45, 0.0065, 0.4, 0.3, 0.0048, 0.9, 0.06, 0.0018), "turns 584% of .* none does"),
        ("propeller_wake", (0.85, 0.9), "has a wake fraction w of 0.85 and a thrust deduction t of 0.9; .* not 1 - w"),
    ],
)
def test_other_coefficients_of_propellers_than_those_asked_for_are_named(parameter, values, told):
    with pytest.warns(UserWarning, match=f"the propeller at 'propeller' {told}"):
        cube_sim.load_model(REMUS, {f"propeller:{parameter}": values})


def test_the_best_efficiency_is_that_of_straight_lines():
    """K_T = a (1 - J), K_Q = c: J (1 - J) a / (2 pi c) is largest at J = 1/2."""
    best, J = best_efficiency(np.array([[0.0, 0.4, 0.02], [0.5, 0.2, 0.02]]))
    assert (best, J) == pytest.approx((0.4 / (8.0 * np.pi * 0.02), 0.5), rel=1e-12)


@pytest.mark.parametrize("factor", [1e9, 1e6, 1e4, 1e3, 1e-3, 1e-6])
@pytest.mark.parametrize("path", MODEL_FILES, ids=lambda path: path.stem)
def test_inertia_in_another_unit_is_named_on_all_kinds_of_vehicles(path, factor):
    model = load_unsaid(path)
    model.body_inertia[:] *= factor
    said = [each for each in unlikely_words(model) if each.startswith("inertia of 'hull'")]
    assert len(said) == 1
    assert "is it in [kg m^2]?" in said[0]


@pytest.mark.parametrize(
    ("path", "parameter", "factor", "told"),
    [
        (ARM, "forearm:volume", 1e3, "forearm:volume is"),
        (ARM, "forearm:volume", 1e6, "forearm:volume is"),
        (ARM, "forearm:centre_of_buoyancy", 1e3, "forearm:centre_of_buoyancy is"),
        (ARM, "hull:centre_of_buoyancy", 1e3, "hull:centre_of_buoyancy is"),
        (REMUS, "propeller:propeller_speed", 60.0, "the propeller at 'propeller' turns with 1500 rev/s"),
        (REMUS, "propeller:propeller_diameter", 1e3, "the propeller at 'propeller' has a diameter of 140 m"),
    ],
)
def test_links_and_propellers_in_another_unit_are_named(path, parameter, factor, told):
    values = cube_sim.load_model(path).numeric(parameter).data.copy()
    model = cube_sim.load_model(path)
    assert unlikely_words(model) == []
    cube_sim.set_parameters(model, {parameter: factor * values})
    said = unlikely_words(model)
    assert [each.startswith(told) for each in said] == [True], said


def test_vehicles_of_all_kinds_are_told_of_nothing():
    specs = {path.stem: mujoco.MjSpec.from_file(str(path)) for path in MODEL_FILES}
    specs |= {n: mujoco.MjSpec.from_string(e.make()) for n, e in catalogue().items() if not e.lost and n not in specs}
    others = {
        **{n: e.make() for n, e in steered_by_fins().items()},
        **{f"{s}": drawn_torpedo(s).text for s in range(9)},
    }
    specs |= {name: mujoco.MjSpec.from_string(text) for name, text in others.items()}
    assert len(specs) > 65
    assert {name: said for name, spec in specs.items() if (said := unlikely_words(load_unsaid(spec)))} == {}
