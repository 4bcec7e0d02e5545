"""What a module says it offers is there, under every name."""

from __future__ import annotations

import pkgutil
from importlib import import_module

import cube_sim


def modules():
    """Every module of the package by its name; `__main__` would run the command line."""
    yield cube_sim
    for found in pkgutil.walk_packages(cube_sim.__path__, "cube_sim."):
        if not found.name.endswith(".__main__"):
            yield import_module(found.name)


def test_every_name_a_module_offers_resolves():
    offering = {module.__name__: module for module in modules() if hasattr(module, "__all__")}
    assert {"cube_sim", "cube_sim.allocation", "cube_sim.actuation", "cube_sim.scenario"} <= set(offering)
    for name, module in offering.items():
        assert len(set(module.__all__)) == len(module.__all__), name
        assert [offered for offered in module.__all__ if not hasattr(module, offered)] == [], name


def test_every_module_says_what_it_holds():
    assert [module.__name__ for module in modules() if not (module.__doc__ or "").strip()] == []
