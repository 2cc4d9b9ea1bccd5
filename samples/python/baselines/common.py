# SPDX-License-Identifier: Apache-2.0
"""What the baselines share: how an environment is set, networks, and how a policy is judged."""
import os
import time

# small networks: more threads of torch's would wait for each other. Before torch is there
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import torch

import trocar

UNSEEN = range(10_001, 10_101)  # training begins at seed 1 and never gets there
ENVIRONMENTS = 8
# the whole state, each number over its range, and all of an action: nothing is picked for a task
SETTINGS = {"observation": "scaled", "actions": "tip", "action_errors": "clip", "weights": {"approach": 50.0}}
# an episode of training and of judging is cut off here [s]: about twice what the expert takes
MOST_SECONDS = {"camera_navigation_0": 30, "camera_navigation_30": 30, "clip_and_cut": 30, "hook_dissection": 20, "instrument_navigation": 25, "lift_and_grasp": 15,
                "object_transport": 75, "pattern_cut": 40, "peg_transfer": 220, "wire_run": 25, "reach": 5, "cholecystectomy": 600}
REACH = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "reach.json")


def tasks():
    """Every task, and reach, which is none of the delivered ones. The operation takes the expert six minutes: it is no baseline."""
    return ["reach", *trocar.tasks()]


def settings_of(task):
    return {"task": REACH if task == "reach" else task, "most_seconds": float(MOST_SECONDS.get(task, 60)), **SETTINGS}


def make(task, **settings):
    return trocar.make(**{**settings_of(task), **settings})


def make_pool(task, seed, **settings):
    """Episodes of training are those of the seeds 1,000,000 times ``seed`` and on, and what follows by itself."""
    pool = trocar.make_vec(**{**settings_of(task), **settings}, num_envs=ENVIRONMENTS, autoreset_mode="SameStep")
    states, _ = pool.reset(seed=1_000_000 * seed)
    return pool, states


def network(sizes, activation):
    layers = []
    for width, following in zip(sizes, sizes[1:]):
        layers += [torch.nn.Linear(width, following), activation()]
    return torch.nn.Sequential(*layers[:-1])


class Curve:
    """Share of the last 100 episodes that succeeded, by the actions that were taken; and when the processor time is over.

    Of all threads together, so that a busy machine trains as long as an idle one.
    """

    def __init__(self, seconds):
        self._end, self._recent = time.process_time() + seconds, []
        self.actions, self.success, self.goals = [0], [0.0], [0.0]
        self._goals = np.zeros(ENVIRONMENTS)
        self.taken = 0

    @property
    def is_over(self):
        return time.process_time() >= self._end

    def add(self, infos, ended):
        self.taken += len(ended)
        self._goals += infos["features"][:, trocar.FEATURES.index("goal")]
        for i in np.flatnonzero(ended):
            self._recent = (self._recent + [(float(infos["is_success"][i]), self._goals[i])])[-100:]
            self._goals[i] = 0

    def mark(self):
        success, goals = np.mean(self._recent, axis=0) if self._recent else (0.0, 0.0)
        self.actions.append(self.taken)
        self.success.append(float(success))
        self.goals.append(float(goals))


def play(task, seed, act):
    """(success, share of goals) of one episode; ``act`` is a function of the observation."""
    with make(task) as env:
        observation, _ = env.reset(seed=seed)
        goals, is_over = 0.0, False
        while not is_over:
            observation, _, terminated, truncated, info = env.step(act(observation))
            goals += info["features"]["goal"]
            is_over = terminated or truncated
        return info["is_success"], goals


def play_expert(task, seed, keep=None):
    """As ``play`` of the scripted expert; ``keep(observation, action)`` gets what it saw and did."""
    with make(task) as env:
        observation, _ = env.reset(seed=seed)
        surgeon, goals, is_over = env.surgeon("expert", seed=seed), 0.0, False
        while not is_over:
            before = observation
            observation, _, terminated, truncated, info = env.step_by(surgeon)
            if keep is not None:
                keep(before, info["action"])
            goals += info["features"]["goal"]
            is_over = terminated or truncated
        return info["is_success"], goals


def play_random(task, seed):
    with make(task) as env:
        env.action_space.seed(seed)
        return play(task, seed, lambda observation: env.action_space.sample())


def judge(attempt, seeds=UNSEEN):
    """{"success", "goals", "episodes"}: shares over seeds."""
    played = [attempt(seed) for seed in seeds]
    success, goals = np.mean(np.array(played, float), axis=0)
    return {"success": float(success), "goals": float(goals), "episodes": len(played)}
