"""Numbers of fins that are most likely not meant are named when a model is loaded, and to whoever flies it."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from support.lifting import Fin, Lifted
from support.water_bodies import Body

import cube_sim
from cube_sim.vehicle.loading import load_unsaid
from cube_sim.vehicle.mjcf.unused import kept_words
from cube_sim.vehicle.remarks import cautions, remarks

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
    assert "has an area of 200 m^2" in kept_words(model)[0]
