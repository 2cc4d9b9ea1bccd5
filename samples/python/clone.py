# SPDX-License-Identifier: Apache-2.0
"""Clones a surgeon from demonstrations that `trocar dataset` wrote: clone.py DIR [--epochs N] [--rounds N] [--seeds A:B] [--curve clone.svg]

  trocar dataset --layout trocar --no-pictures --task lift_and_grasp --seeds 1:120 --every 0.1 -o sets/lift
  build/python/bin/python samples/python/clone.py sets/lift
  trocar dataset --layout trocar --no-pictures --task peg_transfer --seeds 1:30 --every 0.1 -o sets/peg
  build/python/bin/python samples/python/clone.py sets/peg --epochs 40 --attempts 14

Behaviour cloning with chunks of actions (Zhao et al., "Learning fine-grained bimanual manipulation", RSS 2023): from what an
environment observes, a network foretells where both tips will be during the next second, and how they are turned and opened. Some of it is
done, then it looks again. Between rounds of learning the clone plays, and somewhere the expert takes over; with many goals they take
turns. What the expert did from there on is demonstrated, too (after Ross et al., "A reduction of imitation learning to no-regret
online learning", AISTATS 2011). Needs python3-torch and python3-h5py.
"""
import argparse
import json
import pathlib
from concurrent.futures import ThreadPoolExecutor

import learning  # first: it says how many threads torch gets

import h5py
import numpy as np
import torch

import trocar
from sight import HANDS, Sight, places_of

CHUNK = 8    # actions that are foretold
DONE = 7     # of them are done before the next look: before jaws open or close, hands rest for longer than the rest says
TIP_SPEED, SPIN_RATE, JAW_RATE = 0.12, 3.0, 2.5  # of an action of 1 [m/s], [rad/s]
TREMBLE = 0.05  # of an action, when it is judged
PATIENCE = 20   # an attempt in which so long no step of a goal was done has failed, when it is judged [s]
ROUND_SEEDS = 20_001  # and on: of what the clone begins and the expert goes on with
GOALS_A_TURN = 2      # that the expert finishes in the time of a turn


class Demonstrations:
    """States and actions of attempts that were completed, and of parts of others."""

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
        self.is_whole = [True] * len(self.states)

    def add(self, states, actions, is_whole):
        """What was demonstrated later; of a part that was cut off what came next is not known."""
        self.states.append(states)
        self.actions.append(actions)
        self.is_whole.append(is_whole)

    def rows(self):
        """(n, state), and for each the chunk (n, CHUNK, 2, 5): how far each tip will be from here [m], its spin and commanded jaw [rad].

        Not rates: those add up whatever error is made. Jaws that hold a thing are seen open and commanded shut.
        """
        at = places_of(self.fields["state"])
        tips = [at[f"{hand}.tip"] for hand in HANDS]
        spins, jaws = ([at[f"{hand}.joints"][joint] for hand in HANDS] for joint in (2, 4))
        jaw_actions = learning.columns(self.fields["action_tip"], [f"{hand}.jaw" for hand in HANDS])
        holds = np.concatenate([at[f"{hand}.is_grasping"] for hand in HANDS])
        states, chunks = [], []
        for seen, done, is_whole in zip(self.states, self.actions, self.is_whole):
            last = len(seen) - 1
            ahead = np.minimum(np.arange(last)[:, None] + 1 + np.arange(CHUNK), last)
            places = np.stack([seen[:, tip] for tip in tips], axis=1)
            commanded = np.empty((len(seen), 2))
            commanded[0] = np.where(seen[0, holds] > 0, 0, seen[0, jaws])
            for step in range(last):
                commanded[step + 1] = np.maximum(commanded[step] + self.every * JAW_RATE * done[step, jaw_actions], 0)
            known = last if is_whole else max(0, last - CHUNK + 1)
            states.append(seen[:known])
            chunks.append(np.concatenate([places[ahead] - places[:last, None], seen[:, spins][ahead][..., None],
                                          commanded[ahead][..., None]], axis=-1)[:known])
        return np.concatenate(states), np.concatenate(chunks)


