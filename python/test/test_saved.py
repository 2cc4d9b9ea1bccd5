# SPDX-License-Identifier: Apache-2.0
"""Environments that are saved, restored and cloned, with their observations and rewards."""
import resource
import time
import unittest

import numpy as np

import trocar

SETTINGS = {"actions": "tip", "observation": ("state", "scaled", "contacts"), "terms": {"still": "-norm(left.tip - before(left.tip))"},
            "ranges": {"latency_s": (0.02, 0.1), "friction": (0.8, 1.2), "start_mm": (0, 8)}}


def code_of(call):
    try:
        call()
    except trocar.Error as error:
        return error.code
    return None


def go_on(env, actions):
    """All that an environment says while it goes on, and what the next episode begins with."""
    seen = []
    for action in actions:
        observation, reward, terminated, truncated, info = env.step(action)
        seen.append((observation, reward, terminated, truncated, info))
    return seen, env.reset(), env.hash()


class Saved(unittest.TestCase):
    def same(self, a, b):
        np.testing.assert_equal(a, b)

    def test_the_same_actions_give_the_same_from_there(self):
        for task in trocar.environments():
            settings = SETTINGS if task != "cholecystectomy" else {**SETTINGS, "ranges": {"latency_s": 0.05}}
            with self.subTest(task=task), trocar.make(task, **settings) as env, trocar.make(task, **settings) as other:
                env.reset(seed=6)
                env.action_space.seed(6)
                surgeon = env.surgeon()
                for _ in range(12):
                    env.step_by(surgeon)  # hands at work
                state = env.save()
                actions = [env.action_space.sample() for _ in range(4)]
                expected = go_on(env, actions)
                observation, info = env.restore(state)
                self.assertEqual(info["seed"], 6)
                self.assertIn(observation, env.observation_space)
                self.same(go_on(env, actions), expected)
                other.reset(seed=2)
                self.same(other.restore(state)[0], observation)
                self.same(go_on(other, actions), expected)

    def test_a_clone_goes_on_by_itself(self):
        for task in ("peg_transfer", "hook_dissection"):
            with self.subTest(task=task), trocar.make(task, **SETTINGS) as env:
                env.reset(seed=3)
                env.action_space.seed(1)
                for _ in range(5):
                    env.step(env.action_space.sample())
                actions = [env.action_space.sample() for _ in range(4)]
                clone = env.clone()
                self.assertIs(type(clone), type(env))
                before = env.hash()
                expected = go_on(clone, actions)
                self.assertEqual(env.hash(), before, "what a clone does, its original does not")
                self.same(go_on(env, actions), expected)
                env.close()
                clone.step(actions[0])
                clone.close()

    def test_before_the_first_episode(self):
        with trocar.make("peg_transfer") as env, trocar.make("peg_transfer") as other:
            other.reset(seed=1)
            other.restore(env.save())
            self.assertEqual(code_of(lambda: other.step(np.zeros(10))), "E-ENV-002")

    def test_the_end_of_an_episode_is_saved_too(self):
        with trocar.make("peg_transfer", most_seconds=0.1) as env:
            env.reset(seed=1)
            env.step(np.zeros(10))
            state = env.save()
            env.reset(seed=2)
            env.restore(state)
            self.assertEqual(code_of(lambda: env.step(np.zeros(10))), "E-ENV-002")

    def test_other_bytes_are_refused_and_change_nothing(self):
        with trocar.make("peg_transfer", actions="tip") as env, trocar.make("wire_run", actions="tip") as other:
            env.reset(seed=1)
            other.reset(seed=1)
            state, before = env.save(), env.hash()
            wrong = [b"", b"abc", state[:20], state[:-1], state + b"x", bytes(len(state)), other.save(), trocar.Simulation("peg_transfer").save()]
            for at in range(0, len(state), max(1, len(state) // 97)):
                damaged = bytearray(state)
                damaged[at] ^= 0x40
                wrong.append(bytes(damaged))
            for bad in wrong:
                self.assertEqual(code_of(lambda: env.restore(bad)), "E-SIM-006", bad[:40])
                self.assertEqual(env.hash(), before)
            env.step(np.zeros(10))

    def test_trees_do_not_grow(self):
        """A tree search over the operation: as many cycles as it takes to see that nothing is left behind."""
        with trocar.make("cholecystectomy", actions="tip") as env:
            env.reset(seed=1)
            root = env.save()

            def cycle():
                env.restore(root)
                return env.save()
            for _ in range(30):
                self.assertEqual(cycle(), root)
            memory, begin = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
            for _ in range(1000):
                cycle()
            grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory
            print(f"{(time.process_time() - begin):.3f} ms of processor time a cycle of {len(root) / 1e6:.1f} MB, {grown} KiB more after 1,000")
            self.assertLess(grown, 4096)


class Contacts(unittest.TestCase):
    def test_of_tissue_add_up_to_the_force(self):
        """The left grasper presses the duct, which nothing but its two ends holds."""
        with trocar.make("clip_and_cut", actions="tip", ranges={"start_mm": 0}) as env:
            env.reset(seed=1)
            place = next(field["first"] for field in env.state_fields if field["name"] == "surface.cystic_duct.middle")
            names, pressed, height = [field["name"] for field in env.action_fields], 0, 0.012  # first above it, then down
            for _ in range(20):
                way = env._state()[place:place + 3] + [-0.02, 0, height] - env.snapshot()["instruments"]["left"]["pose"][:3, 3]
                height = -0.003 if np.linalg.norm(way) < 0.004 else height
                action = -np.array([name.endswith(".tool") for name in names], float)  # the tools that they have
                action[:3] = 0.3 * way / max(np.abs(way).max(), 0.004)
                env.step(action)
                seen = env.snapshot()
                own = [contact for contact in seen["contacts"] if contact["hand"] == "left"]
                for contact in own:
                    self.assertAlmostEqual(np.linalg.norm(contact["normal"]), 1, places=9)
                    self.assertEqual((contact["tool"], contact["organ"], contact["object"]), ("grasper", "cystic_duct", None))
                    self.assertGreater(contact["force"] @ contact["normal"], 0)
                    self.assertLess(np.linalg.norm(contact["point"] - seen["instruments"]["left"]["pose"][:3, 3]), 0.03)
                if own:
                    pressed += 1
                    np.testing.assert_allclose(sum(contact["force"] for contact in own), seen["instruments"]["left"]["force"], atol=1e-6)
            self.assertGreater(pressed, 2)

    def test_of_things_lie_on_them(self):
        with trocar.make("peg_transfer", actions="tip", observation=("state", "contacts")) as env:
            seen, _ = env.reset(seed=1)
            self.assertFalse(seen["contacts"].any())
            action = np.zeros(10)
            action[2] = -1  # down onto the board
            for _ in range(8):
                seen, *_ = env.step(action)
            described = [contact for contact in env.snapshot()["contacts"] if contact["object"] == "board"]
            self.assertTrue(described)
            for contact in described:
                self.assertAlmostEqual(contact["point"][2], -0.140, delta=0.003)
                self.assertGreater(contact["normal"][2], 0.9)
                self.assertEqual(contact["hand"], "left")
            self.assertGreater(max(contact["force"][2] for contact in described), 0.1)
            rows = seen["contacts"][seen["contacts"][:, 0] == 1]
            self.assertEqual(len(rows), len(env.snapshot()["contacts"]))
            strengths = np.linalg.norm(rows[:, 7:10], axis=1)
            self.assertTrue((np.diff(strengths) <= 1e-6).all())
            pool = trocar.make_vec("peg_transfer", 2, actions="tip", observation=("state", "contacts"))
            pool.reset(seed=1)
            for _ in range(8):
                batch, *_ = pool.step(np.array([action, np.zeros(10)]))
            np.testing.assert_array_equal(batch["contacts"][0], seen["contacts"])
            self.assertFalse(batch["contacts"][1].any())


class Scaled(unittest.TestCase):
    def test_states_lie_within_their_bounds(self):
        for task in trocar.environments():
            with self.subTest(task=task), trocar.make(task, observation=("state", "scaled"), actions="tip") as env:
                low, high = env.model.state_bounds
                self.assertTrue((low < high).all())
                self.assertTrue(np.isfinite(low).all() and np.isfinite(high).all())
                outside = np.zeros(env.model.state_size)
                for seed in range(8 if task != "cholecystectomy" else 2):
                    seen, _ = env.reset(seed=seed)
                    self.assertIn(seen["scaled"], env.observation_space["scaled"])
                    state = seen["state"]
                    np.testing.assert_allclose(low + (seen["scaled"] + 1) / 2 * (high - low), np.clip(state, low, high), atol=1e-4 * (high - low).max())
                    outside = np.maximum(outside, np.maximum(low - state, state - high))
                names = {field["name"]: outside[field["first"]:field["first"] + field["count"]].max() for field in env.state_fields}
                self.assertLessEqual(max(names.values()), 1e-6, max(names, key=names.get))

    def test_bounds_are_the_same_for_every_seed(self):
        for task in ("lift_and_grasp", "instrument_navigation", "clip_and_cut"):
            bounds = [trocar.make(task, seed=seed, layouts=layouts).model.state_bounds for seed, layouts in ((1, 0), (5, 0), (9, 1))]
            for other in bounds[1:]:
                np.testing.assert_array_equal(bounds[0], other)

    def test_pools_scale_the_same(self):
        pool, env = trocar.make_vec("peg_transfer", 2, observation="scaled", autoreset_mode="SameStep", most_seconds=0.1), trocar.make("peg_transfer", observation="scaled")
        states, _ = pool.reset(seed=5)
        np.testing.assert_array_equal(states[1], env.reset(seed=6)[0])
        final = pool.step(np.zeros((2, 10)))[-1]["final_obs"]
        self.assertIn(final[0], pool.single_observation_space)


class Errors(unittest.TestCase):
    def test_actions_are_clipped_where_that_is_wanted(self):
        for actions in ("joints", "tip", "discrete"):
            with self.subTest(actions=actions), trocar.make("camera_navigation_0", actions=actions, action_errors="clip") as env, \
                    trocar.make("camera_navigation_0", actions=actions) as strict:
                env.reset(seed=1)
                strict.reset(seed=1)
                shape = env.action_space.shape
                best = env.action_space.high if actions != "discrete" else np.array(env.action_space.nvec) - 1
                least = env.action_space.low if actions != "discrete" else np.zeros(shape)
                for wrong, right in ((np.full(shape, 50.0), best), (np.full(shape, -50.0), least)):
                    self.assertEqual(code_of(lambda: strict.step(wrong)), "E-ENV-001")
                    np.testing.assert_array_equal(env.step(wrong)[0], strict.step(right)[0])
                for bad in (np.full(shape, np.nan), np.full(shape, np.inf), np.zeros(shape[0] + 1)):
                    self.assertEqual(code_of(lambda: env.step(bad)), "E-ENV-001")
        pool = trocar.make_vec("peg_transfer", 2, action_errors="clip")
        pool.reset(seed=1)
        pool.step(np.full((2, 10), 3.0))
        self.assertEqual(code_of(lambda: trocar.make("peg_transfer", action_errors="ignore")), "E-SCN-003")


class Rendering(unittest.TestCase):
    def test_has_a_size_of_its_own(self):
        with trocar.make("peg_transfer", observation="mixture", picture_size=(32, 24), render_mode="rgb_array", render_size=(160, 120)) as env:
            seen, _ = env.reset(seed=1)
            self.assertEqual((seen["picture"].shape, env.render().shape), ((24, 32, 3), (120, 160, 3)))
            self.assertGreater(env.render().std(), 5)
        pool = trocar.make_vec("peg_transfer", 2, render_mode="rgb_array", render_size=(64, 48))
        pool.reset(seed=[1, 2])
        first, second = pool.render()
        self.assertFalse((first == second).all())
        with trocar.make("peg_transfer", render_mode="rgb_array", render_size=(64, 48)) as env:
            env.reset(seed=2)
            np.testing.assert_array_equal(env.render(), second)
        pool.send(np.zeros((2, 10)))
        self.assertEqual(code_of(pool.render), "E-ENV-002")
        pool.recv()
        self.assertIsNone(trocar.make_vec("peg_transfer", 2).render())
        self.assertEqual(code_of(lambda: trocar.make_vec("peg_transfer", 2, render_mode="human")), "E-SCN-003")


if __name__ == "__main__":
    unittest.main()
