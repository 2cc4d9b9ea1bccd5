# SPDX-License-Identifier: Apache-2.0
"""Pools in the shapes that learning libraries expect: Stable-Baselines3's VecEnv, rl_games' IVecEnv, CleanRL's episodes.

None of the libraries is needed: where one can be imported, the class inherits from its own.
"""
from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any, Optional, Union

import numpy as np

from .environments import Scene, VectorEnvironment
from .errors import Error
from .objects import Taken, one_at_a_time, seed_of

try:
    from stable_baselines3.common.vec_env import VecEnv as _VecEnv
except ImportError:
    _VecEnv = object
try:
    from rl_games.common.ivecenv import IVecEnv as _IVecEnv
except ImportError:
    _IVecEnv = object


class _Episodes:
    """Return, length and time of the episodes of a pool, as Gymnasium's RecordEpisodeStatistics counts them."""

    def __init__(self, count: int) -> None:
        self._returns, self._lengths, self._begun = np.zeros(count), np.zeros(count, np.int64), np.full(count, time.perf_counter())

    def begin(self, which: Any = slice(None)) -> None:
        self._returns[which] = self._lengths[which] = 0
        self._begun[which] = time.perf_counter()

    def add(self, rewards: np.ndarray, ended: np.ndarray) -> dict[str, np.ndarray]:
        """{"r", "l", "t"}, (n,) each, 0 where no episode has ended."""
        self._returns += rewards
        self._lengths += 1
        found = {"r": np.where(ended, self._returns, 0.0), "l": np.where(ended, self._lengths, 0),
                 "t": np.where(ended, np.round(time.perf_counter() - self._begun, 6), 0.0)}
        self.begin(ended)
        return found


