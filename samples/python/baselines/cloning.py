# SPDX-License-Identifier: Apache-2.0
"""Behaviour cloning: a network learns what the scripted expert does where it is. Source: Pomerleau, "ALVINN", NIPS 1988.

Half of the time the expert plays, from the starts of the seeds of training; in the other half the network learns.
"""
import numpy as np
import torch

import common

BATCH, RATE, WIDTH = 256, 1e-3, 256


class Clone:
    def __init__(self, sees, moves):
        self.body = common.network([sees, WIDTH, WIDTH, moves], torch.nn.ReLU)

    def act(self, observation):
        with torch.no_grad():
            return self.body(torch.as_tensor(observation)).numpy()


def train(task, seconds, seed, most_actions=float("inf")):
    """(function from an observation to an action, learning curve: of the loss there is none, of the actions one point)"""
    torch.manual_seed(seed)
    curve, showing = common.Curve(seconds), common.Curve(seconds / 2)
    seen, done, episode = [], [], 1_000_000 * seed
    while not showing.is_over and len(seen) < most_actions:
        rows = []
        success, _ = common.play_expert(task, episode, lambda observation, action: rows.append((observation, action)))
        episode += 1
        if success:
            seen += [row[0] for row in rows]
            done += [row[1] for row in rows]
    if not seen:
        raise SystemExit(f"the expert completed no attempt at {task} within {seconds / 2:g} s")
    seen, done = torch.as_tensor(np.array(seen)), torch.as_tensor(np.array(done), dtype=torch.float32)
    clone = Clone(seen.shape[1], done.shape[1])
    optimiser = torch.optim.Adam(clone.body.parameters(), lr=RATE)
    while not curve.is_over:
        for part in torch.randperm(len(seen)).split(BATCH):
            loss = (clone.body(seen[part]) - done[part]).abs().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            if curve.is_over:
                break
    curve.taken = len(seen)
    return clone.act, curve
