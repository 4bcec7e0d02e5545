"""Every scenario in scenarios/ is a test; a campaign runs only when it is asked for."""

from __future__ import annotations

import os
import sys

import pytest

pytest_plugins = ["cube_sim.testing"]


def pytest_configure(config: pytest.Config) -> None:
    """Let processes that tests start keep bytecode beside the sources, as machine code is, even if told not to.

    There are hundreds, of which each would compile all modules anew: a third of a short command's time.
    """
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


def pytest_collection_finish() -> None:
    """Let tests themselves keep none: they write a module twice within a second, which bytecode is too coarse for."""
    sys.dont_write_bytecode = True


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave campaigns out, whatever else -m selects, unless it names them."""
    if "campaign" in config.option.markexpr:
        return
    left_out = [item for item in items if item.get_closest_marker("campaign")]
    items[:] = [item for item in items if item not in left_out]
    config.hook.pytest_deselected(items=left_out)
