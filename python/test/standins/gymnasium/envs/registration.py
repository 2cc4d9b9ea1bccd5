# SPDX-License-Identifier: Apache-2.0
"""Environments by name. What ``make`` asks of an entry point stands in Gymnasium's own: metadata, Env, a spec that can be set."""
import copy
import importlib
import re
from dataclasses import dataclass, field
from typing import Any, Optional

registry: dict = {}
_ID = re.compile(r"^(?:(?P<namespace>[\w:-]+)\/)?(?:(?P<name>[\w:.-]+?))(?:-v(?P<version>\d+))?$")


@dataclass
class EnvSpec:
    id: str
    entry_point: Any = None
    reward_threshold: Optional[float] = None
    nondeterministic: bool = False
    max_episode_steps: Optional[int] = None
    order_enforce: bool = True
    disable_env_checker: bool = False
    kwargs: dict = field(default_factory=dict)
    namespace: Optional[str] = field(init=False)
    name: str = field(init=False)
    version: Optional[int] = field(init=False)
    additional_wrappers: tuple = ()
    vector_entry_point: Any = None

    def __post_init__(self):
        found = _ID.fullmatch(self.id)
        if not found:
            raise ValueError(f"Malformed environment ID: {self.id}")
        self.namespace, self.name = found["namespace"], found["name"]
        self.version = None if found["version"] is None else int(found["version"])


def register(id, entry_point=None, kwargs=None, vector_entry_point=None, **settings):
    registry[id] = EnvSpec(id, entry_point, kwargs=kwargs or {}, vector_entry_point=vector_entry_point, **settings)


def spec(env_id):
    return registry[env_id]


def _load(entry_point):
    module, name = entry_point.split(":")
    return getattr(importlib.import_module(module), name)


def _find(id):
    module, _, name = id.rpartition(":")
    if module:
        importlib.import_module(module)
    return registry[name]


def make(id, **kwargs):
    from gymnasium import Env
    known = _find(id)
    settings = {**copy.deepcopy(known.kwargs), **kwargs}
    creator = _load(known.entry_point)
    assert isinstance(creator.metadata, dict)
    if settings.get("render_mode") is not None:
        assert settings["render_mode"] in creator.metadata["render_modes"]
    env = creator(**settings)
    assert isinstance(env, Env), type(env).__mro__
    env.unwrapped.spec = EnvSpec(known.id, known.entry_point, kwargs=settings, order_enforce=False, disable_env_checker=True,
                                 vector_entry_point=known.vector_entry_point)
    return env


def make_vec(id, num_envs=1, **kwargs):
    from gymnasium.vector import AutoresetMode
    known = copy.deepcopy(_find(id))
    settings = {**known.kwargs, **kwargs}
    env = _load(known.vector_entry_point)(num_envs=num_envs, **settings)
    known.kwargs = {**settings, "num_envs": num_envs, "vectorization_mode": "vector_entry_point"}
    env.unwrapped.spec = known
    assert isinstance(env.metadata["autoreset_mode"], AutoresetMode)
    return env
