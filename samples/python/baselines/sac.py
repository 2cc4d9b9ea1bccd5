# SPDX-License-Identifier: Apache-2.0
"""Soft actor-critic with a temperature that is learnt. Source: Haarnoja et al., arXiv 1812.05905."""
import numpy as np
import torch

import common

MEMORY, BATCH, RATE, DISCOUNT, FOLLOW, WIDTH = 200_000, 256, 3e-4, 0.99, 0.005, 128
FIRST = 2_000   # actions by chance, before anything is learnt
UPDATES = 2     # for each step of all environments


class Memory:
    def __init__(self, sees, moves):
        self._rows = {name: np.zeros((MEMORY, width), np.float32) for name, width in (("seen", sees), ("after", sees), ("moves", moves), ("rest", 2))}
        self._next = self._count = 0

    def add(self, seen, moves, rewards, after, terminated):
        for i in range(len(seen)):
            for name, row in (("seen", seen[i]), ("after", after[i]), ("moves", moves[i]), ("rest", (rewards[i], terminated[i]))):
                self._rows[name][self._next] = row
            self._next = (self._next + 1) % MEMORY
            self._count = min(self._count + 1, MEMORY)

    def draw(self, random):
        chosen = random.integers(self._count, size=BATCH)
        return {name: torch.as_tensor(rows[chosen]) for name, rows in self._rows.items()}


class Actor:
    def __init__(self, sees, moves):
        self.body = common.network([sees, WIDTH, WIDTH, 2 * moves], torch.nn.ReLU)

    def draw(self, seen):
        """Actions, and the logarithm of their likelihood."""
        mean, log_spread = self.body(seen).chunk(2, -1)
        distribution = torch.distributions.Normal(mean, log_spread.clamp(-5, 2).exp(), validate_args=False)
        raw = distribution.rsample()
        moves = torch.tanh(raw)
        # of the squashed one; log(1 - tanh^2) in a form that does not lose its digits
        likelihood = distribution.log_prob(raw) - 2 * (np.log(2) - raw - torch.nn.functional.softplus(-2 * raw))
        return moves, likelihood.sum(-1, keepdim=True)

    def act(self, observation):
        with torch.no_grad():
            return torch.tanh(self.body(torch.as_tensor(observation)).chunk(2, -1)[0]).numpy()


def train(task, seconds, seed, most_actions=float("inf")):
    """(function from an observation to an action, learning curve)"""
    torch.manual_seed(seed)
    random, curve = np.random.default_rng(seed), common.Curve(seconds)
    pool, states = common.make_pool(task, seed)
    with pool:
        sees, moves = pool.single_observation_space.shape[0], pool.single_action_space.shape[0]
        actor, memory = Actor(sees, moves), Memory(sees, moves)
        critics, targets = ([common.network([sees + moves, WIDTH, WIDTH, 1], torch.nn.ReLU) for _ in range(2)] for _ in range(2))
        for critic, target in zip(critics, targets):
            target.load_state_dict(critic.state_dict())
        log_temperature = torch.zeros((), requires_grad=True)
        of_actor = torch.optim.Adam(actor.body.parameters(), lr=RATE)
        of_critics = torch.optim.Adam([parameter for critic in critics for parameter in critic.parameters()], lr=RATE)
        of_temperature = torch.optim.Adam([log_temperature], lr=RATE)
        while not curve.is_over and curve.taken < most_actions:
            if curve.taken < FIRST:
                actions = random.uniform(-1, 1, (common.ENVIRONMENTS, moves)).astype(np.float32)
            else:
                with torch.no_grad():
                    actions = actor.draw(torch.as_tensor(states))[0].numpy()
            after, rewards, terminated, truncated, infos = pool.step(actions)
            ended = terminated | truncated
            last = after.copy()
            for i in np.flatnonzero(ended):
                last[i] = infos["final_obs"][i]
            memory.add(states, actions, rewards, last, terminated)
            curve.add(infos, ended)
            states = after
            if curve.taken >= FIRST:
                for _ in range(UPDATES):
                    batch = memory.draw(random)
                    temperature = log_temperature.exp().detach()
                    with torch.no_grad():
                        following, likelihood = actor.draw(batch["after"])
                        value = torch.min(*(target(torch.cat([batch["after"], following], -1)) for target in targets)) - temperature * likelihood
                        wanted = batch["rest"][:, :1] + DISCOUNT * (1 - batch["rest"][:, 1:]) * value
                    loss = sum((critic(torch.cat([batch["seen"], batch["moves"]], -1)) - wanted).square().mean() for critic in critics)
                    of_critics.zero_grad()
                    loss.backward()
                    of_critics.step()
                    drawn, likelihood = actor.draw(batch["seen"])
                    worth = torch.min(*(critic(torch.cat([batch["seen"], drawn], -1)) for critic in critics))
                    of_actor.zero_grad()
                    (temperature * likelihood - worth).mean().backward()
                    of_actor.step()
                    of_temperature.zero_grad()
                    (-log_temperature * (likelihood.detach() - moves)).mean().backward()
                    of_temperature.step()
                    with torch.no_grad():
                        for critic, target in zip(critics, targets):
                            for own, other in zip(target.parameters(), critic.parameters()):
                                own.lerp_(other, FOLLOW)
            if curve.taken % 2048 == 0:
                curve.mark()
    return actor.act, curve
