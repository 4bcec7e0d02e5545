"""Compiled callbacks kept on disk as object files, and loaded without the compiler.

numba's own cache needs numba's typing machinery before it can load a line (0.7 s). Linking an object file takes
milliseconds. A file is named by everything its code depends on. So a stale one is never found, only left behind.
"""

from __future__ import annotations

import hashlib
import os
import re
import stat
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm

from cube_sim.native.sources import source_digest

_DIGEST_SIZE = 32
_ALONE, _LEANING = ".o", ".numba.o"  # files of code that needs nobody, and of code that needs numba's runtime
_engines: list[Any] = []  # they own the executable memory


def addresses(
    key: str,
    build: Callable[[], Mapping[str, Any]],
    names: tuple[str, ...],
    runtime: Callable[[], None] | None = None,
) -> dict[str, int]:
    """Addresses of compiled callbacks, from disk when they are there, else from `build`.

    Args:
        key: everything the code depends on besides this machine's processor, LLVM and this file.
        build: makes name -> numba cfunc; called only when the disk has no usable file.
        names: the callbacks wanted.
        runtime: makes numba's runtime known to the linker, for code that leans on it; with None such code is not kept.
    """
    _initialise()
    versions = f"{llvmlite.__version__} {llvm.llvm_version_info}"
    parts = [key, processor(), versions, source_digest(__name__)]
    digest = hashlib.sha256("\n".join(parts).encode()).hexdigest()[:20]
    folders, endings = cache_folders(), (_ALONE,) if runtime is None else (_ALONE, _LEANING)
    for folder in folders:
        for ending in endings:
            objects = {name: read(folder / f"{name}-{digest}{ending}") for name in names}
            if all(objects.values()):
                if runtime is not None and ending == _LEANING:
                    runtime()
                return {name: _link(code, name) for name, code in objects.items() if code}
    compiled = build()
    for ending in endings:
        objects = {
            name: emit(compiled[name].inspect_llvm(), compiled[name].native_name, name, leaning=ending == _LEANING)
            for name in names
        }
        if all(objects.values()):
            break
    else:
        return {name: keep(compiled[name]) for name in names}
    for folder in folders:
        if all(write(folder / f"{name}-{digest}{ending}", code) for name, code in objects.items() if code):
            break
    return {name: _link(code, name) for name, code in objects.items() if code}


def keep(compiled: Any) -> int:
    """Address of a numba cfunc, which lives from now on as long as the process."""
    _engines.append(compiled)
    return int(compiled.address)


def cache_folders() -> list[Path]:
    """Where object files may lie, best first: a folder the user names, beside the code, the user's cache, scratch."""
    named = os.environ.get("CUBE_SIM_CACHE_DIR")
    if named:
        # That of an image may be its maker's alone: what is missing there is kept elsewhere.
        return [Path(named)] if _writable(Path(named)) else [Path(named), _scratch()]
    own = _users_cache()
    beside = Path(__file__).parent / "__pycache__"
    return [beside, *([] if own is None else [own / "cube_sim"]), _scratch()]


def numba_folder() -> str:
    """Where numba keeps what it compiles; "" where its own choice is right: its own variable, beside the code, a home.

    A user whom the machine does not know has no home, and numba would make a folder called ~ wherever it runs.
    """
    if os.environ.get("NUMBA_CACHE_DIR"):
        return ""
    named = os.environ.get("CUBE_SIM_CACHE_DIR")
    if named and _writable(Path(named)):
        return str(Path(named) / "numba")
    own = _users_cache()
    if _writable(Path(__file__).parents[1]) or (own is not None and _writable(own)):
        return ""
    scratch = _scratch()
    return str(scratch / "numba") if _ours_alone(scratch) else ""


def _users_cache() -> Path | None:
    """The user's own cache; None where the user has no home."""
    named = os.environ.get("XDG_CACHE_HOME")
    folder = Path(named) if named else Path(os.path.expanduser("~")) / ".cache"
    return folder if folder.is_absolute() else None


