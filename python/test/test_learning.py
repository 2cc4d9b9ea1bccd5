# SPDX-License-Identifier: Apache-2.0
"""The samples that learn, in short: what was learnt is better than chance. They need python3-torch and python3-h5py."""
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import numpy as np

import trocar

SAMPLES = pathlib.Path(__file__).parents[2] / "samples" / "python"
sys.path[:0] = [str(SAMPLES), str(SAMPLES / "baselines")]
MISSING = [name for name in ("torch", "h5py") if importlib.util.find_spec(name) is None]
if MISSING:
    print(f"skipped: {', '.join(MISSING)} cannot be imported; run tools/install-packages --test")
    sys.exit(77)

import clone  # noqa: E402
import cloning  # noqa: E402
import common  # noqa: E402
import learning  # noqa: E402
import ppo  # noqa: E402
import reach  # noqa: E402
import run as baselines  # noqa: E402
import sac  # noqa: E402
import sight  # noqa: E402
import torch  # noqa: E402


def write_demonstrations(folder, *options):
    subprocess.run([os.environ["TROCAR_PROGRAM"], "dataset", "--layout", "trocar", "--no-pictures", "--every", "0.1", *options,
                    "-o", folder], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Learning(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        torch.set_num_threads(1)

    def test_reach_is_learnt_from_nothing(self):
        policy, curve, _ = reach.train(most_steps=45_000)
        seeds = range(10_001, 10_021)
        learnt, _ = learning.judge(reach.TASK, seeds, lambda environment, seed: policy.act, **reach.SETTINGS)
        chance, _ = learning.judge(reach.TASK, seeds, learning.random_policy, **reach.SETTINGS)
        self.assertGreater(learnt, chance + 0.2)
        self.assertGreater(max(curve[1]), 0.2)

    def test_lift_and_grasp_is_cloned(self):
        with tempfile.TemporaryDirectory() as folder:
            write_demonstrations(folder + "/set", "--task", "lift_and_grasp", "--seeds", "1:60")
            demonstrations = clone.Demonstrations(folder + "/set")
        self.assertEqual(demonstrations.task, "lift_and_grasp")
        learnt = clone.Clone(demonstrations)
        seeds, settings = range(10_001, 10_007), clone.settings(demonstrations)
        learnt.learn(20)
        # the plate is lifted or more: a chance policy does not even touch it
        steps = {}
        for name, policy in (("learnt", learnt.make_policy), ("random", learning.random_policy)):
            steps[name] = np.mean([self.most_steps(demonstrations, policy, seed, settings) for seed in seeds])
        self.assertGreater(steps["learnt"], steps["random"] + 0.2)

    @staticmethod
    def most_steps(demonstrations, make_policy, seed, settings):
        """Share of the goal's steps that were done, at most during an episode."""
        with trocar.make(demonstrations.task, seed=seed, **settings) as environment:
            policy = make_policy(environment, seed)
            state, _ = environment.reset(seed=seed)
            most = done = 0.0
            while True:
                state, _, terminated, truncated, info = environment.step(policy(state))
                done += info["features"]["step"]
                most = max(most, done)
                if terminated or truncated:
                    return most

    def test_demonstrated_actions_do_what_was_demonstrated(self):
        with tempfile.TemporaryDirectory() as folder:
            write_demonstrations(folder + "/set", "--task", "lift_and_grasp", "--seeds", "3:3")
            shown = clone.Demonstrations(folder + "/set")
        states, actions = shown.states[0], shown.actions[0]
        with trocar.make("lift_and_grasp", seed=3, layouts=1, actions="tip") as environment:
            self.assertEqual([f["name"] for f in environment.state_fields], [f["name"] for f in shown.fields["state"]])
            self.assertEqual([f["name"] for f in environment.action_fields], [f["name"] for f in shown.fields["action_tip"]])
            state, _ = environment.reset(seed=3)
            np.testing.assert_allclose(state, states[0], atol=1e-6)
            tips = learning.columns(environment.state_fields, ["left.tip", "right.tip"])
            for step in range(30):
                state, *_ = environment.step(actions[step].astype(float))
                np.testing.assert_allclose(state[tips], states[step + 1][tips], atol=0.0005)

    def test_what_is_next_is_found_in_demonstrations_of_many_things(self):
        with tempfile.TemporaryDirectory() as folder:
            write_demonstrations(folder + "/set", "--task", "peg_transfer", "--seeds", "1:1")
            shown = clone.Demonstrations(folder + "/set")
        self.assertAlmostEqual(shown.longest, 107, delta=20)
        seen = sight.Sight(shown.fields["state"], shown.states)
        names = [field["name"] for field in shown.fields["state"]]
        rings = [name for name in names if name.startswith("object.ring_") and name.endswith(".held")]
        regions = [name for name in names if name.startswith("region.")]
        self.assertEqual([rings[thing] for thing in seen.next.thing], 2 * [f"object.ring_{i}.held" for i in range(1, 7)])
        for goal, allowed in enumerate(seen.next.allowed):
            side = "right" if goal < 6 else "left"
            self.assertTrue(all(regions[region].startswith(f"region.{side}_") for region in np.flatnonzero(allowed)))
        # the left hand takes a ring at its left, the right one at its right: docs/tasks.md
        np.testing.assert_allclose(seen.next.grips[:, 0], [-0.0095, 0.0095], atol=0.0025)
        # the first ring is lifted, then the second: the same is seen, but for where it is
        goals, things, _ = seen.next.find(shown.states[0])
        firsts = [np.argmax(things == ring) for ring in range(6)]
        self.assertEqual(firsts, sorted(firsts))
        self.assertEqual(sorted(set(goals[:-1])), list(range(12)))
        # another ring that lies still far away changes nothing
        state = shown.states[0][:1].copy()
        before = seen.raw(state)
        state[:, seen.next.places[5]] += 0.001
        np.testing.assert_array_equal(before, seen.raw(state))
        state[:, seen.next.places[0]] += 0.001
        self.assertTrue((before != seen.raw(state)).any())

    def test_expert_and_clone_take_turns(self):
        with tempfile.TemporaryDirectory() as folder:
            write_demonstrations(folder + "/set", "--task", "lift_and_grasp", "--seeds", "1:2")
            shown = clone.Demonstrations(folder + "/set")
        rows = len(shown.rows()[0])
        parts = [part for seed in range(1, 4) for part in clone.take_turns(clone.Clone(shown), seed)]
        self.assertTrue(parts, "an untrained clone strays, and the expert finishes")
        for states, actions, is_whole in parts:
            self.assertEqual(len(states), len(actions) + 1)
            self.assertTrue(is_whole)
            shown.add(states, actions, is_whole)
        whole = rows + sum(len(actions) for _, actions, _ in parts)
        self.assertEqual(len(shown.rows()[0]), whole)
        # of a part that was cut off the last actions have no chunk that is known whole
        shown.is_whole[-1] = False
        self.assertEqual(len(shown.rows()[0]), whole - clone.CHUNK + 1)

    def test_who_does_nothing_for_long_is_given_up(self):
        rest = lambda environment, seed: lambda state: np.zeros(environment.action_space.shape)
        played = learning.play("lift_and_grasp", 1, rest, patience=3.0, actions="tip", most_seconds=20)
        self.assertEqual(played, (False, 0.0, 3.0))
        told = []
        self.assertEqual(learning.judge("lift_and_grasp", range(1, 22), rest, patience=0.2, actions="tip", show=told.append), (0.0, 0.0))
        self.assertEqual(len(told), 2, "after 20 and at the end")

    def test_curve_is_a_picture(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "curve.svg"
            learning.write_curve(path, "Title", "steps", [0, 10, 20], {"success": [0, 0.5, 1], "goals": [0, 0.2, 0.4]})
            root = xml.etree.ElementTree.parse(path).getroot()
        lines = [element for element in root.iter() if element.tag.endswith("polyline")]
        self.assertEqual(len(lines), 2)
        heights = [float(point.split(",")[1]) for point in lines[0].get("points").split()]
        self.assertEqual(heights, sorted(heights, reverse=True))


class Baselines(unittest.TestCase):
    """The published figures are of longer training; here it is seen that each learns, is judged and gets its line."""

    @classmethod
    def setUpClass(cls):
        torch.set_num_threads(1)

    @staticmethod
    def nearer(act, seeds):
        """By how many millimetres the tip comes nearer to the cage in the first second, on average."""
        ways = []
        for seed in seeds:
            with common.make("reach", observation=("state", "scaled")) as env:
                seen, _ = env.reset(seed=seed)
                tip, target = (learning.columns(env.state_fields, [name]) for name in ("right.tip", "region.target.centre"))
                distance = lambda: np.linalg.norm(seen["state"][tip] - seen["state"][target])
                before = distance()
                for _ in range(10):
                    seen, _, terminated, *_ = env.step(act(seen["scaled"]))
                    if terminated:
                        break
                ways.append(1e3 * (before - distance()))
        return np.mean(ways)

    def test_a_clone_comes_nearer_and_the_others_learn_something(self):
        seeds = range(10_001, 10_009)
        untrained = ppo.train("reach", 0.0, 1)[0]
        act, _ = cloning.train("reach", 16, 1)
        self.assertGreater(self.nearer(act, seeds), self.nearer(untrained, seeds) + 5)
        for algorithm, actions in ((ppo, 2_048), (sac, 2_080)):
            with self.subTest(algorithm=algorithm.__name__):
                act, curve = algorithm.train("reach", 600, 1, actions)
                self.assertEqual(curve.taken, actions)
                with common.make("reach") as env:
                    seen, _ = env.reset(seed=1)
                    self.assertFalse(np.allclose(act(seen), untrained(seen)))
                    self.assertTrue(np.isfinite(act(seen)).all())

    def test_expert_and_chance_are_judged_on_the_same_starts(self):
        expert = common.judge(lambda seed: common.play_expert("reach", seed), range(10_001, 10_006))
        self.assertEqual(expert, {"success": 1.0, "goals": 1.0, "episodes": 5})
        self.assertLess(common.judge(lambda seed: common.play_random("reach", seed), range(10_001, 10_006))["success"], 1)

    def test_page_says_what_was_measured_and_what_was_not(self):
        curve = {"actions": [0, 2048, 4096], "success": [0, 0.2, 0.6], "goals": [0, 0.2, 0.6]}
        runs = [{"task": "reach", "algorithm": algorithm, "seed": seed, "minutes": 2 if "ppo" == algorithm else 0, "date": "2026-11-30", "machine": "2 cores", "success": success,
                 "goals": success, "episodes": 100, **({"actions": 4096, "processor_seconds": 9, "curve": curve} if algorithm == "ppo" else {})}
                for algorithm, seed, success in (("random", 1, 0.0), ("expert", 1, 1.0), ("ppo", 1, 0.4), ("ppo", 2, 0.6))]
        with tempfile.TemporaryDirectory() as folder:
            before = baselines.PAGE, baselines.PICTURES
            baselines.PAGE, baselines.PICTURES = pathlib.Path(folder) / "page.md", pathlib.Path(folder)
            try:
                baselines.write_page(runs)
                page = baselines.PAGE.read_text()
                root = xml.etree.ElementTree.parse(pathlib.Path(folder) / "reach.svg").getroot()
            finally:
                baselines.PAGE, baselines.PICTURES = before
        self.assertIn("| PPO | 2 | 2 min of processor time, 4,096 actions | 50 % (40 to 60) | 50 % | 100 |", page)
        self.assertIn("- reach: SAC, behaviour cloning", page)
        self.assertIn("- peg_transfer: PPO, SAC, behaviour cloning", page)
        self.assertEqual(sum(element.tag.endswith("polyline") for element in root.iter()), 2)


if __name__ == "__main__":
    unittest.main()
