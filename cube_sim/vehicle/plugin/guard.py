"""MuJoCo's steps for compiled code, from which an error of MuJoCo's comes back as a result.

MuJoCo ends the process when it cannot go on, an arena that overflows for one; its functions do not expect whoever
handles an error to return. Python's bindings jump out of it. Here the same is done for compiled code: each of the
functions notes where it stands, and a handler of MuJoCo's messages jumps back there. What it jumps over is MuJoCo's C
and our callbacks, which own nothing. Threads of which none is inside such a function are left to the handler before.

mjData have to be reset after an error.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import Any

import llvmlite.binding as llvm
import mujoco

from cube_sim.native import object_cache
from cube_sim.vehicle.plugin.structs import offsets

TEXT_BYTES = 1024
"""Of the buffer that gets MuJoCo's words, zeros behind them."""
_VELOCITY = int(mujoco.mjtStage.mjSTAGE_VEL)
_CALLS = {
    "forward": ("call void @mj_forward(i64 %model, i64 %data)",),
    "forward_again": (f"call void @mj_forwardSkip(i64 %model, i64 %data, i32 {_VELOCITY}, i32 0)",),
    "step_on": (
        f"call void @mj_forwardSkip(i64 %model, i64 %data, i32 {_VELOCITY}, i32 0)",
        "call void @mj_checkAcc(i64 %model, i64 %data)",
        "call void @mj_RungeKutta(i64 %model, i64 %data, i32 4)",
    ),
    "step": ("call void @mj_step(i64 %model, i64 %data)",),
}
"""What each function does, from the addresses of an mjModel and an mjData."""
NAMES = {role: f"cube_sim_{role}" for role in _CALLS}
"""By which the linker knows the functions int64 f(model, data, text): 0, or 1 after an error, whose words are in the
text then."""
_DECLARED = """
declare void @mj_forward(i64, i64)
declare void @mj_forwardSkip(i64, i64, i32, i32)
declare void @mj_checkAcc(i64, i64)
declare void @mj_RungeKutta(i64, i64, i32)
declare void @mj_step(i64, i64)
"""
_PLAIN = """
define i64 @{name}(i64 %model, i64 %data, i64 %text) {{
  {calls}
  ret i64 0
}}
"""
_DECLARED_TOO = """
declare i32 @_setjmp(ptr) returns_twice
declare void @longjmp(ptr, i32) noreturn
declare i32 @pthread_setspecific({key_kind}, ptr)
declare ptr @pthread_getspecific({key_kind})
declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)
"""
# A place is 768 bytes, more than any platform's jmp_buf, and behind them the address of the text.
_GUARDED = """
define i64 @{name}(i64 %model, i64 %data, i64 %text) {{
  %place = alloca [776 x i8], align 64
  %behind = getelementptr i8, ptr %place, i64 768
  store i64 %text, ptr %behind
  %1 = call i32 @pthread_setspecific({key}, ptr %place)
  %jumped = call i32 @_setjmp(ptr %place) returns_twice
  %first = icmp eq i32 %jumped, 0
  br i1 %first, label %go, label %failed
go:
  {calls}
  %2 = call i32 @pthread_setspecific({key}, ptr null)
  ret i64 0
failed:
  %3 = call i32 @pthread_setspecific({key}, ptr null)
  ret i64 1
}}
"""
_HANDLER = """
define void @cube_sim_message(ptr %message) {{
  %levelled = getelementptr i8, ptr %message, i64 {level}
  %level = load i32, ptr %levelled
  %place = call ptr @pthread_getspecific({key})
  %bad = icmp sge i32 %level, {error}
  %here = icmp ne ptr %place, null
  %ours = and i1 %bad, %here
  br i1 %ours, label %back, label %on
back:
  %behind = getelementptr i8, ptr %place, i64 768
  %text = load ptr, ptr %behind
  %words = getelementptr i8, ptr %message, i64 {subject}
  call void @llvm.memcpy.p0.p0.i64(ptr %text, ptr %words, i64 {bytes}, i1 false)
  call void @longjmp(ptr %place, i32 1)
  unreachable
on:
  %before = inttoptr i64 {before} to ptr
  call void %before(ptr %message)
  ret void
}}
"""
"""A handler of MuJoCo's messages; those that are none of its business go to the one before."""
_engines: list[object] = []


def guards() -> bool:
    """Whether an error comes back, which it does where there are POSIX threads; elsewhere it ends the process."""
    return sys.platform != "win32"


@cache
def publish(library: str) -> None:
    """Make the functions known to the linker.

    Args:
        library: file of MuJoCo's, loaded.
    """
    given: dict[str, Any] = {}
    engine = ctypes.CDLL(library)
    if guards():
        # The handler before is told only by setting another: the default one, for a moment.
        engine.mju_setLogHandler.restype = ctypes.c_void_p
        engine.mju_setLogHandler.argtypes = [ctypes.c_void_p]
        key = _thread_key()
        fields = offsets("mjLogMessage", ("level", "subject"))
        given = {"key": key, "key_kind": key.split()[0], "before": engine.mju_setLogHandler(None), **fields}
        given |= {"error": int(mujoco.mjtLogLevel.mjLOG_ERROR), "bytes": TEXT_BYTES}
    template = _GUARDED if guards() else _PLAIN
    parts = [template.format(name=NAMES[role], calls="\n  ".join(calls), **given) for role, calls in _CALLS.items()]
    text = _DECLARED + (_DECLARED_TOO + _HANDLER if guards() else "").format(**given) + "".join(parts)
    machine = llvm.create_mcjit_compiler(llvm.parse_assembly(text), object_cache.machine())
    machine.finalize_object()
    _engines.append(machine)  # it owns the code
    for name in NAMES.values():
        llvm.add_symbol(name, machine.get_function_address(name))
    if guards():
        engine.mju_setLogHandler(machine.get_function_address("cube_sim_message"))


def _thread_key() -> str:
    """A number of which each thread has one of its own, nothing at first; as LLVM has it."""
    kind, name = (ctypes.c_uint64, "i64") if sys.platform == "darwin" else (ctypes.c_uint32, "i32")
    key = kind()
    if ctypes.CDLL(None).pthread_key_create(ctypes.byref(key), None) != 0:
        raise OSError("no key left for numbers of threads")
    return f"{name} {key.value}"
