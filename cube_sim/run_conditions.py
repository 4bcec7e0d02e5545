"""Conditions of a flight that its log says begin and end: the words by which who says and who reads them agree."""

from __future__ import annotations

from typing import NamedTuple


class RunCondition(NamedTuple):
    """Something that lasts, and that no signal tells.

    Attributes:
        begins: how the sentence starts that says that it begins, or that it goes on in another way.
        ends: the sentence that says that it is over; "" where it never is.
    """

    begins: str
    ends: str


BATTERY_EMPTY = RunCondition("the battery is empty: the thrusters stand still", "")
SPEED_NOT_KEPT = RunCondition("the thrusters cannot keep ", "the thrusters keep the speed along the path again")
PATH_GIVEN_UP = RunCondition("the path is given up: ", "the path is followed again")
BALLAST_DROPPED = RunCondition("the ballast is dropped", "")
OUT_OF_THE_WATER = RunCondition("the hull comes out of the water: ", "the hull is under water again")
OFF_PATH = RunCondition("the vehicle stays off its path: ", "the vehicle is on its path again")

CONDITIONS = (BATTERY_EMPTY, SPEED_NOT_KEPT, PATH_GIVEN_UP, BALLAST_DROPPED, OUT_OF_THE_WATER, OFF_PATH)

WRENCH_NOT_MADE = {
    "CLOSEST": "the demanded wrench was out of reach, and the closest attainable one made",
    "SCALED": "the demanded wrench was out of reach, and the largest part of it in its direction made",
    "YIELDED": "the demanded wrench was out of reach, and its secondary part gave way to the primary one",
    "MISSED": "the allocation missed the demanded wrench",
    "FORBIDDEN_FORCE": "the allocation asked a thruster for a force outside its allowed set",
    "UNPROVEN": "the demanded wrench was made, perhaps not at the least cost",
    "UNPROVEN_CLOSEST": "no forces making the demanded wrench were found, and the best wrench found made",
}
"""How the sentence starts that tells, when it is over, of a stretch of such answers, by the name of the status."""
