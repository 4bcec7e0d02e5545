"""models/torpedo.xml with a propeller in its inflow in place of its characteristic, and scenarios for it."""

from __future__ import annotations

from pathlib import Path

from support.places import MODELS, SCENARIOS

NUMERICS = """
    <numeric name="propeller:propeller_diameter" data="0.14"/>
    <numeric name="propeller:propeller_speed" data="10 12"/>
    <numeric name="propeller:propeller_open_water" data="0 0.4566 0.07 0.6632 0.1798 0.0312"/>
    <numeric name="propeller:propeller_wake" data="0.056 0.1"/>
    <numeric name="propeller:propeller_slowest" data="0.5 0.5"/>
    <numeric name="propeller:propeller_hand" data="-1"/>
"""
WAKE, DEDUCTION, DIAMETER, FASTEST = 0.056, 0.1, 0.14, 12.0


def thrust(n: float, u: float) -> float:
    """The propeller's, delivered [N], at n [rev/s] ahead and u [m/s]."""
    u_a = (1.0 - WAKE) * u
    slope = (0.1798 - 0.4566) / 0.6632
    return (1.0 - DEDUCTION) * 1000.0 * DIAMETER**3 * n * (0.4566 * DIAMETER * n + slope * u_a)


def drag(u: float) -> float:
    """Of the hull ahead [N]."""
    return u + 4.0 * u * abs(u)


def propelled_torpedo(folder: Path, numerics: str = NUMERICS) -> Path:
    """Its model, written into a folder."""
    text = (MODELS / "torpedo.xml").read_text()
    curve, zone = (
        next(line for line in text.splitlines(True) if f"propeller:thruster_{each}" in line)
        for each in ("characteristic", "dead_zone")
    )
    for old, new in (
        (curve, numerics),
        (zone, ""),
        ('gear="0 0 1 0 0 0.01"', 'gear="0 0 1 0 0 0" dyntype="user" dynprm="0.05 0.15"'),
    ):
        assert old in text
        text = text.replace(old, new)
    path = folder / "propelled.xml"
    path.write_text(text)
    return path


def line_scenario(folder: Path, speed_m_s: float = 0.8, duration_s: float = 60.0, more: str = "") -> Path:
    """A line that it flies, as scenarios/torpedo_line.yaml does, written into a folder."""
    propelled_torpedo(folder)
    text = (SCENARIOS / "torpedo_line.yaml").read_text()
    for old, new in (
        ("../models/torpedo.xml", "propelled.xml"),
        ("duration_s: 80", f"duration_s: {duration_s:g}"),
        ("end_m: [60, 0, -10]", "end_m: [200, 0, -10]"),
        ("speed_m_s: 0.4", f"speed_m_s: {speed_m_s:g}"),
        ("    from_s: 40\n    at_most: 0.02", "    at_most: 0.5"),
    ):
        assert old in text
        text = text.replace(old, new)
    path = folder / "propelled_line.yaml"
    path.write_text(text + more)
    return path