class Clone:
    """What was learnt of demonstrations, as a policy of the environment with tip actions."""

    def __init__(self, demonstrations, seed=1):
        torch.manual_seed(seed)
        self.demonstrations, self.every, self.epochs = demonstrations, demonstrations.every, 0
        states, chunks = demonstrations.rows()
        self.sight = Sight(demonstrations.fields["state"], demonstrations.states)
        self.sight.measure(states)
        self.centre = chunks.reshape(-1, 2, 5).mean(0)
        self.scale = np.abs(chunks - self.centre).reshape(-1, 2, 5).max((0, 1)) + 1e-6
        self.net = learning.network([self.sight.look(states[:1]).shape[1], 256, 256, 256, CHUNK * 10], torch.nn.ReLU)

    def foretell(self, state):
        with torch.no_grad():
            return self.net(self.sight.look(state[None])).numpy().reshape(CHUNK, 2, 5) * self.scale + self.centre

    def learn(self, epochs, show=lambda epoch: None):
        """Goes on learning, from all that was demonstrated so far."""
        random = np.random.default_rng(1 + self.epochs)
        all_states, all_chunks = self.demonstrations.rows()
        optimiser = torch.optim.Adam(self.net.parameters(), lr=1e-3)
        rate = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, epochs, 1e-5)
        for _ in range(epochs):
            for part in np.array_split(random.permutation(len(all_states)), max(1, len(all_states) // 256)):
                states, stray = self.sight.stray(all_states[part], random)
                chunks = all_chunks[part].copy()
                chunks[..., :3] -= stray[:, None]
                foretold = self.net(self.sight.look(states))
                wanted = torch.as_tensor(((chunks - self.centre) / self.scale).reshape(len(part), -1), dtype=torch.float32)
                loss = torch.nn.functional.smooth_l1_loss(foretold, wanted, beta=0.02)
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
            rate.step()
            self.epochs += 1
            show(self.epochs)

    def make_policy(self, environment, seed):
        fields = environment.action_fields
        moves = [learning.columns(fields, [f"{hand}.{what}" for what in ("x", "y", "z", "spin", "jaw")]) for hand in HANDS]
        plan = []

        def act(state):
            nonlocal plan
            now = np.concatenate([state[self.sight.tips].reshape(2, 3), state[self.sight.turns].reshape(2, 2)], axis=1)
            if not plan:
                plan = list(self.foretell(state)[:DONE] + now * [1, 1, 1, 0, 0])
            shares = (plan.pop(0) - now) / (self.every * np.array([TIP_SPEED] * 3 + [SPIN_RATE, JAW_RATE]))
            action = np.zeros(environment.action_space.shape)
            action[moves] = np.clip(shares, -1, 1)
            return action
        return act


def settings(demonstrations, slack=3):
    # as the demonstrations, which `trocar dataset` takes of the task that people train at
    return {"layouts": 1, "level": demonstrations.level, "actions": "tip", "actions_per_second": 1 / demonstrations.every,
            "most_seconds": slack * demonstrations.longest}


def take_turns(learnt, seed):
    """[(states, actions, is whole)] of an expert who takes over from the clone at times that the seed draws.

    With a goal or two the expert takes over once and finishes. With more they take turns, and what the expert did in one counts where a
    step of a goal was done in it.
    """
    shown = learnt.demonstrations
    random = np.random.default_rng(seed)
    tremble = TREMBLE * random.choice([1, 4])
    shown_parts = []
    with trocar.make(shown.task, seed=seed, **settings(shown, slack=6)) as environment:
        goals = sum(field["name"].startswith("goal.") and field["name"].endswith(".done") for field in environment.state_fields)
        turns = max(1, goals // GOALS_A_TURN)
        longest = int(1.2 * shown.longest / shown.every / turns)
        policy = learnt.make_policy(environment, seed)
        state, _ = environment.reset(seed=seed)
        is_over = False
        for turn in range(turns):
            for _ in range(random.integers(1, longest)):
                if is_over:
                    return shown_parts
                action = policy(state)
                action = np.clip(action + tremble * random.standard_normal(action.shape), -1, 1)
                state, _, terminated, truncated, info = environment.step(action)
                is_over = terminated or truncated
            most = random.integers(1, longest) if turn + 1 < turns else np.inf
            surgeon, states, actions, gained = environment.surgeon("expert", seed=seed), [state], [], 0.0
            while not (is_over or surgeon.has_finished) and len(actions) < most:
                state, _, terminated, truncated, info = environment.step_by(surgeon)
                is_over = terminated or truncated
                states.append(state)
                actions.append(info["action"])
                gained += info["features"]["step"]
            succeeded = is_over and info["is_success"]
            if gained > 0 and (turns > 1 or succeeded):
                shown_parts.append((np.array(states), np.array(actions, np.float32), succeeded))
            policy = learnt.make_policy(environment, seed)  # what it foretold is past
    return shown_parts


def clone(demonstrations, epochs, rounds=0, attempts=80, seeds=range(9_001, 9_013), show=lambda text: print(text, flush=True)):
    """A clone, and its learning curve: epochs, and the share of successes and of goals over a few seeds."""
    learnt = Clone(demonstrations)
    curve = ([], [], [])

    def judge():
        success, goals = learning.judge(demonstrations.task, seeds, learnt.make_policy, tremble=TREMBLE, patience=PATIENCE,
                                        **settings(demonstrations))
        for row, value in zip(curve, (learnt.epochs, success, goals)):
            row.append(value)
        show(f"epoch {learnt.epochs}: {100 * success:.0f} % of {len(seeds)} attempts succeed, {100 * goals:.0f} % of the goals are done")

    def look(epoch):
        if epoch % epochs == 0 or epoch == epochs // 2:
            judge()

    learnt.learn(epochs, look)
    for number in range(rounds):
        first = ROUND_SEEDS + number * attempts
        with ThreadPoolExecutor(2) as pool:
            parts = [part for some in pool.map(lambda seed: take_turns(learnt, seed), range(first, first + attempts)) for part in some]
        for part in parts:
            demonstrations.add(*part)
        show(f"round {number + 1}: in {attempts} attempts the expert took over and got on {len(parts)} times, {sum(len(part[1]) for part in parts)} actions")
        learnt.learn(epochs, look)
    return learnt, curve


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", help="a set of the layout trocar")
    parser.add_argument("--epochs", type=int, default=20, help="of each round and before the first")
    parser.add_argument("--rounds", type=int, default=1, help="in which the expert finishes what the clone began")
    parser.add_argument("--attempts", type=int, default=80, help="of a round")
    parser.add_argument("--seeds", default="10001:10100", help="on which the clone is judged, both included")
    parser.add_argument("--curve", default="clone.svg", help="picture of the learning curve")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    first, last = map(int, arguments.seeds.split(":"))
    unseen = range(first, last + 1)
    demonstrations = Demonstrations(arguments.folder)
    shown = len(demonstrations.states)
    print(f"{shown} demonstrations of {demonstrations.task}, the longest of {demonstrations.longest:.0f} s", flush=True)
    learnt, curve = clone(demonstrations, arguments.epochs, arguments.rounds, arguments.attempts)
    learning.write_curve(arguments.curve, f"{demonstrations.task}, cloned from {shown} demonstrations",
                         "epochs", curve[0], {"success": curve[1], "goals done": curve[2]})
    print(f"learning curve: {arguments.curve}", flush=True)

    def judge(name, make_policy):
        return learning.judge(demonstrations.task, unseen, make_policy, tremble=TREMBLE, patience=PATIENCE,
                              show=lambda text: print(f"{name}: {text}", flush=True), **settings(demonstrations))
    results = {"cloned": judge("cloned", learnt.make_policy), "random": judge("random", learning.random_policy),
               "expert": learning.judge_expert(demonstrations.task, unseen, demonstrations.level, show=lambda text: print(f"expert: {text}", flush=True))}
    learning.print_results(results, unseen)


if __name__ == "__main__":
    main()
