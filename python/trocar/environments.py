# SPDX-License-Identifier: Apache-2.0
"""Tasks and the operation as environments after Gymnasium's interface, single and as a pool.

Gymnasium is not needed. Where it can be imported, the classes here are its ``Env`` and ``VectorEnv``, and the spaces are its own.
"""
from __future__ import annotations

import copy
import os
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _trocar
from .errors import Error, closed
from .objects import Camera, EnvironmentModel, Taken, one_at_a_time, seed_of
from .registration import keys as environments, make_spec
from .reward import Terms
from .spaces import Box, Dict, action_space, batch_space

try:
    from gymnasium import Env as _Env
    from gymnasium.vector import VectorEnv as _VectorEnv
except ImportError:
    _Env = _VectorEnv = object
try:
    from gymnasium.vector import AutoresetMode as _AutoresetMode
except ImportError:
    _AutoresetMode = str

OBSERVATIONS = ("state", "scaled", "picture", "depth", "masks", "normals", "contacts")
CONTACT_FIELDS = ("is_there", "point", "normal", "force", "hand", "surface", "object")
"""Columns of a row of "contacts": point [m], normal and force [N] have three each; surface and object are numbers, -1 for none."""
MIXTURE = ("state", "picture")
FARTHEST = 2.0  # m; the renderer draws nothing beyond 1 m

Scene = Union[str, "os.PathLike[str]", dict]
"""A key or a file, or a dictionary as such a file holds; relative paths of a dictionary start from ``folder``."""
Patient = Union[str, "os.PathLike[str]", dict]
"""A folder, or {"seed": 5, "set": {"acute_cholecystitis": 0.5}}: what ``trocar anatomy generate`` makes; "" for the scene's own."""
Ranges = dict
"""{"mass": (0.8, 1.25), "latency_s": 0.1}: by the names of ``RANGES`` what an episode's seed draws from, or a number that it is."""


def _name_of(task: Scene) -> str:
    return str(task.get("name", "a dictionary")) if isinstance(task, dict) else str(task)


def _random_of(seed: Optional[int]) -> tuple[np.random.Generator, int]:
    """Gymnasium's row of random numbers of a seed, and the seed; without one, of a new one."""
    sequence = np.random.SeedSequence(seed)
    return np.random.Generator(np.random.PCG64(sequence)), sequence.entropy


def _read_options(options: Optional[dict]) -> tuple[dict, Any]:
    """What of the options varies, and the mask of a pool's reset."""
    if options is not None and not isinstance(options, dict):
        raise Error("E-CLI-001", f"the options are {options!r}; they are a dictionary, of ranges for example")
    options = dict(options or {})
    mask = options.pop("reset_mask", None)
    return options, mask


def _as_action(action: Any) -> np.ndarray:
    try:
        return np.ascontiguousarray(action, dtype=np.float64)
    except (TypeError, ValueError) as wrong:
        raise Error("E-ENV-001", f"an action is an array of numbers; this is none: {wrong}") from wrong


class _Observation:
    """What is observed: its parts, whether they come as one array or a dict, and their spaces."""

    def __init__(self, wanted: Union[str, Sequence[str]], model: _trocar.EnvironmentModel, size: tuple[int, int]) -> None:
        self.is_one = isinstance(wanted, str) and wanted != "mixture"
        self.parts = MIXTURE if wanted == "mixture" else (wanted,) if self.is_one else tuple(wanted)
        for part in self.parts or ("",):
            if part not in OBSERVATIONS:
                raise Error("E-SCN-003", f'there is no observation "{part}"; choose {", ".join(OBSERVATIONS)} or mixture')
        width, height = size
        spaces = {"state": Box(-np.inf, np.inf, (model.state_size,), np.float32),
                  "scaled": Box(-1, 1, (model.state_size,), np.float32),
                  "picture": Box(0, 255, (height, width, 3), np.uint8),
                  "depth": Box(0, FARTHEST, (height, width), np.float32),
                  "masks": Box(0, max(_trocar.CLASSES.values()), (height, width), np.uint8),
                  "normals": Box(-1, 1, (height, width, 3), np.float32),
                  "contacts": Box(-np.inf, np.inf, (_trocar.CONTACT_ROWS, 13), np.float32)}
        self.space = spaces[self.parts[0]] if self.is_one else Dict({part: spaces[part] for part in self.parts})
        self.drawn = [part for part in self.parts if part not in ("state", "scaled")]
        self._low, high = model.state_bounds
        self._half = np.maximum(high - self._low, 1e-9) / 2

    def scale(self, states: np.ndarray) -> np.ndarray:
        """Each number over its range, from -1 to 1; what lies beyond is cut."""
        return np.clip((states - self._low) / self._half - 1, -1, 1).astype(np.float32)

    def pack(self, seen: Any) -> Any:
        """``seen(part)`` gives a part."""
        return seen(self.parts[0]) if self.is_one else {part: seen(part) for part in self.parts}


