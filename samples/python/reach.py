# SPDX-License-Identifier: Apache-2.0
"""Learns from nothing to bring a tip to where it is wanted: reach.py [--minutes M] [--curve reach.svg]

Proximal policy optimisation (Schulman et al., arXiv 1707.06347) on a pool of environments. Needs python3-torch. The task is
reach.json beside this file: a cage somewhere before the right hand, another place with every seed. The policy sees six numbers that are
scaled by hand, where the tip is and where the cage, and moves three of ten actions, the tip's velocity. baselines/ learns with all of them.
"""
import argparse
import pathlib
import time

import learning  # first: it says how many threads torch gets

import numpy as np
import torch

import trocar

TASK = str(pathlib.Path(__file__).with_name("reach.json"))
UNSEEN = range(10_001, 10_101)
ENVIRONMENTS, ROLLOUT = 16, 64
SETTINGS = {"actions": "tip", "most_seconds": 5.0, "weights": {"approach": 50.0}}
DISCOUNT, TRACE, CLIP = 0.95, 0.95, 0.2
CENTRE, SCALE = np.array([0, 0.03, -0.115] * 2), 0.03  # of what is seen [m]


class Policy:
    """Gaussian: its mean and the value of a state are small networks, its spread is learnt beside them."""

    def __init__(self, model_or_environment, seed=1):
        torch.manual_seed(seed)
        self.sees = learning.columns(model_or_environment.state_fields, ["right.tip", "region.target.centre"])
        self.moves = learning.columns(model_or_environment.action_fields, ["right.x", "right.y", "right.z"])
        self.size = sum(field["count"] for field in model_or_environment.action_fields)
        self.mean, self.value = learning.network([6, 64, 64, 3]), learning.network([6, 64, 64, 1])
        self.log_spread = torch.nn.Parameter(torch.full((3,), -0.5))
        self.parameters = [*self.mean.parameters(), *self.value.parameters(), self.log_spread]

    def look(self, states):
        return torch.as_tensor((states[..., self.sees] - CENTRE) / SCALE, dtype=torch.float32)

    def distribution(self, seen):
        return torch.distributions.Normal(self.mean(seen), self.log_spread.exp())

    def whole(self, moves):
        """The action of an environment: the right tip moves, all else rests."""
        action = np.zeros((*moves.shape[:-1], self.size))
        action[..., self.moves] = np.clip(moves, -1, 1)
        return action

    def act(self, state):
        with torch.no_grad():
            return self.whole(self.mean(self.look(state)).numpy())


def gather(pool, policy, states, rollout):
    """Plays so many steps in every environment: rows of what was seen, done and gained, and the states behind."""
    rows = {name: [] for name in ("seen", "moves", "likelihood", "value", "reward", "ends", "valid")}
    episodes = []
    for _ in range(rollout):
        with torch.no_grad():
            seen = policy.look(states)
            distribution = policy.distribution(seen)
            moves = distribution.sample()
        states, rewards, terminated, truncated, infos = pool.step(policy.whole(moves.numpy()))
        episodes += list(infos["is_success"][terminated | truncated])
        for name, value in (("seen", seen), ("moves", moves), ("likelihood", distribution.log_prob(moves).sum(-1)),
                            ("value", policy.value(seen).detach().squeeze(-1)),
                            ("reward", torch.as_tensor(rewards, dtype=torch.float32)),
                            ("ends", torch.as_tensor(terminated | truncated)),
                            # the step after an end only begins the next episode
                            ("valid", torch.as_tensor(~infos["was_reset"]))):
            rows[name].append(value)
    return {name: torch.stack(value) for name, value in rows.items()}, states, episodes


def advantages(rows, last_value):
    """Generalised advantage estimation (Schulman et al., arXiv 1506.02438)."""
    result, gained, following = torch.zeros_like(rows["reward"]), torch.zeros_like(last_value), last_value
    for t in reversed(range(len(result))):
        goes_on = (~rows["ends"][t]).float()
        error = rows["reward"][t] + DISCOUNT * following * goes_on - rows["value"][t]
        gained = error + DISCOUNT * TRACE * goes_on * gained
        result[t], following = gained, rows["value"][t]
    return result


def improve(policy, optimiser, rows, last_value):
    gain = advantages(rows, last_value)
    valid = rows["valid"].flatten()
    flat = {name: rows[name].flatten(0, 1)[valid] for name in ("seen", "moves", "likelihood")}
    target = (gain + rows["value"]).flatten()[valid]
    gain = gain.flatten()[valid]
    gain = (gain - gain.mean()) / (gain.std() + 1e-8)
    for _ in range(10):
        for part in torch.randperm(len(gain)).split(256):
            distribution = policy.distribution(flat["seen"][part])
            ratio = (distribution.log_prob(flat["moves"][part]).sum(-1) - flat["likelihood"][part]).exp()
            clipped = ratio.clamp(1 - CLIP, 1 + CLIP)
            loss = -torch.min(ratio * gain[part], clipped * gain[part]).mean()
            loss = loss + 0.5 * (policy.value(flat["seen"][part]).squeeze(-1) - target[part]).square().mean()
            optimiser.zero_grad()
            loss.backward()
            torch.nn.utils.clip_grad_norm_(policy.parameters, 0.5)
            optimiser.step()


def train(most_steps=400_000, most_seconds=600.0, seed=1, show=lambda steps, success: None):
    """A policy, and its learning curve: actions so far, and the share of the last episodes that succeeded."""
    with trocar.make_vec(TASK, ENVIRONMENTS, **SETTINGS) as pool:
        policy = Policy(pool, seed)
        optimiser = torch.optim.Adam(policy.parameters, lr=1e-3)
        states, _ = pool.reset(seed=seed)
        begin, steps, curve, recent = time.monotonic(), 0, ([0], [0.0]), []
        while steps < most_steps and time.monotonic() - begin < most_seconds:
            rows, states, episodes = gather(pool, policy, states, ROLLOUT)
            with torch.no_grad():
                last_value = policy.value(policy.look(states)).squeeze(-1)
            improve(policy, optimiser, rows, last_value)
            steps += ENVIRONMENTS * ROLLOUT
            recent = (recent + episodes)[-100:]
            curve[0].append(steps)
            curve[1].append(float(np.mean(recent)) if recent else 0.0)
            show(steps, curve[1][-1])
            if len(recent) == 100 and curve[1][-1] >= 0.99 and steps >= 50_000:
                break
    return policy, curve, time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10, help="at most, of training")
    parser.add_argument("--curve", default="reach.svg", help="picture of the learning curve")
    arguments = parser.parse_args()
    torch.set_num_threads(1)  # the networks are small; the pool has threads of its own
    policy, curve, seconds = train(
        most_seconds=60 * arguments.minutes,
        show=lambda steps, success: print(f"\r{steps:8} actions, {100 * success:3.0f} % of the last 100 episodes", end="", flush=True))
    print(f"\ntrained for {seconds:.0f} s")
    learning.write_curve(arguments.curve, "Reach, learnt from nothing", "actions", curve[0],
                         {"success": curve[1]})
    judge = lambda make_policy: learning.judge(TASK, UNSEEN, make_policy, **SETTINGS)
    learning.print_results({"learnt": judge(lambda environment, seed: policy.act), "random": judge(learning.random_policy),
                            "expert": learning.judge_expert(TASK, UNSEEN)}, UNSEEN)
    print(f"learning curve: {arguments.curve}")


if __name__ == "__main__":
    main()
