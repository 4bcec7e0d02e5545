"""Arguments are lent: a compiled function reads them where they lie and keeps no account of who holds their arrays.

numba counts references: a function takes a share in each array of its arguments, field by field of each named tuple,
and gives each back on every way out. It also loads a named tuple whole, down to the last stride of its last array, to
look at one field. With parts of hundreds of arrays that is most of what there is to compile. But whoever calls a
function holds its arguments until it returns. So here

- an argument, and a field of one, is counted only where it is stored or returned: numba does that there in any case;
- of a named tuple that is an argument, or lies in one, only the field asked for is loaded.

A variable that is assigned twice is numba's as before.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from llvmlite import ir as llvm_ir
from numba.core import ir, types
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.lowering import Lower
from numba.core.typed_passes import BaseNativeLowering, NativeLowering


class LendingLower(Lower):
    """From numba's intermediate code to LLVM's, with arguments that are lent."""

    def init(self) -> None:
        """Find what is lent, before anything is translated."""
        super().init()
        self._lent: set[str] = set()
        self._places: dict[str, tuple[str, tuple[int, ...]]] = {}
        if self.func_ir.func_id.is_generator or self._disable_sroa_like_opt:
            return
        assigned = [assign for block in self.blocks.values() for assign in block.find_insts(ir.Assign)]
        times = Counter(assign.target.name for assign in assigned)
        candidates = [assign for assign in assigned if times[assign.target.name] == 1]
        while found := [
            assign for assign in candidates if assign.target.name not in self._lent and self._lends(assign)
        ]:
            for assign in found:
                self._lend(assign.target.name, assign.value)

    def _lends(self, assign: ir.Assign) -> bool:
        """Whether a variable is an argument, another name for what is lent, or a field of it."""
        target, value = self.typeof(assign.target.name), assign.value
        if isinstance(value, ir.Arg):
            return self.typeof("arg." + value.name) == target
        if isinstance(value, ir.Var):
            return value.name in self._lent and self.typeof(value.name) == target
        field = self._field(value)
        return field is not None and value.value.name in self._lent and self.typeof(value.value.name)[field] == target

    def _field(self, value: Any) -> int | None:
        """Which field of a tuple is asked for; None where it is something else that is."""
        if not isinstance(value, ir.Expr) or value.op not in ("getattr", "static_getitem"):
            return None
        kind = self.typeof(value.value.name)
        if value.op == "getattr":
            return kind.fields.index(value.attr) if isinstance(kind, types.BaseNamedTuple) else None
        at = value.index
        return at if isinstance(kind, types.BaseTuple) and isinstance(at, int) and 0 <= at < len(kind) else None

    def _lend(self, name: str, value: Any) -> None:
        self._lent.add(name)
        if not isinstance(self.typeof(name), types.BaseTuple):
            return
        if isinstance(value, ir.Arg):
            self._singly_assigned_vars.discard(name)  # it lies in memory, where its fields are found
            self._places[name] = name, ()
        elif isinstance(value, ir.Var):
            self._places[name] = self._places[value.name]
        elif (field := self._field(value)) is not None:
            root, path = self._places[value.value.name]
            self._places[name] = root, (*path, field)

    def lower_assign(self, ty: Any, inst: ir.Assign) -> Any:
        """Numba's, but that what is lent is not counted, and loaded as little of as can be."""
        name, value = inst.target.name, inst.value
        field = self._field(value)
        if field is not None and value.value.name in self._places:
            root, path = self._places[value.value.name]
            loaded = self._load(root, (*path, field))
            if name not in self._lent:
                self.incref(ty, loaded)
            return loaded
        if name not in self._lent:
            return super().lower_assign(ty, inst)
        return self.fnargs[value.index] if isinstance(value, ir.Arg) else self.loadvar(value.name)

    def lower_inst(self, inst: Any) -> None:
        """Numba's; a tuple in a tuple that is lent needs no place of its own."""
        if not isinstance(inst, ir.Assign) or self._place_of(inst.target.name)[0] == inst.target.name:
            super().lower_inst(inst)

    def loadvar(self, name: str) -> Any:
        """The value of a variable."""
        root, path = self._place_of(name)
        return super().loadvar(name) if root == name else self._load(root, path)

    def storevar(self, value: Any, name: str, argidx: int | None = None) -> None:
        """Numba's; what is lent was nobody's before."""
        if name in self._lent and name not in self._singly_assigned_vars and argidx is None:
            self._alloca_var(name, self.typeof(name))
            self.builder.store(value, self.getvar(name))
        else:
            super().storevar(value, name, argidx)

    def delvar(self, name: str) -> None:
        """Numba's; nothing is given back of what is lent."""
        if name not in self._lent:
            super().delvar(name)

    def _place_of(self, name: str) -> tuple[str, tuple[int, ...]]:
        """In which variable another one lies, and where in it."""
        return self._places.get(name, (name, ()))

    def _load(self, root: str, path: tuple[int, ...]) -> Any:
        at = [llvm_ir.Constant(llvm_ir.IntType(32), index) for index in (0, *path)]
        return self.builder.load(self.builder.gep(self.getvar(root), at, inbounds=True))


@register_pass(mutates_CFG=True, analysis_only=False)
class _LendingLowering(BaseNativeLowering):
    _name = "lending_lowering"

    @property
    def lowering_class(self) -> Any:
        return LendingLower


class LendingCompiler(CompilerBase):
    """numba's compiler, with arguments that are lent."""

    def define_pipelines(self) -> list[Any]:
        """Numba's own passes but one."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [(_LendingLowering if kind is NativeLowering else kind, name) for kind, name in passes.passes]
        passes.finalize()
        return [passes]
