"""Every scenario in scenarios/ is a test; a campaign runs only when it is asked for."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest_plugins = ["cube_sim.testing"]

HELIX = Path(__file__).parent / "scenarios" / "cube_helix.yaml"


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes() -> None:
    """Leave machine code on disk before several processes look for it: each would make its own."""
    import cube_sim
    from cube_sim.flight.compiled import compile_beside

    if compile_beside():
        cube_sim.Flight(HELIX).fly(50)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave campaigns out, whatever else -m selects, unless it names them."""
    if "campaign" in config.option.markexpr:
        return
    left_out = [item for item in items if item.get_closest_marker("campaign")]
    items[:] = [item for item in items if item not in left_out]
    config.hook.pytest_deselected(items=left_out)
