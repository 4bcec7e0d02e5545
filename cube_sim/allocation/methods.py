"""The names of all ways of allocating. Nothing compiled is needed to know them."""

from __future__ import annotations

from typing import Literal, get_args

from cube_sim.wrench.arguments import one_of

Method = Literal["search+proxqp", "search", "enumerate", "enumerate_parallel"]
"""``search+proxqp``: the exact search decides the subset, ProxQP solves it and must agree. ``search``: without ProxQP.
``enumerate``: the report's own algorithm, one ProxQP for each of the 2^m or 3^m subsets. ``enumerate_parallel``: the
same spread over the processor's cores."""

BaselineMethod = Literal["contraction", "compensation", "pseudo_inverse", "clipped_pseudo_inverse"]
"""Methods that try their best: the two strategies of Ropars et al. (2018) and the two everybody knows."""


def methods() -> tuple[str, ...]:
    """Names of all methods, the exact ones first."""
    return (*get_args(Method), *get_args(BaselineMethod))


def is_exact(method: str) -> bool:
    """Whether a method's answer is the optimum over the union of subsets.

    Raises:
        WrenchError: there is no such method.
    """
    return one_of("method", method, methods()) in get_args(Method)