@one_at_a_time
class Environment(Taken, _Env):
    """One environment. ``reset`` and ``step`` follow Gymnasium; see docs/python.md for actions, states and rewards.

    ``observation`` is "state" ((n,) float32 in SI units; ``state_fields`` names them), "picture" ((height, width, 3) uint8),
    "depth" ((height, width) float32 in metres, 0 where nothing is), "masks" ((height, width) uint8 after ``trocar.CLASSES``),
    "normals" ((height, width, 3) float32, unit, in the camera's frame), "scaled" (the state, each number over its range, from -1
    to 1), "contacts" ((32, 13) float32, a row for each point that a tool touches, see ``CONTACT_FIELDS``), or several of these:
    then a dict. "mixture" is ("state", "picture").
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}
    spec: Any = None

    def __init__(self, task: Scene, *, level: str = "normal", patient: Union[Patient, Sequence[Patient]] = "", seed: int = 1,
                 layouts: int = 0, models: int = 0, ranges: Optional[Ranges] = None, actions: str = "joints",
                 observation: Union[str, Sequence[str]] = "state", picture_size: tuple[int, int] = (84, 84),
                 actions_per_second: float = 10.0, most_seconds: float = 0.0, moves_camera: bool = False,
                 weights: Optional[dict[str, float]] = None, terms: Any = None, action_errors: str = "raise",
                 render_mode: Optional[str] = None, render_size: Optional[tuple[int, int]] = None, metrics: bool = False,
                 folder: Union[str, "os.PathLike[str]"] = "") -> None:
        _check_render_mode(render_mode)
        self.model = EnvironmentModel(
            task, level=level, patient=patient, seed=seed, layouts=layouts, models=models, ranges=ranges or {}, actions=actions,
            actions_per_second=actions_per_second, most_seconds=most_seconds, moves_camera=moves_camera,
            weights=weights or {}, action_errors=action_errors, folder=folder)
        self.metadata = {**self.metadata, "render_fps": actions_per_second}
        self.task, self.render_mode, self.observation = _name_of(task), render_mode, observation
        self.action_fields, self.state_fields = self.model.action_fields, self.model.state_fields
        self.action_space = action_space(self.action_fields)
        self._seen = _Observation(observation, self.model, picture_size)
        self.observation_space = self._seen.space
        self._terms = Terms(terms, self.state_fields)
        self._size, self._camera = tuple(picture_size), None
        self._render_size, self._render_camera = tuple(render_size or picture_size), None
        self.spec = make_spec(task, self._made_of[1])
        self._last: Optional[np.ndarray] = None  # state before the next action, where terms ask for it
        self._environment: Optional[_trocar.Environment] = _trocar.Environment(self.model, metrics)
        self._np_random: Optional[np.random.Generator] = None
        self._np_random_seed: Optional[int] = None

    @property
    def unwrapped(self):
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """Random numbers for whoever wants some, begun anew by ``reset(seed=...)``. The environment itself uses none of them."""
        if self._np_random is None:
            self._np_random, self._np_random_seed = _random_of(None)
        return self._np_random

    @np_random.setter
    def np_random(self, value: np.random.Generator) -> None:
        self._np_random, self._np_random_seed = value, -1

    @property
    def np_random_seed(self) -> int:
        """What ``np_random`` was begun with; -1 where it was set."""
        if self._np_random_seed is None:
            self._np_random, self._np_random_seed = _random_of(None)
        return self._np_random_seed

    def _open(self) -> _trocar.Environment:
        if self._environment is None:
            raise closed("environment")
        return self._environment

    def _draw(self) -> np.ndarray:
        if self._camera is None:
            self._camera = Camera(*self._size)
        return self._camera.draw(self._open())

    def _geometry(self) -> dict[str, Any]:
        if self._camera is None:
            self._camera = Camera(*self._size)
        seen = self._camera.geometry(self._open())
        # single precision rounds the unit vectors' components beyond 1 at times
        return {"depth": seen["depth"], "masks": seen["classes"], "normals": np.clip(seen["normals"], -1, 1)}

    def _state(self) -> np.ndarray:
        state = np.empty(self.model.state_size, np.float32)
        self._open().observe(state)
        return state

    def _observe(self):
        geometry = self._geometry() if {"depth", "masks", "normals"} & set(self._seen.parts) else {}
        ways = {"state": self._state, "scaled": lambda: self._seen.scale(self._state()), "picture": self._draw,
                "contacts": lambda: self._open().contacts()}
        return self._seen.pack(lambda part: ways[part]() if part in ways else geometry[part])

    def _info(self) -> dict[str, Any]:
        environment = self._open()
        info = {"layout": environment.layout, "drawn": environment.drawn()}
        return info if self.model.layouts else {**info, "seed": environment.episode_seed}

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict] = None):
        """Begins an episode. ``seed`` decides its layout and what else varies; without one the row of episodes goes on.

        ``options`` are ranges, as those that an environment is made with, for this episode and those after it; None takes
        one back. The info says what the episode has drawn.
        """
        seed, (ranges, mask) = seed_of(seed), _read_options(options)
        if mask is not None:
            raise Error("E-CLI-001", "a reset_mask is for a pool; this is one environment")
        if ranges:
            self._open().set_ranges(self.model, ranges)
        self._open().reset(seed)
        if seed is not None:
            self._np_random, self._np_random_seed = _random_of(seed)
        self._last = self._state() if self._terms else None
        return self._observe(), self._info()

    def _ended(self, reward: float, features: dict[str, float], info: dict[str, Any]) -> tuple[float, dict[str, Any]]:
        """The reward with the user's own terms."""
        if not self._terms:
            return reward, info
        now = self._state()
        before, self._last = self._last, now
        terms = self._terms.calc(now[None], before[None], {name: np.array([value]) for name, value in features.items()})
        info["terms"] = {name: float(value[0]) for name, value in terms.items()}
        return reward + sum(info["terms"].values()), info

    def step(self, action: Any):
        """(observation, reward, terminated, truncated, info); info has the reward's features and whether it succeeded."""
        action = _as_action(action)
        if action.shape != self.action_space.shape:
            raise Error("E-ENV-001", f"the action has the shape {action.shape}; it wants {self.action_space.shape}")
        reward, terminated, truncated, success, features = self._open().step(action)
        reward, info = self._ended(reward, features, {"is_success": success, "features": features})
        return self._observe(), reward, terminated, truncated, info

    def surgeon(self, name: str = "expert", seed: int = 1) -> _trocar.Surgeon:
        """A scripted surgeon who goes on from here, for :meth:`step_by`."""
        return self._open().surgeon(name, seed)

    def step_by(self, surgeon: _trocar.Surgeon):
        """As ``step``, done by a scripted surgeon. ``info["action"]`` (n,) float64 is what the hands' way amounts to, cut to -1 to 1."""
        action = np.zeros(self.model.action_size)
        reward, terminated, truncated, success, features = self._open().step_by(surgeon, action)
        reward, info = self._ended(reward, features, {"is_success": success, "features": features, "action": action})
        return self._observe(), reward, terminated, truncated, info

    def render(self) -> Optional[np.ndarray]:
        """(height, width, 3) uint8 of ``render_size``; None without a render_mode."""
        if self.render_mode != "rgb_array":
            return None
        if self._render_camera is None:
            self._render_camera = Camera(*self._render_size)
        return self._render_camera.draw(self._open())

    def save(self) -> bytes:
        """All that decides how the episode goes on, and those after it. ``np_random`` and metrics are no part of it."""
        return self._open().save()

    def restore(self, state: bytes):
        """Takes up what an environment of the same settings has saved. (observation, info) as of ``reset``."""
        self._open().restore(state)
        self._last = self._state() if self._terms else None
        return self._observe(), self._info()

    def clone(self) -> "Environment":
        """One more that goes on from here: the same actions give the same observations and rewards. It shares the models."""
        cls, (arguments, settings) = type(self), self._made_of
        other = cls.__new__(cls, *arguments, **settings)
        for name, value in vars(self).items():
            if name not in ("_turn", "_made_of"):
                setattr(other, name, value)
        other._environment = self._open().clone()
        other._camera = other._render_camera = None
        other._np_random, other._np_random_seed = copy.deepcopy(self._np_random), self._np_random_seed
        other.action_space, other.observation_space = copy.deepcopy(self.action_space), copy.deepcopy(self.observation_space)
        return other

    def snapshot(self) -> dict[str, Any]:
        """What the last tick published, as ``Simulation.snapshot``; its contacts are a list."""
        return self._open().snapshot()

    def metrics(self) -> list[dict[str, Any]]:
        """What the episode came to so far, as ``Simulation.metrics``; of an environment made with ``metrics=True``."""
        return self._open().metrics()

    def hash(self) -> str:
        """Fingerprint of the simulation's state, as the commands print it."""
        return self._open().hash()

    def close(self) -> None:
        self._environment = self._camera = self._render_camera = None

    def __enter__(self):
        return self

    def __exit__(self, *_: Any) -> bool:
        self.close()
        return False

    def __str__(self) -> str:
        return f"<trocar.Environment {_printable(self.task)}>"


