"""The kernel of OpenBLAS that a run was recorded with, taken again: it is chosen once, when numpy is loaded."""

from __future__ import annotations

import os
import sys
from collections.abc import Collection
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from cube_sim.recording.header import RunHeader

VARIABLE = "OPENBLAS_CORETYPE"
"""By which OpenBLAS is told its kernel."""
OURS = "CUBE_SIM_OPENBLAS_KERNEL_HERE"
"""The kernel that this machine takes by itself: said to the process that takes another one."""
_AVX512 = "avx512f", "avx512cd", "avx512bw", "avx512dq", "avx512vl"


class _Kernel(NamedTuple):
    """A kernel as `VARIABLE` calls it, and what a processor must have for it, by LLVM's names."""

    asked_as: str
    needs: tuple[str, ...]


_KERNELS = {
    "Katmai": _Kernel("Prescott", ("sse3",)),
    "Prescott": _Kernel("Prescott", ("sse3",)),
    "Nehalem": _Kernel("Nehalem", ("sse4.2",)),
    "Sandybridge": _Kernel("Sandybridge", ("avx",)),
    "Haswell": _Kernel("Haswell", ("avx2", "fma")),
    "Zen": _Kernel("Zen", ("avx2", "fma")),
    "SkylakeX": _Kernel("SkylakeX", _AVX512),
    "Cooperlake": _Kernel("Cooperlake", (*_AVX512, "avx512bf16")),
}
"""By the name that a record has for it."""


def take_recorded_kernel(header: RunHeader) -> None:
    """Begin this process anew under the recorded kernel, if it runs under another one and its processor can.

    It does not come back then. A kernel that the user has asked for stays.

    Args:
        header: of the record that is to be flown again.
    """
    from cube_sim.mission.run_header import KERNEL, versions

    ours = versions().get(KERNEL, "")
    asked = asked_for(header.versions.get(KERNEL, ""), ours, _abilities())
    # A program that calls the command within its own process goes on under its own kernel.
    if asked and VARIABLE not in os.environ and "replay" in sys.argv[1:]:
        sys.stdout.flush()
        sys.stderr.flush()
        environment = os.environ | {VARIABLE: asked, OURS: ours}
        os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)


def asked_for(recorded: str, ours: str, abilities: Collection[str]) -> str:
    """What to ask OpenBLAS for; "" where there is nothing to ask, or no use in it.

    Args:
        recorded: kernel of the record; "" for none.
        ours: that of this process.
        abilities: of this machine's processor, by LLVM's names.
    """
    kernel = _KERNELS.get(recorded)
    if kernel is None or not ours or recorded == ours or not set(kernel.needs) <= set(abilities):
        return ""
    return kernel.asked_as


def kernel_taken() -> tuple[str, str] | None:
    """The recorded kernel, under which this process runs, and the machine's own; None where it runs under that."""
    from cube_sim.mission.run_header import KERNEL, versions

    taken, ours = versions().get(KERNEL, ""), os.environ.get(OURS, "")
    return (taken, ours) if ours and taken != ours else None


def _abilities() -> set[str]:
    from llvmlite.binding import get_host_cpu_features

    return {name for name, has in get_host_cpu_features().items() if has}
