"""A vehicle's MJCF with one thing slightly wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree import ElementTree

import numpy as np


def thrusters_moved(text: str, offset_m: Sequence[float] | Mapping[str, Sequence[float]]) -> str:
    """Thrusters off their places by (3,) [m], body axes: all alike, or each named one by its own."""
    root = ElementTree.fromstring(text)
    for name, site in _sites(root).items():
        offset = offset_m.get(name, (0.0, 0.0, 0.0)) if isinstance(offset_m, Mapping) else offset_m
        site.set("pos", _row(_numbers(site.get("pos", "0 0 0")) + np.asarray(offset, float)))
    return _text(root)


def thrusters_scattered(text: str, distance_m: float, seed: int) -> str:
    """Each thruster off its place by this distance, in a direction of its own."""
    rng = np.random.default_rng((41, seed))
    off = {}
    for name in _sites(ElementTree.fromstring(text)):
        direction = rng.normal(size=3)
        off[name] = distance_m * direction / np.linalg.norm(direction)
    return thrusters_moved(text, off)


def buoyancy_moved(text: str, offset_m: Sequence[float]) -> str:
    """The centre of buoyancy off its place by (3,) [m], body axes."""
    root = ElementTree.fromstring(text)
    numeric = _numeric(root, "centre_of_buoyancy")
    numeric.set("data", _row(_numbers(numeric.get("data", "")) + np.asarray(offset_m, float)))
    return _text(root)


def lift_changed(text: str, share: float) -> str:
    """Lift off the weight by a share of it: 0.02 floats up, -0.02 sinks."""
    root = ElementTree.fromstring(text)
    numeric = _numeric(root, "volume")
    numeric.set("data", _row((1.0 + share) * _numbers(numeric.get("data", ""))))
    return _text(root)


def with_reaction(text: str, reaction_m: float) -> str:
    """Every propeller twists its hull by this torque per newton of thrust [m], of either sign, beside its own."""
    root = ElementTree.fromstring(text)
    for actuator in _thrusters(root):
        gear = _gear(root, actuator)
        gear[5] += reaction_m
        actuator.set("gear", _row(gear))
    return _text(root)


def with_efficiency(text: str, efficiency: Mapping[str, float]) -> str:
    """Named thrusters give a share of their force."""
    root = ElementTree.fromstring(text)
    for actuator in _thrusters(root):
        gear = _gear(root, actuator) * efficiency.get(actuator.get("name", ""), 1.0)
        actuator.set("gear", _row(gear))
    return _text(root)


def with_current(text: str, rows: Sequence[Sequence[float]]) -> str:
    """Water that moves: rows time [s], height z [m], v_x, v_y, v_z [m/s], on a full grid of times and heights."""
    root = ElementTree.fromstring(text)
    custom = root.find("custom")
    assert custom is not None
    ElementTree.SubElement(custom, "numeric", name="water:current", data=_row(rows))
    return _text(root)


def _thrusters(root: ElementTree.Element) -> list[ElementTree.Element]:
    return root.findall("actuator/general")


def _sites(root: ElementTree.Element) -> dict[str, ElementTree.Element]:
    """Name of a thruster -> its site."""
    sites = {site.get("name"): site for site in root.iter("site") if site.get("name")}
    return {str(a.get("name")): sites[a.get("site")] for a in _thrusters(root)}


def _gear(root: ElementTree.Element, actuator: ElementTree.Element) -> np.ndarray:
    """(6,) the actuator's own gear, or that of its class; in these files one class at most says a gear."""
    said = actuator.get("gear") or next((g.get("gear") for g in root.iter("general") if g.get("gear")), None)
    gear = np.zeros(6)
    values = _numbers(said or "1")
    gear[: len(values)] = values
    return gear


def _numeric(root: ElementTree.Element, parameter: str) -> ElementTree.Element:
    return next(n for n in root.iter("numeric") if n.get("name", "").endswith(f":{parameter}"))


def _numbers(text: str) -> np.ndarray:
    return np.array([float(word) for word in text.split()])


def _row(values: object) -> str:
    return " ".join(f"{value:.12g}" for value in np.ravel(np.asarray(values, float)))


def _text(root: ElementTree.Element) -> str:
    return ElementTree.tostring(root, encoding="unicode")
