# SPDX-License-Identifier: Apache-2.0
"""A stand-in after Stable-Baselines3's published ``VecEnv``: what has to be there, and what its constructor asks for."""
from abc import ABC, abstractmethod


class VecEnv(ABC):
    def __init__(self, num_envs, observation_space, action_space):
        self.num_envs, self.observation_space, self.action_space = num_envs, observation_space, action_space
        self.reset_infos = [{} for _ in range(num_envs)]
        self._seeds = [None] * num_envs
        self._options = [{} for _ in range(num_envs)]
        modes = self.get_attr("render_mode")
        assert len(modes) == num_envs and all(mode == modes[0] for mode in modes)
        self.render_mode = modes[0]
        self.metadata = {"render_modes": ["human", "rgb_array"] if self.render_mode == "rgb_array" else []}

    @abstractmethod
    def reset(self): ...
    @abstractmethod
    def step_async(self, actions): ...
    @abstractmethod
    def step_wait(self): ...
    @abstractmethod
    def close(self): ...
    @abstractmethod
    def get_attr(self, attr_name, indices=None): ...
    @abstractmethod
    def set_attr(self, attr_name, value, indices=None): ...
    @abstractmethod
    def env_method(self, method_name, *method_args, indices=None, **method_kwargs): ...
    @abstractmethod
    def env_is_wrapped(self, wrapper_class, indices=None): ...

    def step(self, actions):
        self.step_async(actions)
        return self.step_wait()
