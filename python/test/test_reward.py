# SPDX-License-Identifier: Apache-2.0
"""Reward terms that users write."""
import json
import tempfile
import unittest

import numpy as np

import trocar


def code_of(call):
    try:
        call()
    except trocar.Error as error:
        return error.code
    return None


def near(state, before, features):
    return np.linalg.norm(before["left.tip"] - state["region.left_1.centre"]) - np.linalg.norm(state["left.tip"] - state["region.left_1.centre"])


class Terms(unittest.TestCase):
    def test_functions_and_expressions_say_the_same(self):
        terms = {"function": near, "expression": "before(norm(left.tip - region.left_1.centre)) - norm(left.tip - region.left_1.centre)",
                 "weighted": {"expression": 'feature["time"]', "weight": -2, "about": "seconds cost"}}
        with trocar.make("peg_transfer", actions="tip", terms=terms) as env, trocar.make("peg_transfer", actions="tip") as plain:
            env.reset(seed=1)
            plain.reset(seed=1)
            env.action_space.seed(1)
            for _ in range(4):
                action = env.action_space.sample()
                _, reward, _, _, info = env.step(action)
                _, base, *_ = plain.step(action)
                self.assertAlmostEqual(info["terms"]["function"], info["terms"]["expression"], places=6)
                self.assertAlmostEqual(info["terms"]["weighted"], -2 * info["features"]["time"], places=12)
                self.assertAlmostEqual(reward, base + sum(info["terms"].values()), places=12)
            self.assertNotEqual(info["terms"]["function"], 0)

    def test_pools_add_them_too_in_every_way_of_resetting(self):
        terms = {"function": near, "expression": "0.5 * norm(left.tip - before(left.tip)) + goal - 0.1 * (force > 1)"}
        for mode in ("NextStep", "SameStep"):
            with self.subTest(mode=mode):
                settings = {"actions": "tip", "terms": terms, "most_seconds": 0.3}
                pool, env = trocar.make_vec("peg_transfer", 3, autoreset_mode=mode, **settings), trocar.make("peg_transfer", **settings)
                pool.reset(seed=5)
                env.reset(seed=6)
                pool.action_space.seed(2)
                over = False
                for _ in range(9):
                    actions = pool.action_space.sample()
                    _, rewards, terminated, truncated, infos = pool.step(actions)
                    if over and mode == "NextStep":
                        env.reset()
                        self.assertEqual(rewards[1], 0)
                        over = False
                        continue
                    _, reward, *ends, info = env.step(actions[1])
                    self.assertAlmostEqual(rewards[1], reward, places=6)
                    self.assertAlmostEqual(infos["terms"]["function"][1], info["terms"]["function"], places=6)
                    over = any(ends)
                    if over and mode == "SameStep":
                        env.reset()

    def test_a_file_is_enough(self):
        with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
            json.dump({"format": "trocar-reward-terms", "version": 1, "terms": {"high": {"expression": "left.tip[2] + 1", "weight": 2}}}, file)
            file.flush()
            with trocar.make("peg_transfer", terms=file.name) as env:
                env.reset(seed=1)
                seen, _, _, _, info = env.step(np.zeros(10))
                tip = next(field["first"] for field in env.state_fields if field["name"] == "left.tip")
                self.assertAlmostEqual(info["terms"]["high"], 2 * (float(seen[tip + 2]) + 1), places=6)

    def test_vectors_of_three_environments_are_not_mixed_up(self):
        """Three environments and three parts of a place: what is beside what must not be guessed from the sizes."""
        terms = {"e": "norm(max(left.tip, feature['time']) * 2 - clip(right.tip, 0 - force, 1))"}
        pool, env = trocar.make_vec("peg_transfer", 3, actions="tip", terms=terms), trocar.make("peg_transfer", actions="tip", terms=terms)
        pool.reset(seed=1)
        action = np.linspace(-1, 1, 10)
        found = pool.step(np.tile(action, (3, 1)))[-1]["terms"]["e"]
        for i in range(3):
            env.reset(seed=1 + i)
            self.assertAlmostEqual(env.step(action)[-1]["terms"]["e"], found[i], places=6)

    def test_names_with_blanks(self):
        with trocar.make("lift_and_grasp", terms={"half": 'state["goal.The bead.done"] - before(state["goal.The bead.done"])'}) as env:
            env.reset(seed=1)
            self.assertEqual(env.step(np.zeros(10))[4]["terms"], {"half": 0.0})

    def test_what_is_none_is_refused_with_its_name(self):
        for code, term in (("E-SCN-003", "left.tipp[0]"), ("E-SCN-003", "nobody"), ("E-CLI-001", "left.tip"), ("E-CLI-001", "1 +"), ("E-CLI-001", "__import__('os')"),
                           ("E-CLI-001", "left.tip[5]"), ("E-CLI-001", "(lambda: 1)()"), ("E-CLI-001", "[1, 2]"), ("E-CLI-001", "before(before(left.force))"), ("E-SCN-003", "time"), ("E-SCN-003", 'feature["left.tip"]'), ("E-SCN-003", 'state["goal"]'), ("E-CLI-001", "norm(1, 2)"), ("E-CLI-001", "norm(force)"), ("E-CLI-001", "dot(left.tip, 2)"), ("E-CLI-001", "9" * 400),
                           ("E-CLI-001", "'text'"), ("E-CLI-001", "before(goal)"), ("E-CLI-001", "True"), ("E-CLI-001", "(" * 400 + "1" + ")" * 400), ("E-CLI-001", 3),
                           ("E-CLI-001", {"weight": 1}), ("E-CLI-001", {"expression": "1", "function": near}), ("E-CLI-001", {"expression": "1", "weight": float("nan")}),
                           ("E-CLI-001", {"expression": "1", "wait": 1})):
            def use():
                with trocar.make("peg_transfer", terms={"mine": term}) as env:
                    env.reset(seed=1)
                    env.step(np.zeros(10))
            with self.subTest(term=term):
                self.assertEqual(code_of(use), code)
        for wrong in (5, ["a"], {1: "time"}):
            self.assertEqual(code_of(lambda: trocar.make("peg_transfer", terms=wrong)), "E-CLI-001")
        self.assertEqual(code_of(lambda: trocar.make("peg_transfer", terms="/no/such.json")), "E-IO-001")
        self.assertEqual(code_of(lambda: trocar.make("peg_transfer", terms=str(trocar.find("peg_transfer")))), "E-IO-005")

    def test_a_term_that_is_no_number_stops(self):
        for term in ("1 / (goal - goal)", "sqrt(0 - 1)", lambda *_: "much", lambda *_: float("nan"), "10 ** 400"):
            with trocar.make("peg_transfer", terms={"mine": term}) as env, trocar.make_vec("peg_transfer", 2, terms={"mine": term}) as pool:
                env.reset(seed=1)
                pool.reset(seed=1)
                self.assertEqual(code_of(lambda: env.step(np.zeros(10))), "E-CLI-001")
                self.assertEqual(code_of(lambda: pool.step(np.zeros((2, 10)))), "E-CLI-001")

    def test_fields_are_found_by_name(self):
        with trocar.make("peg_transfer", terms={"sees": lambda state, before, features: len(state) + ("left.tip" in state) + state["left.tip"].shape[0]}) as env:
            env.reset(seed=1)
            self.assertEqual(env.step(np.zeros(10))[4]["terms"]["sees"], len(env.state_fields) + 1 + 3)


if __name__ == "__main__":
    unittest.main()
