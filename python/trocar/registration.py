# SPDX-License-Identifier: Apache-2.0
"""Names of the environments: ``gymnasium.make("trocar/PegTransfer-v0")`` where Gymnasium can be imported, and ``env.spec``."""
from __future__ import annotations

import copy
import os
from dataclasses import dataclass, field
from typing import Any, Optional

from . import _trocar

try:
    from gymnasium.envs import registration as _gymnasium
except ImportError:
    _gymnasium = None

NAMESPACE, VERSION = "trocar", 0


@dataclass
class _Spec:
    """Of Gymnasium's EnvSpec what says how an environment was made, where Gymnasium is not there."""

    id: str
    entry_point: str
    vector_entry_point: str
    kwargs: dict[str, Any] = field(default_factory=dict)
    reward_threshold: Optional[float] = None
    nondeterministic: bool = False
    max_episode_steps: Optional[int] = None
    order_enforce: bool = False
    disable_env_checker: bool = True
    additional_wrappers: tuple = ()
    namespace: str = NAMESPACE
    name: str = ""
    version: int = VERSION


def environment_id(key: str) -> str:
    """"peg_transfer" is "trocar/PegTransfer-v0"."""
    return f"{NAMESPACE}/{''.join(word.capitalize() for word in key.split('_'))}-v{VERSION}"


def keys() -> list[str]:
    return sorted(_trocar.tasks()) + ["cholecystectomy"]


ENTRY_POINTS = {"entry_point": "trocar.environments:Environment", "vector_entry_point": "trocar.environments:VectorEnvironment"}


def make_spec(task: Any, settings: dict[str, Any]) -> Any:
    """Of an environment that was made without ``gymnasium.make``; None of what has no name there: files and dictionaries."""
    if not isinstance(task, str) or os.path.isfile(task) or task not in keys():
        return None
    kwargs = {"task": task, **copy.deepcopy(settings)}
    if _gymnasium is None:
        return _Spec(environment_id(task), kwargs=kwargs, name=environment_id(task)[len(NAMESPACE) + 1:-len(f"-v{VERSION}")], **ENTRY_POINTS)
    return _gymnasium.EnvSpec(environment_id(task), kwargs=kwargs, order_enforce=False, disable_env_checker=True, **ENTRY_POINTS)


def register_all() -> list[str]:
    """Registers every environment with Gymnasium, where it is there and has not got it yet; importing trocar calls it."""
    if _gymnasium is None:
        return []
    names = []
    for key in keys():
        name = environment_id(key)
        if name not in _gymnasium.registry:
            _gymnasium.register(id=name, kwargs={"task": key}, **ENTRY_POINTS)
        names.append(name)
    return names
