"""Vehicles that their fins steer, each at a speed at which they do: the trials fly them beside the catalogue.

They have no part in drawn missions, whose speeds are for thrusters.
"""

from __future__ import annotations

import re
from functools import cache

from support.catalogue.vehicles import Entry
from support.finned import x_tail
from support.places import MODELS

BALLASTED_M3 = 0.029888
"""Volume of REMUS 100 with 3 N of lift; the 9 N of the thesis its fins hold on no course."""


@cache
def steered_by_fins() -> dict[str, Entry]:
    """Name -> vehicle: those of models/, REMUS 100 as printed and with ballast, and drawn torpedoes."""
    made = (
        Entry("remus100", (MODELS / "remus100.xml").read_text, speed_m_s=1.2),
        Entry("remus100_ballasted", _ballasted, speed_m_s=1.2),
        Entry("remus100_propeller", (MODELS / "remus100_propeller.xml").read_text, speed_m_s=1.2),
        Entry("nps_auv2", (MODELS / "nps_auv2.xml").read_text, speed_m_s=1.5),
        Entry("x_tail", x_tail, speed_m_s=0.8),
        Entry("x_tail_slow", x_tail, speed_m_s=0.2),
        Entry("x_tail_bow_planes", lambda: x_tail(bow_planes=True), speed_m_s=0.8),
        Entry("rudder_and_plane", lambda: x_tail(makes_roll=False), speed_m_s=0.8),
    )
    return {entry.name: entry for entry in made}


def _ballasted() -> str:
    text = (MODELS / "remus100.xml").read_text()
    return re.sub(r'(name="hull:volume" data=)"[^"]*"', rf'\1"{BALLASTED_M3}"', text)
