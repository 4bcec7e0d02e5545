"""A few names are all told, of many the nearest."""

from cube_sim.nearest import among


def test_a_few_are_all_told_in_their_order():
    assert among("x", ["b", "a"]) == "b, a"
    assert among("x", []) == "none"


def test_of_many_the_nearest_three_are():
    many = ["mass", "inertia", "volume", "Added_Mass", "drag", "lag", "centre"]
    assert among("aded_mas", many).startswith("7, the nearest Added_Mass, mass, ")
    assert among("aded_mas", many).count(",") == 3
