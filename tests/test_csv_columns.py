"""A first line of a CSV file that is not the one expected is told by what is wrong with it."""

import pytest

from cube_sim.csv_columns import wrong_columns

COLUMNS = ("name", "x_m", "type")


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("name,x_m,kind", "the first line lacks type and has kind, which is not known; name,x_m,type is right"),
        ("name,x_m", "the first line lacks type; name,x_m,type is right"),
        ("name,x_m,type,a,", "the first line has a, an empty one, which are not known; name,x_m,type is right"),
        ("x_m,name,type", "the first line has the columns in another order, or twice; name,x_m,type is right"),
        ("name;x_m;type", "the first line is separated by semicolons; commas are right, and points in numbers"),
        ("name\tx_m\ttype", "the first line is separated by tabs; commas are right, and points in numbers"),
    ],
)
def test_a_wrong_first_line_is_told_by_what_is_wrong_with_it(line, told):
    assert str(wrong_columns(line.split(","), COLUMNS)).startswith(told)


def test_the_right_one_is_right():
    assert wrong_columns(list(COLUMNS), COLUMNS) is None
