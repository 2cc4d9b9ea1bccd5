# SPDX-License-Identifier: Apache-2.0
"""Left hand, right hand, camera and assistant as agents of one environment, after PettingZoo's parallel interface."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np

from .environments import Environment, Scene
from .errors import Error
from .objects import Taken, one_at_a_time
from .spaces import action_space

try:
    from pettingzoo import ParallelEnv as _ParallelEnv
except ImportError:
    _ParallelEnv = object


@one_at_a_time
class ParallelEnvironment(Taken, _ParallelEnv):
    """Every agent sees the whole state and gets the same reward; each moves only its part. Settings as of ``trocar.make``."""

    metadata = {"render_modes": ["rgb_array"], "name": "trocar"}

    def __init__(self, task: Scene, **settings: Any) -> None:
        self.environment = Environment(task, **settings)
        self.render_mode = self.environment.render_mode
        self._fields: dict[str, list] = {}
        for field in self.environment.action_fields:
            self._fields.setdefault(field["name"].split(".", 1)[0], []).append(field)
        self.possible_agents = list(self._fields)
        self.agents: list[str] = []
        self.action_spaces = {agent: action_space(fields) for agent, fields in self._fields.items()}
        self.observation_spaces = {agent: self.environment.observation_space for agent in self._fields}

    @property
    def num_agents(self) -> int:
        return len(self.agents)

    @property
    def max_num_agents(self) -> int:
        return len(self.possible_agents)

    @property
    def unwrapped(self):
        return self

    def action_space(self, agent: str):
        return self.action_spaces[agent]

    def observation_space(self, agent: str):
        return self.observation_spaces[agent]

    def state(self) -> np.ndarray:
        """(n,) float32, what all agents see together."""
        out = np.empty(self.environment.model.state_size, np.float32)
        self.environment._open().observe(out)
        return out

    def reset(self, seed: Optional[int] = None, options: Optional[dict] = None):
        observation, info = self.environment.reset(seed=seed, options=options)
        self.agents = list(self.possible_agents)
        return {agent: observation for agent in self.agents}, {agent: dict(info) for agent in self.agents}

    def step(self, actions: dict[str, Any]):
        if not self.agents:
            raise Error("E-ENV-002", "no agent is there: no episode has begun, or it is over; call reset before the next step")
        if set(actions) != set(self.agents):
            raise Error("E-ENV-001", f"actions are of {sorted(actions)}; give one for each of {sorted(self.agents)}")
        whole = np.zeros(self.environment.model.action_size)
        for agent, fields in self._fields.items():
            part = np.asarray(actions[agent], np.float64)
            if part.shape != (len(fields),):
                raise Error("E-ENV-001", f'the action of "{agent}" has the shape {part.shape}; it wants ({len(fields)},)')
            whole[[field["first"] for field in fields]] = part
        observation, reward, terminated, truncated, info = self.environment.step(whole)
        agents = self.agents
        if terminated or truncated:
            self.agents = []
        return (*({agent: value for agent in agents} for value in (observation, reward, terminated, truncated)),
                {agent: dict(info) for agent in agents})

    def render(self):
        return self.environment.render()

    def close(self) -> None:
        self.environment.close()


def make_parallel(task: Scene, **settings: Any) -> ParallelEnvironment:
    """The parallel view of an environment; settings as of :class:`trocar.Environment`."""
    return ParallelEnvironment(task, **settings)
