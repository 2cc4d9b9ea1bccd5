# SPDX-License-Identifier: Apache-2.0
"""What the network of clone.py sees of a state: tips, spins, jaws, things and goals, and how far each tip is from them."""
import numpy as np
import torch

# by which tips, spins and jaws are moved away while learning, so that the policy finds back [m], [rad]
STRAY, STRAY_SPIN, STRAY_JAW = 0.001, 0.2, 0.02
NEAR = 0.002   # differences of places are seen in detail below this [m]
TAKEN = 0.008  # a thing that lies so near to a region's middle fills it [m]
MANY = 3       # of more things than these only the next is seen
HANDS = ("left", "right")


def places_of(fields):
    """Name of a field to the places of its numbers."""
    return {field["name"]: np.arange(field["first"], field["first"] + field["count"]) for field in fields}


def rotations(quaternions):
    """(n, 4) w, x, y, z to (n, 3, 3)."""
    w, x, y, z = quaternions.T
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                     2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                     2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1).reshape(-1, 3, 3)


class Next:
    """Which thing is next, where it may go and where a hand takes it. A state says none of it: whole demonstrations did.

    One ring is like another then: what was learnt of one is known of all.
    """

    def __init__(self, fields, demonstrations):
        at = places_of(fields)
        things = [name.removesuffix("held") for name in at if name.endswith(".held")]
        self.held, self.places, self.turns = (np.array([at[thing + what] for thing in things])
                                              for what in ("held", "position", "rotation"))
        self.regions = np.array([at[name] for name in at if name.startswith("region.")]).reshape(-1, 3)
        self.done = np.array([at[name][0] for name in at if name.startswith("goal.") and name.endswith(".done")])
        self.open = np.array([at[name][0] for name in at if name.startswith("goal.") and name.endswith(".is_open")])
        self.tips = np.array([at[f"{hand}.tip"] for hand in HANDS])
        # each was completed; the last goal is done after the last state that was recorded
        ends = [[(goal, np.argmax(seen[:, place] >= 1) if seen[-1, place] >= 1 else len(seen) - 1)
                 for goal, place in enumerate(self.done)] for seen in demonstrations]
        # a goal is about what hands held since the goal before it was done
        held = np.zeros((len(self.done), len(things)))
        for seen, done in zip(demonstrations, ends):
            for goal, end in done:
                begin = max((other for _, other in done if other < end), default=0)
                held[goal] += seen[begin:end][:, self.held].max(2).sum(0)
        self.thing = held.argmax(1)
        # it may go to where it lay then
        self.allowed = np.zeros((len(self.done), len(self.regions)), bool)
        for seen, done in zip(demonstrations, ends):
            for goal, end in done:
                away = np.linalg.norm(seen[end, self.regions] - seen[end, self.places[self.thing[goal]]], axis=1)
                self.allowed[goal, away.argmin()] = True
        self.grips = np.array([self._grip(demonstrations, hand) for hand in range(len(HANDS))])

    def _grip(self, demonstrations, hand):
        """Where the hand's tip is in the frame of what it takes [m], the mean."""
        tips = [np.zeros(3)]
        for seen in demonstrations:
            for held, place, turn in zip(self.held, self.places, self.turns):
                rows = seen[1:][(seen[1:, held[hand]] > 0) & (seen[:-1, held[hand]] == 0)]
                away = rows[:, self.tips[hand]] - rows[:, place]
                tips += list(np.einsum("nij,ni->nj", rotations(rows[:, turn]), away))
        return np.mean(tips[1:] or tips, axis=0)

    def find(self, states):
        """(goals, things, regions), (n,) each: a goal that was begun goes before one that is open."""
        share = states[:, self.done]
        is_open = (states[:, self.open] > 0) & (share < 1)
        goals = (is_open + (is_open & (share > 0))).argmax(1)
        things = self.thing[goals]
        row = np.arange(len(states))
        centres, places = states[:, self.regions], states[:, self.places]
        away = np.linalg.norm(centres[:, :, None] - places[:, None], axis=3)  # (n, regions, things)
        own = away[row, :, things]
        away[row, :, things] = np.inf
        return goals, things, np.where(self.allowed[goals] & (away.min(2) > TAKEN), own, np.inf).argmin(1)

    def look(self, states):
        """(ways from place to place (n, m, 3) [m], all else (n, k))."""
        row = np.arange(len(states))
        goals, things, regions = self.find(states)
        take = lambda places: states[row[:, None], places]
        place, centre, tips = take(self.places[things]), take(self.regions[regions]), states[:, self.tips]
        turn = rotations(take(self.turns[things]))
        grips = place[:, None] + np.einsum("nij,hj->nhi", turn, self.grips)
        others = states[:, self.places].copy()
        others[row, things] = 10.0  # far away
        beside = tips[:, :, None] - others[:, None]  # (n, hands, things, 3)
        nearest = np.linalg.norm(beside, axis=3).argmin(2)
        beside = np.take_along_axis(beside, nearest[:, :, None, None], 2)[:, :, 0]
        ways = np.concatenate([tips - grips, tips - centre[:, None], tips - place[:, None], beside, (place - centre)[:, None],
                               (tips[:, 0] - tips[:, 1])[:, None]], axis=1)
        return ways, np.concatenate([place, turn[:, :, :2].reshape(-1, 6), take(self.held[things]), centre,
                                     take(self.done[goals][:, None])], axis=1)


