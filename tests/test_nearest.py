"""A few names are all told, of many the nearest."""

from cube_sim.nearest import among, counted


def test_a_few_are_all_told_in_their_order():
    assert among("x", ["b", "a"]) == "b, a"
    assert among("x", []) == "none"


def test_of_many_the_nearest_three_are():
    many = ["mass", "inertia", "volume", "Added_Mass", "drag", "lag", "centre", "volume2", "lift"]
    assert among("aded_mas", many).startswith("9, the nearest Added_Mass, mass, ")
    assert among("aded_mas", many).count(",") == 3


def test_one_is_not_several():
    assert [counted(n, "value") for n in (0, 1, 2)] == ["0 values", "1 value", "2 values"]