@one_at_a_time
class StableBaselinesVecEnv(Taken, _VecEnv):
    """A pool as Stable-Baselines3's ``VecEnv``: an episode that ends begins anew in the same step.

    Infos have "terminal_observation", "TimeLimit.truncated" and "episode" ({"r", "l", "t"}) of episodes that have ended, and
    "is_success". Settings as of ``trocar.make_vec``; ``clip`` is the usual way with actions out of range.
    """

    def __init__(self, task: Scene, num_envs: int = 1, **settings: Any) -> None:
        if "autoreset_mode" in settings:
            raise Error("E-CLI-001", "Stable-Baselines3 has one way to begin episodes anew; leave autoreset_mode out")
        self.pool = VectorEnvironment(task, num_envs, autoreset_mode="SameStep", **{"action_errors": "clip", **settings})
        self.render_mode = self.pool.render_mode
        spaces = self.pool.single_observation_space, self.pool.single_action_space
        if _VecEnv is object:
            self.num_envs = num_envs
            self.observation_space, self.action_space = spaces
            self.metadata = {"render_modes": ["human", "rgb_array"] if self.render_mode else []}
            self.reset_infos: list[dict] = [{} for _ in range(num_envs)]
            self._seeds: list[Optional[int]] = [None] * num_envs
            self._options: list[dict] = [{} for _ in range(num_envs)]
        else:
            super().__init__(num_envs, *spaces)
        self._episodes = _Episodes(num_envs)

    def reset(self):
        """Observations alone; ``reset_infos`` has what the resets say. Uses what ``seed`` and ``set_options`` were given, once."""
        options = self._options
        if all(each == options[0] for each in options):
            observations, infos = self.pool.reset(seed=list(self._seeds), options=options[0])
        else:
            for i in range(self.num_envs):
                mask = np.arange(self.num_envs) == i
                observations, infos = self.pool.reset(seed=list(self._seeds), options={**options[i], "reset_mask": mask})
        self.reset_infos = [{name: row[i] for name, row in infos.items() if not name.startswith("_")} for i in range(self.num_envs)]
        self._seeds, self._options = [None] * self.num_envs, [{} for _ in range(self.num_envs)]
        self._episodes.begin()
        return observations

    def step_async(self, actions: np.ndarray) -> None:
        self.pool.send(actions)

    def step_wait(self):
        observations, rewards, terminated, truncated, infos = self.pool.recv()
        ended = terminated | truncated
        episodes = self._episodes.add(rewards, ended)
        rows: list[dict[str, Any]] = []
        for i in range(self.num_envs):
            row: dict[str, Any] = {"is_success": bool(infos["is_success"][i]), "TimeLimit.truncated": bool(truncated[i] and not terminated[i])}
            if ended[i]:
                row["terminal_observation"] = infos["final_obs"][i]
                row["episode"] = {name: value[i].item() for name, value in episodes.items()}
            rows.append(row)
        return observations, rewards.astype(np.float32), ended, rows

    def step(self, actions: np.ndarray):
        self.step_async(actions)
        return self.step_wait()

    def close(self) -> None:
        self.pool.close()

    def seed(self, seed: Optional[int] = None):
        """For the next ``reset``: environment i gets ``seed`` + i."""
        first = int(np.random.randint(0, 2 ** 32, dtype=np.uint32)) if seed is None else seed_of(seed)
        self._seeds = [first + i for i in range(self.num_envs)]
        return self._seeds

    def set_options(self, options: Union[dict, list[dict], None] = None) -> None:
        """For the next ``reset``: ranges, for all environments or for each."""
        self._options = [dict(options or {}) for _ in range(self.num_envs)] if not isinstance(options, list) else [dict(each) for each in options]

    def _of(self, indices: Union[None, int, Iterable[int]]) -> list[int]:
        return list(range(self.num_envs)) if indices is None else [indices] if isinstance(indices, int) else list(indices)

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The environments of a pool share theirs."""
        source = self if attr_name == "render_mode" else self.pool
        return [getattr(source, attr_name) for _ in self._of(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        if len(self._of(indices)) != self.num_envs:
            raise Error("E-CLI-001", f"{attr_name} is one for all environments of a pool; set it for all")
        setattr(self.pool, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        raise Error("E-CLI-001", f'the environments of a pool are no objects of Python, so that "{method_name}" cannot be called of each; '
                    "call it of the pool: .pool")

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        # an episode's return is counted here, so that no Monitor is wanted
        return [wrapper_class.__name__ == "Monitor" for _ in self._of(indices)]

    def get_images(self):
        images = self.pool.render()
        return [None] * self.num_envs if images is None else list(images)


@one_at_a_time
class RlGamesVecEnv(Taken, _IVecEnv):
    """A pool after rl_games' ``IVecEnv``: dones in one, ``infos["time_outs"]`` beside. Registered by :func:`register_rl_games`."""

    def __init__(self, config_name: str, num_actors: int, *, task: Scene, **settings: Any) -> None:
        seed = settings.pop("seed", None)
        self.pool = VectorEnvironment(task, num_actors, autoreset_mode="SameStep",
                                      **{"action_errors": "clip", **settings, **({} if seed is None else {"seed": seed})})
        self.config_name, self.num_actors, self._seed = config_name, num_actors, seed
        self.observation_space, self.action_space = self.pool.single_observation_space, self.pool.single_action_space

    def step(self, actions: Any):
        if hasattr(actions, "detach"):
            actions = actions.detach().cpu().numpy()
        observations, rewards, terminated, truncated, infos = self.pool.step(actions)
        return observations, rewards.astype(np.float32), terminated | truncated, {
            "time_outs": truncated & ~terminated, "is_success": infos["is_success"]}

    def reset(self):
        observations, _ = self.pool.reset(seed=self._seed)
        self._seed = None
        return observations

    def seed(self, seed: int) -> None:
        """For the next ``reset``."""
        self._seed = seed_of(seed)

    def has_action_masks(self) -> bool:
        return False

    def get_number_of_agents(self) -> int:
        return 1

    def get_env_info(self) -> dict[str, Any]:
        return {"action_space": self.action_space, "observation_space": self.observation_space, "state_space": None,
                "use_global_observations": False, "agents": 1, "value_size": 1}

    def set_train_info(self, env_frames: int, *args: Any, **settings: Any) -> None:
        """How far training is: nothing here depends on it."""

    def get_env_state(self) -> None:
        return None

    def set_env_state(self, env_state: Any) -> None:
        """There is none."""

    def close(self) -> None:
        self.pool.close()