class Sight:
    """Numbers for a network. Of many things it sees the one that is next, and what is nearest to each tip beside it.

    The clock would be learnt by heart. Trocar joints and shafts say again where a tip is: who sees both learns to trust the wrong one
    while tips are moved aside.
    """

    def __init__(self, fields, demonstrations):
        at = places_of(fields)
        self.tips = np.concatenate([at[f"{hand}.tip"] for hand in HANDS])
        self.held = [at[name] for name in at if name.endswith(".held")]
        self.things = [at[name.removesuffix("held") + "position"] for name in at if name.endswith(".held")]
        self.turns = np.concatenate([at[f"{hand}.joints"][[2, 4]] for hand in HANDS])  # spin and jaw
        self.next = Next(fields, demonstrations) if len(self.things) > MANY else None
        ends = ("tip", "is_grasping", "is_touching")
        if not self.next:
            ends += ("held", "done", "is_open", "is_whole")
        whole = [name for name in at if name.split(".")[-1] in ends]
        if not self.next:
            whole += [name.removesuffix("held") + what for name in at if name.endswith(".held") for what in ("position", "rotation")]
        self.sees = np.concatenate([*(at[name] for name in whole), self.turns])
        regions = [at[name] for name in at if name.startswith("region.")]
        tips = [at[f"{hand}.tip"] for hand in HANDS]
        self.pairs = [(a, b) for a in tips for b in self.things + regions] + [(a, b) for a in self.things for b in regions]
        self.mean = self.spread = None

    def raw(self, states):
        if self.next:
            ways, other = self.next.look(states)
            return np.concatenate([states[:, self.sees], other, np.arcsinh(ways / NEAR).reshape(len(states), -1)], axis=1)
        ways = [np.arcsinh((states[:, a] - states[:, b]) / NEAR) for a, b in self.pairs]
        return np.concatenate([states[:, self.sees], *ways], axis=1)

    def measure(self, states):
        raw = self.raw(states)
        self.mean, self.spread = raw.mean(0), np.maximum(raw.std(0), 0.01)  # what hardly changed is not blown up

    def look(self, states):
        return torch.as_tensor(np.clip((self.raw(states) - self.mean) / self.spread, -10, 10), dtype=torch.float32)

    def stray(self, states, random):
        """Copies with tips moved aside, and what they hold with them, spins and jaws, too; by how much tips were, (n, 2, 3) [m]."""
        states = states.copy()
        states[:, self.turns] += random.normal(0, 1, (len(states), 4)) * ([STRAY_SPIN, STRAY_JAW] * 2)
        stray = random.normal(0, STRAY, (len(states), 2, 3))
        states[:, self.tips] += stray.reshape(-1, 6)
        for held, place in zip(self.held, self.things):
            holds = states[:, held]
            states[:, place] += (holds[..., None] * stray).sum(1) / np.maximum(holds.sum(1), 1)[:, None]
        return states, stray