def _scratch() -> Path:
    return Path(tempfile.gettempdir()) / f"cube_sim-{os.getuid() if hasattr(os, 'getuid') else 'user'}"


def _writable(folder: Path) -> bool:
    """Whether a folder, or the first above it that there is, can be written to."""
    there = next(each for each in (folder, *folder.parents) if each.exists())
    return os.access(there, os.W_OK | os.X_OK)


def _ours_alone(folder: Path) -> bool:
    """Make a folder in a place that is everybody's; whether nobody else can put anything there."""
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return False
    if not hasattr(os, "getuid"):
        return True
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o022


def emit(text: str, symbol: str, name: str, leaning: bool = False) -> bytes | None:
    """An object file for this processor from LLVM code, its entry renamed; None if it leans on Python's runtime.

    numba leaves every function replaceable at link time. So LLVM may not conclude that none of ours ever raises. Made
    internal, they lose all the code that would report exceptions, and with it every tie to Python. They are inlined
    too, which numba forbids for what a cfunc calls: its arrays would be handed on piece by piece through memory.

    Args:
        text: LLVM IR of a cfunc.
        symbol: the entry's name there.
        name: the entry's name in the object file.
        leaning: the code may lean on Python and numba, whose symbols are known to the linker now.
    """
    text = re.sub(
        rf"^define (?:linkonce_odr )?(?=[^\n]*@(?!{re.escape(symbol)}\())", "define internal ", text, flags=re.M
    )
    module = llvm.parse_assembly(re.sub(r"(?<=[{ ])noinline(?= )", "nounwind", text))
    module.get_function(symbol).name = name
    for function in module.functions:
        if function.linkage == llvm.Linkage.internal and not function.name.startswith("NRT_"):
            function.add_function_attribute("alwaysinline")
    target = machine()
    builder = llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options(speed_level=3))
    builder.getModulePassManager().run(module, builder)
    module.verify()
    outside = [f.name for f in module.functions if f.is_declaration and not f.name.startswith("llvm.")]
    outside += [g.name for g in module.global_variables if g.is_declaration]
    for other in outside:
        if not leaning and other.startswith(("Py", "_Py", "numba_", "NRT_")):
            return None
        if llvm.address_of_symbol(other) is None:
            return None
    return target.emit_object(module)


def _initialise() -> None:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


def machine() -> Any:
    """What makes code for this processor."""
    _initialise()
    return llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=3,
        reloc="default",
        codemodel="jitdefault",
        jit=True,
    )


def processor() -> str:
    """Names this machine's processor and what it can do."""
    return f"{llvm.get_host_cpu_name()} {llvm.get_host_cpu_features().flatten()}"


def _link(code: bytes, name: str) -> int:
    return linked(code).get_function_address(name)


def linked(code: bytes) -> Any:
    """What knows the addresses in an object file, which is in memory from now on as long as the process lives.

    Every name it takes from outside must be known: LLVM ends the process otherwise.
    """
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine())
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return engine


def read(path: Path) -> bytes | None:
    """The object code of a whole file that belongs to this user or the system; None for any other."""
    try:
        content = path.read_bytes()
        owner = path.stat().st_uid
    except OSError:
        return None
    if hasattr(os, "getuid") and owner not in (0, os.getuid()):
        return None
    code = content[_DIGEST_SIZE:]
    return code if code and hashlib.sha256(code).digest() == content[:_DIGEST_SIZE] else None


def write(path: Path, code: bytes) -> bool:
    """Write at once or not at all; other processes may be reading or writing the same file."""
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as file:
            file.write(hashlib.sha256(code).digest() + code)
        Path(name).chmod(0o644)  # an installation is shared; nobody but its owner may change it
        Path(name).replace(path)
    except OSError:
        return False
    return True
