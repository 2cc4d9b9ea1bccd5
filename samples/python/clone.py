# SPDX-License-Identifier: Apache-2.0
"""Clones a surgeon from demonstrations that `trocar dataset` wrote: clone.py DIR [--epochs N] [--seeds A:B] [--curve clone.svg]

  trocar dataset --layout trocar --no-pictures --task lift_and_grasp --seeds 1:300 --every 0.1 -o sets/lift
  build/python/bin/python samples/python/clone.py sets/lift

Behaviour cloning with chunks of actions (Zhao et al., "Learning fine-grained bimanual manipulation", RSS 2023): from what an
environment observes, a network foretells where both tips will be during the next second, and how spin and jaws turn. Some of it is
done, then it looks again. Needs python3-torch and python3-h5py.
"""
import argparse
import json
import pathlib

import learning  # first: it says how many threads torch gets

import h5py
import numpy as np
import torch

CHUNK = 8    # actions that are foretold
DONE = 3     # of them are done before the next look
STRAY = 0.001  # by which tips are moved away while learning, so that the policy finds back [m]
HANDS = ("left", "right")
TIP_SPEED = 0.12  # of an action of 1 [m/s]
TREMBLE = 0.05  # of an action, when it is judged


class Demonstrations:
    """States and actions of attempts that were completed."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        self.card = json.loads((folder / "card.json").read_text())
        self.states, self.actions = [], []
        for video in self.card["videos"]:
            if video["outcome"] != "completed":
                continue
            with h5py.File(folder / f"video_{video['seed']:05d}.h5") as file:
                self.fields = json.loads(bytes(file["fields"][:]))
                self.states.append(file["state"][:])
                self.actions.append(file["action_tip"][:])
        if not self.states:
            raise SystemExit(f"{folder} holds no attempt that was completed")
        plan = self.card["plan"]
        self.task, self.level, self.every = plan["task"], plan["level"], plan["every_seconds"]
        self.longest = max(len(states) for states in self.states) * self.every

    def rows(self):
        """(n, state), and for each the chunk (n, CHUNK, 2, 5): tips from where they are [m], spin and jaw as shares."""
        tips = learning.columns(self.fields["state"], [f"{hand}.tip" for hand in HANDS])
        turns = learning.columns(self.fields["action_tip"], [f"{hand}.{what}" for hand in HANDS for what in ("spin", "jaw")])
        states, chunks = [], []
        for seen, done in zip(self.states, self.actions):
            last = len(seen) - 1
            ahead = np.minimum(np.arange(last)[:, None] + 1 + np.arange(CHUNK), last)
            places = seen[:, tips].reshape(-1, 2, 3)
            way = places[ahead] - places[:last, None]
            turn = np.where((ahead - np.arange(last)[:, None] == 1 + np.arange(CHUNK))[..., None, None],
                            done[ahead - 1][..., turns].reshape(last, CHUNK, 2, 2), 0)
            states.append(seen[:last])
            chunks.append(np.concatenate([way, turn], axis=-1))
        return np.concatenate(states), np.concatenate(chunks)


class Clone:
    """What was learnt of demonstrations, as a policy of the environment with tip actions."""

    def __init__(self, demonstrations, seed=1):
        torch.manual_seed(seed)
        self.every, self.fields = demonstrations.every, demonstrations.fields
        states, self.chunks = demonstrations.rows()
        # what never changed says nothing, and the clock would be learnt by heart
        names = [f["name"] for f in self.fields["state"] if f["name"] != "time" and not f["name"].endswith(".force")]
        self.sees = [c for c in learning.columns(self.fields["state"], names) if states[:, c].std() > 1e-5]
        self.tips = learning.columns(self.fields["state"], [f"{hand}.tip" for hand in HANDS])
        self.seen_tips = [self.sees.index(c) for c in self.tips if c in self.sees]
        self.moved_tips = [i for i, c in enumerate(self.tips) if c in self.sees]
        self.states = states[:, self.sees]
        self.mean, self.spread = self.states.mean(0), self.states.std(0) + 1e-6
        self.scale = np.abs(self.chunks).reshape(-1, 2, 5).max((0, 1)) + 1e-6
        self.net = learning.network([len(self.sees), 256, 256, 256, CHUNK * 10], torch.nn.ReLU)

    def foretell(self, state):
        with torch.no_grad():
            seen = torch.as_tensor((state[self.sees] - self.mean) / self.spread, dtype=torch.float32)
            return self.net(seen).numpy().reshape(CHUNK, 2, 5) * self.scale

    def learn(self, epochs, show=lambda epoch: None):
        random = np.random.default_rng(1)
        optimiser = torch.optim.Adam(self.net.parameters(), lr=1e-3)
        rate = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, epochs, 1e-5)
        for epoch in range(1, epochs + 1):
            for part in np.array_split(random.permutation(len(self.states)), max(1, len(self.states) // 256)):
                states, chunks = self.states[part].copy(), self.chunks[part].copy()
                stray = random.normal(0, STRAY, (len(part), 6))
                states[:, self.seen_tips] += stray[:, self.moved_tips]
                chunks[..., :3] -= stray.reshape(-1, 1, 2, 3)
                foretold = self.net(torch.as_tensor((states - self.mean) / self.spread, dtype=torch.float32))
                wanted = torch.as_tensor((chunks / self.scale).reshape(len(part), -1), dtype=torch.float32)
                loss = torch.nn.functional.smooth_l1_loss(foretold, wanted, beta=0.02)
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
            rate.step()
            show(epoch)

    def make_policy(self, environment, seed):
        fields = environment.action_fields
        moves = [learning.columns(fields, [f"{hand}.{what}" for what in ("x", "y", "z", "spin", "jaw")]) for hand in HANDS]
        plan, aims = [], None

        def act(state):
            nonlocal plan, aims
            tips = state[self.tips].reshape(2, 3)
            if not plan:
                plan = list(self.foretell(state)[:DONE])
                aims = tips
            step = plan.pop(0)
            action = np.zeros(environment.action_space.shape)
            for hand in range(2):
                action[moves[hand][:3]] = (aims[hand] + step[hand, :3] - tips[hand]) / (self.every * TIP_SPEED)
                action[moves[hand][3:]] = step[hand, 3:]
            return np.clip(action, -1, 1)
        return act


def clone(demonstrations, epochs, looks=8, seeds=range(9_001, 9_021), show=lambda text: print(text, flush=True)):
    """A clone, and its learning curve: epochs, and the share of goals and of successes over a few seeds."""
    learnt = Clone(demonstrations)
    curve = ([], [], [])

    def look(epoch):
        if epoch % max(1, epochs // looks) and epoch != epochs:
            return
        success, goals = learning.judge(demonstrations.task, seeds, learnt.make_policy, **settings(demonstrations))
        for row, value in zip(curve, (epoch, success, goals)):
            row.append(value)
        show(f"epoch {epoch}: {100 * success:.0f} % of {len(seeds)} attempts succeed, {100 * goals:.0f} % of the goals are done")

    learnt.learn(epochs, look)
    return learnt, curve


def settings(demonstrations, slack=1.5):
    return {"level": demonstrations.level, "actions": "tip", "actions_per_second": 1 / demonstrations.every,
            "most_seconds": slack * demonstrations.longest, "tremble": TREMBLE}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", help="a set of the layout trocar")
    parser.add_argument("--epochs", type=int, default=40)
    parser.add_argument("--seeds", default="10001:10100", help="on which the clone is judged, both included")
    parser.add_argument("--curve", default="clone.svg", help="picture of the learning curve")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    first, last = map(int, arguments.seeds.split(":"))
    unseen = range(first, last + 1)
    demonstrations = Demonstrations(arguments.folder)
    print(f"{len(demonstrations.states)} demonstrations of {demonstrations.task}, the longest of {demonstrations.longest:.0f} s",
          flush=True)
    learnt, curve = clone(demonstrations, arguments.epochs)
    learning.write_curve(arguments.curve, f"{demonstrations.task}, cloned from {len(demonstrations.states)} demonstrations",
                         "epochs", curve[0], {"success": curve[1], "goals done": curve[2]})
    judge = lambda make_policy: learning.judge(demonstrations.task, unseen, make_policy, **settings(demonstrations))
    learning.print_results({"cloned": judge(learnt.make_policy), "random": judge(learning.random_policy),
                            "expert": learning.judge_expert(demonstrations.task, unseen, demonstrations.level)}, unseen)
    print(f"learning curve: {arguments.curve}")


if __name__ == "__main__":
    main()
