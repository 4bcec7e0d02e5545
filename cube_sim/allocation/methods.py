"""Every way of allocating, by name."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from inspect import signature
from typing import Any, Literal, Protocol, get_args

from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation
from cube_sim.allocation.allocator import Allocator, Method
from cube_sim.allocation.baselines.compensation import Compensation
from cube_sim.allocation.baselines.contraction import Contraction
from cube_sim.allocation.baselines.pseudo_inverse import PseudoInverse
from cube_sim.allocation.previous import Standing
from cube_sim.errors import AllocationError
from cube_sim.wrench.arguments import one_of

SimpleMethod = Literal["contraction", "compensation", "pseudo_inverse", "clipped_pseudo_inverse"]
"""Methods that try their best: the two strategies of Ropars et al. (2018) and the two everybody knows."""

_SIMPLE = {
    "contraction": Contraction,
    "compensation": Compensation,
    "pseudo_inverse": PseudoInverse,
    "clipped_pseudo_inverse": partial(PseudoInverse, clipped=True),
}
_SIMPLE_OPTIONS = ("allow_off", "power_coefficients")
_EXACT_OPTIONS = tuple(name for name in signature(Allocator).parameters if name not in ("A", "limits", "method"))


class WrenchAllocator(Protocol):
    """What the loop needs of an allocator."""

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """Find the forces for one demanded wrench."""
        ...

    def reset(self) -> None:
        """Forget what came before."""
        ...

    def resume(self, standing: Standing) -> None:
        """Go on from where the motors stand, as if this allocator had put them there."""
        ...


def methods() -> tuple[str, ...]:
    """Names of all methods, the exact ones first."""
    return (*get_args(Method), *get_args(SimpleMethod))


def is_exact(method: str) -> bool:
    """Whether a method's answer is the optimum over the union of subsets."""
    return one_of("method", method, methods()) not in _SIMPLE


def make_allocator(
    method: str, A: ArrayLike, limits: ArrayLike, options: Mapping[str, Any] | None = None
) -> WrenchAllocator:
    """Build an allocator by the name of its method.

    Args:
        method: one of `methods`.
        A: see `Allocator`.
        limits: see `Allocator`.
        options: keyword arguments of `Allocator`; the simple methods take ``allow_off`` and ``power_coefficients``.

    Raises:
        AllocationError: an unknown method, an option the method does not know, or one that means nothing.
    """
    given = dict(options or {})
    if is_exact(method):
        unknown = sorted(set(given) - set(_EXACT_OPTIONS))
        if unknown:
            raise AllocationError(f"{method} knows no {', '.join(unknown)}; it takes {', '.join(_EXACT_OPTIONS)}")
        return Allocator(A, limits, method=method, **given)  # type: ignore[arg-type]
    unknown = sorted(set(given) - set(_SIMPLE_OPTIONS))
    if unknown:
        raise AllocationError(f"{method} knows no {', '.join(unknown)}; it takes {', '.join(_SIMPLE_OPTIONS)}")
    return _SIMPLE[method](A, limits, **given)
