# SPDX-License-Identifier: Apache-2.0
"""Proximal policy optimisation. Source: Schulman et al., arXiv 1707.06347; advantages: arXiv 1506.02438.

Sizes and rates are Stable-Baselines3's defaults, with 8 environments: 256 steps in each, 10 epochs of minibatches of 64.
"""
import numpy as np
import torch

import common

STEPS, EPOCHS, BATCH, RATE, DISCOUNT, TRACE, CLIP = 256, 10, 64, 3e-4, 0.99, 0.95, 0.2


class Policy:
    def __init__(self, sees, moves):
        self.mean = common.network([sees, 64, 64, moves], torch.nn.Tanh)
        self.value = common.network([sees, 64, 64, 1], torch.nn.Tanh)
        for part, last in ((self.mean, 0.01), (self.value, 1.0)):
            layers = [layer for layer in part if isinstance(layer, torch.nn.Linear)]
            for layer in layers:
                torch.nn.init.orthogonal_(layer.weight, last if layer is layers[-1] else 2 ** 0.5)
                torch.nn.init.zeros_(layer.bias)
        self.log_spread = torch.nn.Parameter(torch.zeros(moves))
        self.parameters = [*self.mean.parameters(), *self.value.parameters(), self.log_spread]

    def distribution(self, seen):
        return torch.distributions.Normal(self.mean(seen), self.log_spread.exp(), validate_args=False)

    def act(self, observation):
        with torch.no_grad():
            return self.mean(torch.as_tensor(observation)).numpy()


def gather(pool, policy, states, curve):
    rows = {name: [] for name in ("seen", "moves", "likelihood", "value", "reward", "ends")}
    for _ in range(STEPS):
        seen = torch.as_tensor(states)
        with torch.no_grad():
            distribution = policy.distribution(seen)
            moves = distribution.sample()
            value = policy.value(seen).squeeze(-1)
        states, rewards, terminated, truncated, infos = pool.step(moves.numpy())
        ended = terminated | truncated
        for i in np.flatnonzero(truncated & ~terminated):  # cut off, not ended: what would have followed counts
            with torch.no_grad():
                rewards[i] += DISCOUNT * policy.value(torch.as_tensor(infos["final_obs"][i])).item()
        curve.add(infos, ended)
        for name, row in (("seen", seen), ("moves", moves), ("likelihood", distribution.log_prob(moves).sum(-1)), ("value", value),
                          ("reward", torch.as_tensor(rewards, dtype=torch.float32)), ("ends", torch.as_tensor(ended))):
            rows[name].append(row)
    with torch.no_grad():
        following = policy.value(torch.as_tensor(states)).squeeze(-1)
    rows = {name: torch.stack(row) for name, row in rows.items()}
    gain, gained = torch.zeros_like(rows["reward"]), torch.zeros_like(following)
    for t in reversed(range(STEPS)):
        goes_on = (~rows["ends"][t]).float()
        error = rows["reward"][t] + DISCOUNT * following * goes_on - rows["value"][t]
        gain[t] = gained = error + DISCOUNT * TRACE * goes_on * gained
        following = rows["value"][t]
    rows["gain"], rows["target"] = gain, gain + rows["value"]
    return {name: row.flatten(0, 1) for name, row in rows.items()}, states


def improve(policy, optimiser, rows):
    for _ in range(EPOCHS):
        for part in torch.randperm(len(rows["gain"])).split(BATCH):
            gain = rows["gain"][part]
            gain = (gain - gain.mean()) / (gain.std() + 1e-8)
            distribution = policy.distribution(rows["seen"][part])
            ratio = (distribution.log_prob(rows["moves"][part]).sum(-1) - rows["likelihood"][part]).exp()
            loss = -torch.min(ratio * gain, ratio.clamp(1 - CLIP, 1 + CLIP) * gain).mean()
            loss = loss + 0.5 * (policy.value(rows["seen"][part]).squeeze(-1) - rows["target"][part]).square().mean()
            optimiser.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(policy.parameters, 0.5)
            optimiser.step()


def train(task, seconds, seed, most_actions=float("inf")):
    """(function from an observation to an action, learning curve)"""
    torch.manual_seed(seed)
    curve = common.Curve(seconds)
    pool, states = common.make_pool(task, seed)
    with pool:
        policy = Policy(pool.single_observation_space.shape[0], pool.single_action_space.shape[0])
        optimiser = torch.optim.Adam(policy.parameters, lr=RATE, eps=1e-5)
        while not curve.is_over and curve.taken < most_actions:
            rows, states = gather(pool, policy, states, curve)
            improve(policy, optimiser, rows)
            curve.mark()
    return policy.act, curve
