# SPDX-License-Identifier: Apache-2.0
"""Checks an environment against the interface that Gymnasium has published: spaces, reset, step, seeding, determinism."""
from __future__ import annotations

from typing import Any

import numpy as np


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    return np.array_equal(a, b)


def _finite(value: Any) -> bool:
    if isinstance(value, dict):
        return all(_finite(part) for part in value.values())
    return bool(np.all(np.isfinite(value)))


def _check(holds: bool, what: str) -> None:
    if not holds:
        raise AssertionError(what)


def check_env(env: Any, steps: int = 10) -> None:
    """Raises AssertionError with what does not hold; leaves the environment reset."""
    for name in ("action_space", "observation_space", "metadata", "render_mode", "spec", "unwrapped", "np_random", "np_random_seed", "reset", "step",
                 "render", "close"):
        _check(hasattr(env, name), f"the environment has no {name}")
    for space in (env.action_space, env.observation_space):
        _check(space.sample() in space, f"{space} does not hold what it drew")
        space.seed(3)
        first = space.sample()
        space.seed(3)
        _check(_same(first, space.sample()), f"{space} draws other values from the same seed")

    def begin(seed):
        answer = env.reset(seed=seed)
        _check(isinstance(answer, tuple) and len(answer) == 2, "reset gives (observation, info)")
        _check(answer[0] in env.observation_space, "what reset gives lies outside of observation_space")
        _check(isinstance(answer[1], dict), "the info of reset is no dict")
        if seed is not None:
            random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))
            _check(env.np_random_seed == seed and env.np_random.bit_generator.state == random.bit_generator.state,
                   "np_random does not begin with the seed of reset")
        return answer[0]

    def play(seed):
        observations, rewards = [begin(seed)], []
        env.action_space.seed(seed)
        for _ in range(steps):
            answer = env.step(env.action_space.sample())
            _check(isinstance(answer, tuple) and len(answer) == 5,
                   "step gives (observation, reward, terminated, truncated, info)")
            observation, reward, terminated, truncated, info = answer
            _check(observation in env.observation_space, "what step gives lies outside of observation_space")
            _check(_finite(observation), "an observation is NaN or infinite")
            _check(isinstance(reward, (int, float, np.floating)) and _finite(reward), "a reward is no finite number")
            _check(isinstance(terminated, bool) and isinstance(truncated, bool), "terminated and truncated are bool")
            _check(isinstance(info, dict), "the info of step is no dict")
            observations.append(observation)
            rewards.append(reward)
            if terminated or truncated:
                break
        return observations, rewards

    first, again = play(11), play(11)
    _check(first[1] == again[1] and all(map(_same, first[0], again[0])),
           "the same seed and actions give other observations or rewards")
    held = first[0][0].copy() if hasattr(first[0][0], "copy") else first[0][0]
    begin(None)
    env.step(env.action_space.sample())
    _check(_same(held, first[0][0]), "an observation changes after it was given")


def check_vector_env(env: Any, steps: int = 10) -> None:
    """The same of a vectorised environment."""
    count = env.num_envs
    _check("autoreset_mode" in env.metadata, "metadata does not declare autoreset_mode")
    _check(env.action_space.shape[0] == count, "action_space is not one of all environments")
    whole, single = env.observation_space, env.single_observation_space
    parts = [(whole, single)] if single.shape is not None else [(whole[name], single[name]) for name in single.keys()]
    for one, part in parts:
        _check(one.shape == (count, *part.shape), "observation_space is not single_observation_space of all environments")

    def play(seed):
        observation, info = env.reset(seed=seed)
        _check(observation in env.observation_space and isinstance(info, dict), "reset gives (observations, info)")
        env.action_space.seed(seed)
        seen = [observation]
        for _ in range(steps):
            observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
            _check(observation in env.observation_space and _finite(observation), "an observation is not in its space")
            for array in (reward, terminated, truncated):
                _check(isinstance(array, np.ndarray) and array.shape == (count,), "one value for each environment")
            _check(terminated.dtype == bool and truncated.dtype == bool, "terminated and truncated are bool")
            seen += [observation, reward]
        return seen

    _check(all(map(_same, play(5), play(5))), "the same seed and actions give other observations or rewards")
