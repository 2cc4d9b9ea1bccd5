# SPDX-License-Identifier: Apache-2.0
"""Tasks and the operation as environments after Gymnasium's interface, single and as a pool.

Gymnasium is not needed. Where it can be imported, the classes here are its ``Env`` and ``VectorEnv``, and the spaces are its own.
"""
from __future__ import annotations

import os
from typing import Any, Optional, Sequence, Union

import numpy as np

from . import _trocar
from .errors import Error, closed
from .objects import one_at_a_time
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

OBSERVATIONS = ("state", "picture", "depth", "masks", "normals")
MIXTURE = ("state", "picture")
FARTHEST = 2.0  # m; the renderer draws nothing beyond 1 m

Scene = Union[str, "os.PathLike[str]", dict]
"""A key or a file, or a dictionary as such a file holds; relative paths of a dictionary start from ``folder``."""
Patient = Union[str, "os.PathLike[str]", dict]
"""A folder, or {"seed": 5, "set": {"acute_cholecystitis": 0.5}}: what ``trocar anatomy generate`` makes; "" for the scene's own."""


def _name_of(task: Scene) -> str:
    return str(task.get("name", "a dictionary")) if isinstance(task, dict) else str(task)


def environments() -> list[str]:
    """What ``make`` knows: the delivered tasks and the operation."""
    return sorted(_trocar.tasks()) + ["cholecystectomy"]


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
                  "picture": Box(0, 255, (height, width, 3), np.uint8),
                  "depth": Box(0, FARTHEST, (height, width), np.float32),
                  "masks": Box(0, max(_trocar.CLASSES.values()), (height, width), np.uint8),
                  "normals": Box(-1, 1, (height, width, 3), np.float32)}
        self.space = spaces[self.parts[0]] if self.is_one else Dict({part: spaces[part] for part in self.parts})
        self.drawn = [part for part in self.parts if part != "state"]

    def pack(self, seen: Any) -> Any:
        """``seen(part)`` gives a part."""
        return seen(self.parts[0]) if self.is_one else {part: seen(part) for part in self.parts}


