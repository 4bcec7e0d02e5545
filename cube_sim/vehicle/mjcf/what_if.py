"""A model with some of its values other than its file has them: what if the thrusters sat lower.

A setting is ``KEY=VALUE``, ``KEY+=VALUE`` or ``KEY*=VALUE``, with numbers as YAML has them. A key is

    site:NAME.pos        place of a site on its body [m]; NAME may have * and ?, and then stands for every site it fits
    site:NAME.zaxis      direction of a site's z axis, along which a thruster pushes; only = takes it
    <hull>:mass, ...     any parameter that `load_model` takes
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import ModelError
from cube_sim.nearest import among, counted

_SETTING = re.compile(r"(?P<key>[^=]+?)\s*(?P<how>[+*]?=)(?P<value>.*)", re.DOTALL)
_SITE = re.compile(r"site:(?P<pattern>[^:]+)\.(?P<attribute>\w+)")
_ATTRIBUTES = ("pos", "zaxis")


class Setting(NamedTuple):
    """One value that is to be another.

    Attributes:
        text: as written.
        key: what is set.
        how: "=", "+=" or "*=".
        values: (n,) numbers.
    """

    text: str
    key: str
    how: str
    values: NDArray[np.float64]

    def on(self, old: NDArray[np.float64]) -> NDArray[np.float64]:
        """The new values, in place of `old` (n,).

        Raises:
            ModelError: their number does not go with it.
        """
        if self.how == "=":
            return self.values
        if self.values.size not in (1, old.size):
            raise ModelError(
                self.text,
                f"has {counted(self.values.size, 'number')} for {old.size}; 1 or {old.size} are right",
            )
        return old + self.values if self.how == "+=" else old * self.values


def read_setting(text: str, parse: Any) -> Setting:
    """A setting as written.

    Args:
        text: it.
        parse: text -> plain data, with ValueError.

    Raises:
        ModelError: it is none.
    """
    found = _SETTING.fullmatch(text.strip())
    if found is None:
        raise ModelError(text, "write KEY=VALUE, KEY+=VALUE or KEY*=VALUE, as in site:T1.pos+=[0,0,-0.05]")
    try:
        values = np.atleast_1d(np.asarray(parse(found["value"]), dtype=np.float64)).ravel()
    except (TypeError, ValueError):
        raise ModelError(text, f"{found['value'].strip()!r:.60} is no number and no list of numbers") from None
    if not values.size or not np.isfinite(values).all():
        raise ModelError(text, "takes finite numbers")
    return Setting(text, found["key"].strip(), found["how"], values)


def set_sites(spec: mujoco.MjSpec, settings: Sequence[Setting]) -> list[Setting]:
    """Move and turn sites of a spec.

    Args:
        spec: changed here.
        settings: in their order.

    Returns:
        Those that are of no site.

    Raises:
        ModelError: no such site or attribute, or values that are not three.
    """
    others = []
    for setting in settings:
        if not setting.key.startswith("site:"):
            others.append(setting)
            continue
        found = _SITE.fullmatch(setting.key)
        if found is None or found["attribute"] not in _ATTRIBUTES:
            raise ModelError(setting.text, f"a site has {' and '.join(_ATTRIBUTES)}, as in site:T1.pos=[0.2,0,0]")
        names = [site.name for site in spec.sites if site.name]
        meant = [name for name in names if fnmatchcase(name, found["pattern"])]
        if not meant:
            pattern = found["pattern"]
            raise ModelError(setting.text, f"no site '{pattern}'; the model has {among(pattern, names)}")
        for name in meant:
            _set_site(spec.site(name), found["attribute"], setting)
    return others


def _set_site(site: mujoco.MjsSite, attribute: str, setting: Setting) -> None:
    if attribute == "pos":
        moved = setting.on(np.array(site.pos))
        if moved.size != 3:
            raise ModelError(setting.text, f"has {moved.size} numbers; a place has 3")
        site.pos = moved
        return
    length = float(np.linalg.norm(setting.values))
    if setting.how != "=" or setting.values.size != 3 or length == 0.0:
        raise ModelError(setting.text, "a direction is set with =, and has 3 numbers, not all 0")
    quaternion = np.zeros(4)
    mujoco.mju_quatZ2Vec(quaternion, setting.values / length)
    site.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    site.quat = quaternion


def parameters_of(settings: Sequence[Setting], values: Mapping[str, NDArray[np.float64]]) -> dict[str, Any]:
    """Parameters for `load_model`.

    Args:
        settings: of no sites.
        values: of the model as it is, by name, for those that are relative.
    """
    given: dict[str, NDArray[np.float64]] = {}
    for setting in settings:
        old = given.get(setting.key, values.get(setting.key, setting.values))
        given[setting.key] = setting.on(old)
    return given
