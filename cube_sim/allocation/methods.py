"""Every way of allocating, by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial
from inspect import signature
from typing import Any, get_args

from numpy.typing import ArrayLike

from cube_sim.allocation.baselines.compensation import Compensation
from cube_sim.allocation.baselines.contraction import Contraction
from cube_sim.allocation.baselines.pseudo_inverse import PseudoInverse
from cube_sim.allocation.options import BaselineMethod, Method
from cube_sim.allocation.protocol import WrenchAllocator
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import one_of

BASELINES: dict[str, Callable[..., WrenchAllocator]] = {
    "contraction": Contraction,
    "compensation": Compensation,
    "pseudo_inverse": partial(PseudoInverse, clipped=False),
    "clipped_pseudo_inverse": partial(PseudoInverse, clipped=True),
}
"""What builds each method of `BaselineMethod`, in its order."""
_NOT_OPTIONS = ("A", "limits", "method", "clipped")


def methods() -> tuple[str, ...]:
    """Names of all methods, the exact ones first."""
    return (*get_args(Method), *get_args(BaselineMethod))


def is_exact(method: str) -> bool:
    """Whether a method's answer is the optimum over the union of subsets.

    Raises:
        WrenchError: there is no such method.
    """
    return one_of("method", method, methods()) in get_args(Method)


def make_allocator(
    method: str, A: ArrayLike, limits: ArrayLike, options: Mapping[str, Any] | None = None
) -> WrenchAllocator:
    """Build an allocator by the name of its method.

    The exact ones need the compiled search and ProxQP, which are loaded when the first of them is built.

    Args:
        method: one of `methods`.
        A: see `Allocator`.
        limits: see `Allocator`.
        options: keyword arguments of the method: the exact ones take those of `Allocator`, a baseline those of its
            class, which always has ``allow_off``.

    Raises:
        AllocationError: an unknown method, an option the method does not know, or one that means nothing.
    """
    build = _builder(method)
    given, known = dict(options or {}), _options_of(method)
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise AllocationError(f"{method} knows no {', '.join(unknown)}; it takes {', '.join(known)}")
    return build(A, limits, **given)


def _builder(method: str) -> Callable[..., WrenchAllocator]:
    if not is_exact(method):
        return BASELINES[method]
    from cube_sim.allocation.allocator import Allocator

    return partial(Allocator, method=method)  # type: ignore[arg-type]


@cache
def _options_of(method: str) -> tuple[str, ...]:
    """Names of the keyword arguments that a method takes."""
    return tuple(name for name in signature(_builder(method)).parameters if name not in _NOT_OPTIONS)