@one_at_a_time
class Environment(_Env):
    """One environment. ``reset`` and ``step`` follow Gymnasium; see docs/python.md for actions, states and rewards.

    ``observation`` is "state" ((n,) float32 in SI units; ``state_fields`` names them), "picture" ((height, width, 3) uint8),
    "depth" ((height, width) float32 in metres, 0 where nothing is), "masks" ((height, width) uint8 after ``trocar.CLASSES``),
    "normals" ((height, width, 3) float32, unit, in the camera's frame), or several of these: then a dict. "mixture" is
    ("state", "picture").
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}
    spec = None

    def __init__(self, task: Scene, *, level: str = "normal", patient: Patient = "", seed: int = 1, layouts: int = 1,
                 actions: str = "joints", observation: Union[str, Sequence[str]] = "state", picture_size: tuple[int, int] = (84, 84),
                 actions_per_second: float = 10.0, most_seconds: float = 0.0, moves_camera: bool = False,
                 weights: Optional[dict[str, float]] = None, render_mode: Optional[str] = None, metrics: bool = False,
                 folder: str = "") -> None:
        if render_mode not in (None, "rgb_array"):
            raise Error("E-SCN-003", f'there is no render_mode "{render_mode}"; choose rgb_array or None')
        self.model = _trocar.EnvironmentModel(
            task, level=level, patient=patient, seed=seed, layouts=layouts, actions=actions,
            actions_per_second=actions_per_second, most_seconds=most_seconds, moves_camera=moves_camera,
            weights=weights or {}, folder=folder)
        self.metadata = {**self.metadata, "render_fps": actions_per_second}
        self.task, self.render_mode, self.observation = _name_of(task), render_mode, observation
        self.action_fields, self.state_fields = self.model.action_fields, self.model.state_fields
        self.action_space = action_space(self.action_fields)
        self._seen = _Observation(observation, self.model, picture_size)
        self.observation_space = self._seen.space
        self._size, self._camera = tuple(picture_size), None
        self._environment: Optional[_trocar.Environment] = _trocar.Environment(self.model, metrics)
        self._np_random = None

    @property
    def unwrapped(self):
        return self

    @property
    def np_random(self):
        if self._np_random is None:
            self._np_random = np.random.default_rng()
        return self._np_random

    def _open(self) -> _trocar.Environment:
        if self._environment is None:
            raise closed("environment")
        return self._environment

    def _draw(self) -> np.ndarray:
        if self._camera is None:
            self._camera = _trocar.Camera(*self._size)
        return self._camera.draw(self._open())

    def _geometry(self) -> dict[str, Any]:
        if self._camera is None:
            self._camera = _trocar.Camera(*self._size)
        seen = self._camera.geometry(self._open())
        # single precision rounds the unit vectors' components beyond 1 at times
        return {"depth": seen["depth"], "masks": seen["classes"], "normals": np.clip(seen["normals"], -1, 1)}

    def _state(self) -> np.ndarray:
        state = np.empty(self.model.state_size, np.float32)
        self._open().observe(state)
        return state

    def _observe(self):
        geometry = self._geometry() if {"depth", "masks", "normals"} & set(self._seen.parts) else {}
        return self._seen.pack(lambda part: self._state() if part == "state" else self._draw() if part == "picture" else geometry[part])

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict] = None):
        """Begins an episode. ``seed`` chooses among the layouts; without one the row of episodes goes on."""
        if seed is not None:
            if seed < 0:
                raise Error("E-CLI-001", f"a seed is not negative; this is {seed}")
            self._np_random = np.random.default_rng(seed)
        self._open().reset(seed)
        return self._observe(), {"layout": self._open().layout}

    def step(self, action: Any):
        """(observation, reward, terminated, truncated, info); info has the reward's features and whether it succeeded."""
        action = _as_action(action)
        if action.shape != self.action_space.shape:
            raise Error("E-ENV-001", f"the action has the shape {action.shape}; it wants {self.action_space.shape}")
        reward, terminated, truncated, success, features = self._open().step(action)
        return self._observe(), reward, terminated, truncated, {"is_success": success, "features": features}

    def surgeon(self, name: str = "expert", seed: int = 1) -> _trocar.Surgeon:
        """A scripted surgeon who goes on from here, for :meth:`step_by`."""
        return self._open().surgeon(name, seed)

    def step_by(self, surgeon: _trocar.Surgeon):
        """As ``step``, done by a scripted surgeon. ``info["action"]`` (n,) float64 is what the hands' way amounts to, cut to -1 to 1."""
        action = np.zeros(self.model.action_size)
        reward, terminated, truncated, success, features = self._open().step_by(surgeon, action)
        return self._observe(), reward, terminated, truncated, {"is_success": success, "features": features, "action": action}

    def render(self) -> Optional[np.ndarray]:
        return self._draw() if self.render_mode == "rgb_array" else None

    def metrics(self) -> list[dict[str, Any]]:
        """What the episode came to so far, as ``Simulation.metrics``; of an environment made with ``metrics=True``."""
        return self._open().metrics()

    def hash(self) -> str:
        """Fingerprint of the simulation's state, as the commands print it."""
        return self._open().hash()

    def close(self) -> None:
        self._environment = self._camera = None

    def __enter__(self):
        return self

    def __exit__(self, *_: Any) -> bool:
        self.close()
        return False

    def __str__(self) -> str:
        return f"<trocar.Environment {self.task}>"