@one_at_a_time
class VectorEnvironment(Taken, _VectorEnv):
    """A pool: many environments of one model, stepped by C++ threads, all states in one array.

    ``reset`` and ``step`` follow Gymnasium's ``VectorEnv``. ``send`` and ``recv`` do the same in two parts, for all
    environments or some. With ``copy=False`` the arrays are views of the pool's own memory, which the next call writes.
    ``observation`` is as of :class:`Environment`, each array with a first axis more; the pool's threads draw.
    """

    metadata: dict = {"render_modes": ["rgb_array"], "autoreset_mode": "NextStep"}
    render_mode: Optional[str] = None
    spec: Any = None

    def __init__(self, task: Scene, num_envs: int, *, level: str = "normal", patient: Union[Patient, Sequence[Patient]] = "",
                 seed: int = 1, layouts: int = 0, models: int = 0, ranges: Optional[Ranges] = None, actions: str = "joints",
                 observation: Union[str, Sequence[str]] = "state", picture_size: tuple[int, int] = (84, 84),
                 actions_per_second: float = 10.0, most_seconds: float = 0.0, moves_camera: bool = False,
                 weights: Optional[dict[str, float]] = None, terms: Any = None, action_errors: str = "raise", threads: int = 0,
                 autoreset_mode: Any = "NextStep", copy: bool = True, render_mode: Optional[str] = None,
                 render_size: Optional[tuple[int, int]] = None, folder: Union[str, "os.PathLike[str]"] = "") -> None:
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        _check_render_mode(render_mode)
        self.model = EnvironmentModel(
            task, level=level, patient=patient, seed=seed, layouts=layouts, models=models, ranges=ranges or {}, actions=actions,
            actions_per_second=actions_per_second, most_seconds=most_seconds, moves_camera=moves_camera,
            weights=weights or {}, action_errors=action_errors, folder=folder)
        self.render_mode, self._render_size = render_mode, tuple(render_size or picture_size)
        self._render_cameras: list[Camera] = []
        self.spec = make_spec(task, {"num_envs": num_envs, "vectorization_mode": "vector_entry_point", **self._made_of[1]})
        self._seen = _Observation(observation, self.model, picture_size)
        self._pool: Optional[_trocar.Pool] = _trocar.Pool(
            self.model, count=num_envs, threads=threads, autoreset=mode, seed=seed, drawn=self._seen.drawn,
            width=picture_size[0], height=picture_size[1])
        self.metadata = {**self.metadata, "autoreset_mode": _AutoresetMode(mode)}
        self.task, self.num_envs, self.copy, self.threads = _name_of(task), num_envs, copy, self._pool.threads
        self.closed = False
        self.action_fields, self.state_fields = self.model.action_fields, self.model.state_fields
        self.single_action_space = action_space(self.action_fields)
        self.single_observation_space = self._seen.space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._terms = Terms(terms, self.state_fields)
        self._last: Optional[np.ndarray] = None  # states before the next actions, where terms ask for them
        self._rows = self._pool.rows()
        self._none = np.empty(0, np.int32)
        self._random: list[tuple[Optional[np.random.Generator], Optional[int]]] = [(None, None)] * num_envs

    @property
    def unwrapped(self):
        return self

    def _all_random(self) -> list[tuple[np.random.Generator, int]]:
        self._random = [known if known[0] is not None else _random_of(known[1]) for known in self._random]
        return self._random

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:
        """Of each environment, as of :class:`Environment`."""
        return tuple(random for random, _ in self._all_random())

    @property
    def np_random_seed(self) -> tuple[int, ...]:
        """What each environment's ``np_random`` was begun with."""
        return tuple(seed for _, seed in self._all_random())

    def _open(self) -> _trocar.Pool:
        if self._pool is None:
            raise closed("pool")
        return self._pool

    def _take(self, name: str, ids: Optional[np.ndarray]) -> np.ndarray:
        rows = self._rows[name]
        if ids is not None:
            return rows[ids]
        return rows.copy() if self.copy else rows

    def _observe(self, ids: Optional[np.ndarray]):
        return self._seen.pack(lambda part: self._seen.scale(self._take("state", ids)) if part == "scaled" else self._take(part, ids))

    def _final(self, i: int):
        return self._seen.pack(lambda part: self._seen.scale(self._rows["final_state"][i]) if part == "scaled"
                               else self._rows["final_" + part][i].copy())

    def _begun(self) -> dict[str, Any]:
        info = {"layout": self._rows["layout"].copy()}
        return info if self.model.layouts else {**info, "seed": self._rows["episode_seed"].copy()}

    def _seeds(self, seed: Any) -> list[Optional[int]]:
        """One for each environment."""
        if seed is None or np.ndim(seed) == 0 and not isinstance(seed, (str, bytes, dict, set)):
            first = seed_of(seed)
            return [None if first is None else (first + i) % 2 ** 64 for i in range(self.num_envs)]
        if isinstance(seed, (str, bytes, dict, set)) or len(seed) != self.num_envs:
            raise Error("E-CLI-001", f"the seeds are {seed!r}; a pool takes one number, which environment i gets plus i, or a list "
                        f"of {self.num_envs}, None for those that go on")
        return [seed_of(each, f"the seed of environment {i}") for i, each in enumerate(seed)]

    def reset(self, *, seed: Union[int, Sequence[Optional[int]], None] = None, options: Optional[dict] = None):
        """Environment i gets ``seed`` + i, or ``seed[i]`` of a list; where that is None its row of episodes goes on.

        ``options={"reset_mask": mask}`` resets only those of the mask. The other options are ranges, for what is reset and the
        episodes that follow there by themselves.
        """
        seeds, (ranges, mask) = self._seeds(seed), _read_options(options)
        ids = np.arange(self.num_envs, dtype=np.int32)
        if mask is not None:
            mask = np.asarray(mask)
            if mask.shape != (self.num_envs,) or mask.dtype != bool:
                raise Error("E-CLI-001", f"the reset_mask has the shape {mask.shape} and holds {mask.dtype}; give {self.num_envs} truth values")
            ids = ids[mask]
        pool = self._open()
        if len(ids):
            if ranges:
                pool.set_ranges(ids, ranges)
            pool.reset(ids, [seeds[i] for i in ids])
            pool.receive(len(ids))
        for i in ids:
            if seeds[i] is not None:
                self._random[i] = (None, seeds[i])
        begun = np.zeros(self.num_envs, bool)
        begun[ids] = True
        if self._terms:
            self._last = self._rows["state"].copy()
        return self._observe(None), _masked(self._begun(), begun)

    def send(self, actions: Any, env_ids: Optional[Sequence[int]] = None) -> None:
        """Hands actions (len(env_ids), action_size) to the threads and returns; all environments without ``env_ids``."""
        ids = self._none if env_ids is None else np.ascontiguousarray(env_ids, np.int32)
        actions = _as_action(actions)
        size = self.model.action_size
        expected = (self.num_envs if env_ids is None else len(ids), size)
        if actions.shape != expected:
            raise Error("E-ENV-001", f"actions have the shape {actions.shape}; this pool wants {expected}")
        if env_ids is not None and len(ids) == 0:
            return
        self._open().send(actions, ids)

    def recv(self, batch_size: Optional[int] = None):
        """Waits for ``batch_size`` environments that are at work, all of them without it.

        (observations, rewards, terminated, truncated, infos); infos["env_id"] says of which environments the rows are.
        """
        pool = self._open()
        ids = pool.receive(pool.at_work if batch_size is None else batch_size)
        rows = None if len(ids) == self.num_envs else ids
        terminated, truncated = (self._take(name, rows).astype(bool) for name in ("terminated", "truncated"))
        success, features = self._take("success", rows).astype(bool), self._take("features", rows)
        begun = self._take("was_reset", rows).astype(bool)
        infos = _masked({"env_id": ids, "is_success": success, "was_reset": begun, "features": features}, np.ones(len(ids), bool))
        if begun.any():
            infos.update(_masked({name: row if rows is None else row[rows] for name, row in self._begun().items()}, begun))
        rewards = self._take("reward", rows)
        if self._terms:
            rewards = self._add_terms(ids, rewards, features, terminated | truncated, begun, infos)
        if self.metadata["autoreset_mode"] == _AutoresetMode("SameStep"):
            ended = terminated | truncated
            if ended.any():
                final = np.full(len(ids), None, dtype=object)
                for i in np.flatnonzero(ended):
                    final[i] = self._final(ids[i])
                infos.update(_masked({"final_obs": final, "final_info": _masked(
                    {"is_success": success & ended, "features": np.where(ended[:, None], features, 0.0)}, ended)}, ended))
        return self._observe(rows), rewards, terminated, truncated, infos

    def _add_terms(self, ids: np.ndarray, rewards: np.ndarray, features: np.ndarray, ended: np.ndarray, begun: np.ndarray,
                   infos: dict[str, Any]) -> np.ndarray:
        """Rewards with the user's own terms, which an action has that was used."""
        now = self._rows["state"][ids]
        same_step = self.metadata["autoreset_mode"] == _AutoresetMode("SameStep")
        after = np.where(ended[:, None], self._rows["final_state"][ids], now) if same_step else now
        used = np.ones(len(ids), bool) if same_step else ~begun
        before = self._last[ids]
        terms = {}
        if used.any():
            parts = self._terms.calc(after[used], before[used], {name: features[used, i] for i, name in enumerate(_trocar.FEATURES)})
            for name, value in parts.items():
                terms[name] = np.zeros(len(ids))
                terms[name][used] = value
            infos.update(_masked({"terms": terms}, used))
        self._last[ids] = now
        return rewards + sum(terms.values(), np.zeros(len(ids)))

    def step(self, actions: Any):
        self.send(actions)
        return self.recv()

    def render(self) -> Optional[tuple[np.ndarray, ...]]:
        """A picture of each environment, (height, width, 3) uint8 of ``render_size``; None without a render_mode."""
        if self.render_mode != "rgb_array":
            return None
        pool = self._open()
        if not self._render_cameras:
            self._render_cameras = [Camera(*self._render_size) for _ in range(self.num_envs)]
        return tuple(camera.draw(pool, i) for i, camera in enumerate(self._render_cameras))

    def close(self, **_: Any) -> None:
        self._pool = None
        self._render_cameras = []
        self._rows = {}
        self.closed = True

    def __enter__(self):
        return self

    def __exit__(self, *_: Any) -> bool:
        self.close()
        return False

    def __str__(self) -> str:
        return f"<trocar.VectorEnvironment {_printable(self.task)} x {self.num_envs}>"


def _check_render_mode(mode: Optional[str]) -> None:
    if mode not in (None, "rgb_array"):
        raise Error("E-SCN-003", f'there is no render_mode "{mode}"; choose rgb_array or None')


def _printable(text: str) -> str:
    """A name of a file within a line: what steers a terminal becomes visible, as in repr()."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def _masked(values: dict[str, Any], has: np.ndarray) -> dict[str, Any]:
    """As Gymnasium has infos: beside each key one with an underscore, which says of which environments it is."""
    return {**values, **{f"_{name}": has.copy() for name in values}}


def make(task: Scene, **settings: Any) -> Environment:
    """An environment of a task's key, "cholecystectomy", a file, or a dictionary; settings as of :class:`Environment`."""
    return Environment(task, **settings)


def make_vec(task: Scene, num_envs: int = 1, **settings: Any) -> VectorEnvironment:
    """A pool of ``num_envs`` environments; settings as of :class:`VectorEnvironment`."""
    return VectorEnvironment(task, num_envs, **settings)