def register_rl_games(name: str = "TROCAR") -> None:
    """Makes rl_games know ``vecenv_type: TROCAR``, whose ``env_config`` has "task" and settings as of ``trocar.make_vec``."""
    from rl_games.common import env_configurations, vecenv
    vecenv.register(name, lambda config_name, num_actors, **settings: RlGamesVecEnv(config_name, num_actors, **settings))
    env_configurations.register("trocar", {"vecenv_type": name, "env_creator": lambda **settings: None})


@one_at_a_time
class CleanRlVectorEnvironment(VectorEnvironment):
    """A pool whose infos say what CleanRL's scripts print: ``infos["final_info"]["episode"]`` has "r", "l" and "t".

    Episodes begin anew in the same step, as those scripts want it. ``form="0.29"`` has infos as Gymnasium 0.29 had them:
    "final_info" is an array of dictionaries or None, and "final_observation" stands beside it.
    """

    def __init__(self, task: Scene, num_envs: int, *, form: str = "1.0", **settings: Any) -> None:
        if form not in ("1.0", "0.29"):
            raise Error("E-SCN-003", f'there is no form "{form}" of infos; choose 1.0 or 0.29')
        super().__init__(task, num_envs, autoreset_mode="SameStep", **{"action_errors": "clip", **settings})
        self.form, self._episodes = form, _Episodes(num_envs)

    def reset(self, *, seed: Any = None, options: Optional[dict] = None):
        answer = super().reset(seed=seed, options=options)
        mask = (options or {}).get("reset_mask")
        self._episodes.begin(slice(None) if mask is None else np.asarray(mask))
        return answer

    def step(self, actions: Any):
        observations, rewards, terminated, truncated, infos = super().step(actions)
        ended = terminated | truncated
        episode = self._episodes.add(rewards, ended)
        if not ended.any():
            return observations, rewards, terminated, truncated, infos
        if self.form == "1.0":
            infos["final_info"].update({"episode": {**episode, **{f"_{name}": ended.copy() for name in episode}}, "_episode": ended.copy()})
        else:
            rows = np.full(self.num_envs, None, object)
            for i in np.flatnonzero(ended):
                rows[i] = {"is_success": bool(infos["is_success"][i]), "episode": {name: np.array([value[i]]) for name, value in episode.items()}}
            infos.update({"final_info": rows, "_final_info": ended.copy(), "final_observation": infos["final_obs"],
                          "_final_observation": ended.copy()})
        return observations, rewards, terminated, truncated, infos


def make_sb3(task: Scene, num_envs: int = 1, **settings: Any) -> StableBaselinesVecEnv:
    """A pool for Stable-Baselines3: ``PPO("MlpPolicy", trocar.make_sb3("peg_transfer", 8, observation="scaled"))``."""
    return StableBaselinesVecEnv(task, num_envs, **settings)


def make_cleanrl(task: Scene, num_envs: int = 1, **settings: Any) -> CleanRlVectorEnvironment:
    """A pool for CleanRL's scripts, in the place of their ``gym.vector.SyncVectorEnv([...])``."""
    return CleanRlVectorEnvironment(task, num_envs, **settings)


def make_rl_games(task: Scene, num_actors: int = 1, **settings: Any) -> RlGamesVecEnv:
    """A pool for rl_games."""
    return RlGamesVecEnv("trocar", num_actors, task=task, **settings)