@one_at_a_time
class VectorEnvironment(_VectorEnv):
    """A pool: many environments of one model, stepped by C++ threads, all states in one array.

    ``reset`` and ``step`` follow Gymnasium's ``VectorEnv``. ``send`` and ``recv`` do the same in two parts, for all
    environments or some. With ``copy=False`` the arrays are views of the pool's own memory, which the next call writes.
    ``observation`` is as of :class:`Environment`, each array with a first axis more; the pool's threads draw.
    """

    metadata: dict = {"render_modes": [], "autoreset_mode": "NextStep"}
    render_mode = None
    spec = None

    def __init__(self, task: Scene, num_envs: int, *, level: str = "normal", patient: Patient = "", seed: int = 1,
                 layouts: int = 1, actions: str = "joints", observation: Union[str, Sequence[str]] = "state",
                 picture_size: tuple[int, int] = (84, 84), actions_per_second: float = 10.0, most_seconds: float = 0.0,
                 moves_camera: bool = False, weights: Optional[dict[str, float]] = None, threads: int = 0,
                 autoreset_mode: Any = "NextStep", copy: bool = True, folder: str = "") -> None:
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        self.model = _trocar.EnvironmentModel(
            task, level=level, patient=patient, seed=seed, layouts=layouts, actions=actions,
            actions_per_second=actions_per_second, most_seconds=most_seconds, moves_camera=moves_camera,
            weights=weights or {}, folder=folder)
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
        self._rows = self._pool.rows()
        self._none = np.empty(0, np.int32)

    def _open(self) -> _trocar.Pool:
        if self._pool is None:
            raise closed("pool")
        return self._pool

    def _take(self, name: str, ids: Optional[np.ndarray]) -> np.ndarray:
        rows = self._rows[name]
        if ids is not None:
            return rows[ids]
        return rows.copy() if self.copy else rows

    def _observe(self, ids: Optional[np.ndarray], prefix: str = ""):
        return self._seen.pack(lambda part: self._take(prefix + part, ids))

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict] = None):
        """Environment i gets ``seed`` + i. ``options={"reset_mask": mask}`` resets only those of the mask."""
        mask = (options or {}).get("reset_mask")
        ids = self._none if mask is None else np.flatnonzero(np.asarray(mask)).astype(np.int32)
        count = self.num_envs if mask is None else len(ids)
        if seed is not None and (not np.isscalar(seed) or seed < 0):
            raise Error("E-CLI-001", "a pool's seed is one number, not negative; environment i gets it plus i")
        if count:
            self._open().reset(ids, seed)
            self._open().receive(count)
        return self._observe(None), {}

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
        infos: dict[str, Any] = {
            "env_id": ids,
            "is_success": self._take("success", rows).astype(bool),
            "was_reset": self._take("was_reset", rows).astype(bool),
            "features": self._take("features", rows),
        }
        if self.metadata["autoreset_mode"] == _AutoresetMode("SameStep"):
            ended = terminated | truncated
            if ended.any():
                final = np.full(len(ids), None, dtype=object)
                for i in np.flatnonzero(ended):
                    final[i] = self._seen.pack(lambda part: self._rows["final_" + part][ids[i]].copy())
                infos["final_obs"], infos["_final_obs"] = final, ended
        return self._observe(rows), self._take("reward", rows), terminated, truncated, infos

    def step(self, actions: Any):
        self.send(actions)
        return self.recv()

    def close(self, **_: Any) -> None:
        self._pool = None
        self._rows = {}
        self.closed = True

    def __enter__(self):
        return self

    def __exit__(self, *_: Any) -> bool:
        self.close()
        return False

    def __str__(self) -> str:
        return f"<trocar.VectorEnvironment {self.task} x {self.num_envs}>"


def make(task: Scene, **settings: Any) -> Environment:
    """An environment of a task's key, "cholecystectomy", a file, or a dictionary; settings as of :class:`Environment`."""
    return Environment(task, **settings)


def make_vec(task: Scene, num_envs: int = 1, **settings: Any) -> VectorEnvironment:
    """A pool of ``num_envs`` environments; settings as of :class:`VectorEnvironment`."""
    return VectorEnvironment(task, num_envs, **settings)
