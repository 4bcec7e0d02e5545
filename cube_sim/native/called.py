"""What compiled code calls, without machine code of its own.

numba optimises every function, makes machine code of it and a door for Python in front of it; then it puts the function
into the module of each that calls it, and optimises and translates it there again. Here a function that compiled code
calls stays LLVM's code for its callers. Only what Python calls, or what is called by its address, becomes machine code,
with all that it calls in it. That is a third of the time that compiling takes.
"""

from __future__ import annotations

from typing import Any

import llvmlite.binding as llvm
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompileResult
from numba.core.compiler_machinery import FunctionPass, register_pass
from numba.core.typed_passes import NoPythonSupportedFeatureValidation

from cube_sim.native.lent import LendingCompiler


class CalledCompiler(LendingCompiler):
    """The compiler up to code that is put into other code."""

    def define_pipelines(self) -> list[Any]:
        """The passes, writing into a `CalledLibrary`."""
        [passes] = super().define_pipelines()
        passes.add_pass_after(_IntoCalledLibrary, NoPythonSupportedFeatureValidation)
        passes.finalize()
        return [passes]


class CalledCache(FunctionCache):
    """On disk, beside that of the same function for callers in Python."""

    class _impl_class(CompileResultCacheImpl):  # noqa: N801 - numba's name
        @property
        def filename_base(self) -> str:
            return f"{super().filename_base}.called"

        def rebuild(self, target_context: Any, payload: Any) -> Any:
            (name, code), fndesc, env, signature, objectmode, lifted, annotation, reload_init, environments = payload
            library = CalledLibrary(target_context.codegen(), name)
            library.take(code)
            return CompileResult(
                target_context=target_context,
                typing_context=target_context.typing_context,
                library=library,
                environment=env,
                entry_point=target_context.get_executable(library, fndesc, env),
                fndesc=fndesc,
                type_annotation=annotation,
                signature=signature,
                objectmode=objectmode,
                lifted=lifted,
                typing_error=None,
                call_helper=None,
                metadata=None,
                reload_init=reload_init,
                referenced_envs=environments,
            )


class CalledLibrary(JITCodeLibrary):
    """LLVM's code of a function and of what it calls, each function tidied up for itself."""

    def take(self, code: bytes) -> None:
        """Hold code that `serialize_using_object_code` has given."""
        self._final_module = llvm.parse_bitcode(code)
        self._finalize_final_module()

    def serialize_using_object_code(self) -> Any:
        """Name and code, kept on disk where numba would keep machine code."""
        return self.name, self._get_module_for_linking().as_bitcode()

    def get_pointer_to_function(self, name: str) -> int:
        """0: there is no machine code."""
        return 0

    @property
    def codegen(self) -> Any:
        """For numba to write into machine code what there is none for."""
        return _Nowhere

    def _optimize_final_module(self) -> None:
        """Its callers are optimised whole."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True


class _Nowhere:
    @staticmethod
    def set_env(name: str, env: Any) -> None:
        """Leave out what code needs that raises Python's exceptions; compiled laws raise none."""


@register_pass(mutates_CFG=False, analysis_only=True)
class _IntoCalledLibrary(FunctionPass):
    _name = "into_called_library"

    def __init__(self) -> None:  # numba has it written out
        super().__init__()

    def run_pass(self, state: Any) -> Any:
        state.library = CalledLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        return False
