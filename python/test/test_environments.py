# SPDX-License-Identifier: Apache-2.0
"""Environments against the published interface, and against bad input."""
import copy
import json
import multiprocessing
import pickle
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

import trocar


def code_of(call):
    try:
        call()
    except trocar.Error as error:
        return error.code
    return None


def first_reward(task):
    env = trocar.make(task)
    env.reset(seed=1)
    return env.step(np.zeros(env.action_space.shape, np.float32))[1]


class Interface(unittest.TestCase):
    def test_every_task_holds_the_interface(self):
        for task in trocar.environments():
            if task == "cholecystectomy":
                continue
            for actions in ("joints", "tip", "discrete"):
                with self.subTest(task=task, actions=actions):
                    trocar.check_env(trocar.make(task, actions=actions, layouts=2), steps=3)

    def test_operation_holds_the_interface(self):
        trocar.check_env(trocar.make("cholecystectomy", actions="tip"), steps=2)

    def test_mixtures_hold_the_interface(self):
        for observation in ("picture", "mixture"):
            with self.subTest(observation=observation):
                trocar.check_env(trocar.make("lift_and_grasp", observation=observation, layouts=2, render_mode="rgb_array"), steps=2)

    def test_pool_holds_the_interface(self):
        for mode in ("NextStep", "SameStep"):
            with self.subTest(mode=mode):
                trocar.check_vector_env(trocar.make_vec("peg_transfer", 3, autoreset_mode=mode, most_seconds=0.5), steps=8)

    def test_pool_with_pictures_holds_the_interface(self):
        for observation in ("masks", ("state", "picture", "depth")):
            with self.subTest(observation=observation):
                pool = trocar.make_vec("lift_and_grasp", 2, observation=observation, picture_size=(24, 16), most_seconds=0.3)
                trocar.check_vector_env(pool, steps=5)

    def test_checker_finds_what_is_wrong(self):
        class Random(trocar.Environment):
            def step(self, action):
                observation, reward, *rest = super().step(action)
                return (observation, reward + np.random.rand(), *rest)

        class Outside(trocar.Environment):
            def reset(self, **settings):
                observation, info = super().reset(**settings)
                return observation[:-1], info

        class Short(trocar.Environment):
            def step(self, action):
                return super().step(action)[:4]

        class Unseeded(trocar.Environment):
            def reset(self, *, seed=None, options=None):
                return super().reset(options=options)

        for wrong in (Random, Outside, Short, Unseeded):
            with self.subTest(wrong=wrong.__name__), self.assertRaises(AssertionError):
                trocar.check_env(wrong("peg_transfer"), steps=2)


class Meaning(unittest.TestCase):
    def test_reward_is_the_weighted_sum_of_features(self):
        weights = {name: 0.0 for name in trocar.FEATURES}
        weights.update(path=3.0, time=-2.0)
        env = trocar.make("peg_transfer", weights=weights)
        env.reset(seed=1)
        _, reward, _, _, info = env.step(np.full(env.action_space.shape, 0.5, np.float32))
        self.assertGreater(info["features"]["path"], 0)
        self.assertAlmostEqual(reward, 3 * info["features"]["path"] - 2 * info["features"]["time"], places=12)
        self.assertAlmostEqual(info["features"]["time"], 0.1, places=9)

    def test_state_says_where_the_tips_are(self):
        env = trocar.make("peg_transfer", actions="tip")
        field = next(f for f in env.state_fields if f["name"] == "right.tip")
        tip = slice(field["first"], field["first"] + field["count"])
        before, _ = env.reset(seed=1)
        action = np.zeros(env.action_space.shape, np.float32)
        action[[f["name"] for f in env.action_fields].index("right.x")] = -0.5
        after = env.step(action)[0]
        np.testing.assert_allclose(after[tip] - before[tip], [-0.006, 0, 0], atol=5e-4)

    def test_pool_is_as_many_environments(self):
        pool, env = trocar.make_vec("peg_transfer", 3, threads=2), trocar.make("peg_transfer")
        states, _ = pool.reset(seed=7)
        state, _ = env.reset(seed=9)
        np.testing.assert_array_equal(states[2], state)
        pool.action_space.seed(1)
        for _ in range(5):
            actions = pool.action_space.sample()
            states, rewards, *_ = pool.step(actions)
            state, reward, *_ = env.step(actions[2])
            np.testing.assert_array_equal(states[2], state)
            self.assertEqual(rewards[2], reward)

    def test_pool_draws_what_an_environment_draws(self):
        settings = {"observation": ("state", "picture", "depth", "masks", "normals"), "picture_size": (40, 32)}
        pool, env = trocar.make_vec("peg_transfer", 3, threads=2, **settings), trocar.make("peg_transfer", **settings)
        seen, _ = pool.reset(seed=7)
        alone, _ = env.reset(seed=8)
        pool.action_space.seed(1)
        for _ in range(3):
            for part in settings["observation"]:
                np.testing.assert_array_equal(seen[part][1], alone[part], part)
            actions = pool.action_space.sample()
            seen, *_ = pool.step(actions)
            alone, *_ = env.step(actions[1])
        self.assertEqual(seen["picture"].shape, (3, 32, 40, 3))
        self.assertEqual(code_of(lambda: trocar.make_vec("peg_transfer", 2, observation="smell")), "E-SCN-003")
        self.assertEqual(code_of(lambda: trocar.make_vec("peg_transfer", 2, observation="depth", picture_size=(4, 4))), "E-CLI-001")

    def test_the_last_picture_of_an_episode_is_kept(self):
        pool = trocar.make_vec("camera_navigation_0", 2, observation=("state", "picture"), picture_size=(32, 24),
                               layouts=1, autoreset_mode="SameStep", most_seconds=0.2)
        first, _ = pool.reset(seed=1)
        actions = np.ones((2, pool.model.action_size))
        before, *_ = pool.step(actions)
        seen, _, _, truncated, infos = pool.step(actions)
        self.assertTrue(truncated.all())
        np.testing.assert_array_equal(seen["picture"], first["picture"])
        last = infos["final_obs"][1]["picture"]
        self.assertTrue((last != first["picture"][1]).any() and (last != before["picture"][1]).any())

    def test_send_and_recv_serve_some(self):
        pool = trocar.make_vec("peg_transfer", 4, threads=2)
        pool.reset(seed=1)
        pool.send(np.zeros((4, pool.model.action_size)))
        seen = []
        while len(seen) < 4:
            states, rewards, _, _, infos = pool.recv(1)
            self.assertEqual((states.shape[0], rewards.shape), (1, (1,)))
            seen += list(infos["env_id"])
        self.assertEqual(sorted(seen), [0, 1, 2, 3])
        self.assertEqual(code_of(lambda: pool.recv(1)), "E-ENV-002")

    def test_ends_are_told_apart_and_reset_as_declared(self):
        pool = trocar.make_vec("peg_transfer", 2, layouts=1, autoreset_mode="SameStep", most_seconds=0.2)
        first, _ = pool.reset(seed=1)
        pool.step(np.zeros((2, 10)))
        states, _, terminated, truncated, infos = pool.step(np.zeros((2, 10)))
        self.assertTrue(truncated.all() and not terminated.any())
        np.testing.assert_array_equal(states, first)
        self.assertAlmostEqual(infos["final_obs"][0][-1], 1, places=5)

    def test_views_are_read_only(self):
        pool = trocar.make_vec("peg_transfer", 2, copy=False)
        states, _ = pool.reset(seed=1)
        with self.assertRaises(ValueError):
            states[0, 0] = 1

    def test_parallel_view_is_the_same_environment(self):
        together, apart = trocar.make("camera_navigation_0"), trocar.make_parallel("camera_navigation_0")
        together.reset(seed=1)
        apart.reset(seed=1)
        self.assertEqual(apart.agents, ["left", "right", "camera"])
        together.action_space.seed(2)
        action = together.action_space.sample()
        names = [field["name"].split(".")[0] for field in together.action_fields]
        parts = {agent: action[[name == agent for name in names]] for agent in apart.agents}
        observation, reward, *_ = together.step(action)
        observations, rewards, *_ = apart.step(parts)
        for agent in apart.possible_agents:
            np.testing.assert_array_equal(observations[agent], observation)
            self.assertEqual(rewards[agent], reward)
        self.assertEqual(code_of(lambda: apart.step({"left": parts["left"]})), "E-ENV-001")


    def test_infos_say_of_which_environments_they_are(self):
        pool = trocar.make_vec("peg_transfer", 3, autoreset_mode="SameStep", most_seconds=0.3, layouts=4)
        infos = pool.reset(seed=[1, 2, 3])[1]
        self.assertEqual(infos["layout"].tolist(), [trocar.make("peg_transfer", layouts=4).reset(seed=seed)[1]["layout"] for seed in (1, 2, 3)])
        pool.step(np.zeros((3, 10)))
        self.assertEqual(pool.reset(options={"reset_mask": np.array([False, True, False])})[1]["_layout"].tolist(), [False, True, False])
        for _ in range(2):
            pool.send(np.ones((3, 10)))
            *_, truncated, infos = pool.recv()
        # the first and the last have ended now, in their third step; the second was reset after its first
        self.assertEqual(truncated.tolist(), [True, False, True])
        for infos_of, keys, has in ((infos, ("env_id", "is_success", "was_reset", "features"), [True] * 3), (infos, ("final_obs", "final_info", "layout"), truncated.tolist()),
                                    (infos["final_info"], ("is_success", "features"), truncated.tolist())):
            for key in keys:
                self.assertEqual(infos_of["_" + key].tolist(), has, key)
        final = infos["final_info"]
        np.testing.assert_array_equal(final["features"][truncated], infos["features"][truncated])
        self.assertFalse(final["features"][1].any())
        self.assertGreater(final["features"][0][trocar.FEATURES.index("time")], 0)
        self.assertIsNone(infos["final_obs"][1])

    def test_a_pool_takes_a_seed_for_each(self):
        pool, other = trocar.make_vec("peg_transfer", 3, layouts=64), trocar.make("peg_transfer", layouts=64)
        layouts = {seed: other.reset(seed=seed)[1]["layout"] for seed in (1, 5, 9, 10, 11)}
        for seeds in ([5, 1, 9], (5, 1, 9), np.array([5, 1, 9]), [np.int64(5), np.uint8(1), 9]):
            self.assertEqual(pool.reset(seed=seeds)[1]["layout"].tolist(), [layouts[seed] for seed in (5, 1, 9)])
            self.assertEqual(pool.np_random_seed, (5, 1, 9))
        self.assertEqual(pool.reset(seed=np.int32(9))[1]["layout"].tolist(), [layouts[seed] for seed in (9, 10, 11)])
        # the second goes on with the row that 10 began
        other.reset(seed=10)
        self.assertEqual(pool.reset(seed=[5, None, 5])[1]["layout"].tolist(), [layouts[5], other.reset()[1]["layout"], layouts[5]])
        self.assertEqual(pool.np_random_seed, (5, 10, 5))
        for wrong in ([1, 2], [1, 2, 3, 4], [1, -2, 3], [1, 2.5, 3], "abc", -1, 1.5, True, 2 ** 64, [1, "two", 3], {1, 2, 3}, [[1], [2], [3]]):
            self.assertEqual(code_of(lambda: pool.reset(seed=wrong)), "E-CLI-001", repr(wrong))
        for wrong in (np.array([True]), np.array([0, 1, 1]), [True, False], "all"):
            self.assertEqual(code_of(lambda: pool.reset(options={"reset_mask": wrong})), "E-CLI-001", repr(wrong))
        for wrong in (-1, 1.5, "one", True, [1]):
            self.assertEqual(code_of(lambda: other.reset(seed=wrong)), "E-CLI-001", repr(wrong))

    def test_random_numbers_are_those_of_the_seed(self):
        env = trocar.make("peg_transfer")
        env.reset(seed=7)
        expected = np.random.Generator(np.random.PCG64(np.random.SeedSequence(7))).random(3)
        np.testing.assert_array_equal(env.np_random.random(3), expected)
        self.assertEqual(env.np_random_seed, 7)
        before = env.np_random
        env.reset()
        env.step(np.zeros(10))
        self.assertTrue(env.np_random is before and env.np_random_seed == 7)
        env.np_random = np.random.default_rng(3)
        self.assertEqual((env.np_random.random(), env.np_random_seed), (np.random.default_rng(3).random(), -1))
        other = trocar.make("peg_transfer")
        seed = other.np_random_seed  # a new one, that the numbers belong to
        self.assertEqual(other.np_random.random(), np.random.default_rng(seed).random())
        pool = trocar.make_vec("peg_transfer", 2)
        pool.reset(seed=7)
        np.testing.assert_array_equal(pool.np_random[0].random(3), expected)
        self.assertEqual(len(pool.np_random), 2)

    def test_agents_do_nothing_after_the_end(self):
        env = trocar.make_parallel("peg_transfer", most_seconds=0.1)
        self.assertEqual(code_of(lambda: env.step({})), "E-ENV-002")
        _, infos = env.reset(seed=1)
        self.assertIsNot(infos["left"], infos["right"])
        env.step({agent: np.zeros(5) for agent in env.agents})
        self.assertEqual((env.agents, code_of(lambda: env.step({}))), ([], "E-ENV-002"))


class Copies(unittest.TestCase):
    ways = staticmethod(lambda: (lambda thing: pickle.loads(pickle.dumps(thing)), copy.copy, copy.deepcopy))

    def test_are_made_of_the_same(self):
        task = json.loads(trocar.find("lift_and_grasp").read_text())
        settings = {"folder": str(trocar.find("lift_and_grasp").parent), "seed": 3, "layouts": 2, "actions": "tip", "weights": {"path": np.float32(2)}}
        for make in (lambda: trocar.make(task, **settings), lambda: trocar.make_vec(task, 2, autoreset_mode="SameStep", **settings),
                     lambda: trocar.make_parallel(task, **settings), lambda: Renamed("tip")):
            env = make()
            env.reset(seed=5)  # a copy does not know of it
            for again in self.ways():
                with self.subTest(env=str(env)):
                    other, new = again(env), make()
                    self.assertIs(type(other), type(env))
                    self.assertEqual(code_of(lambda: other.step(self.still(other))), "E-ENV-002")
                    for seed in (None, 4):
                        seen, expected = other.reset(seed=seed)[0], new.reset(seed=seed)[0]
                        step, other_step = other.step(self.still(other)), new.step(self.still(new))
                        for a, b in ((seen, expected), (step[0], other_step[0]), (step[1], other_step[1])):
                            np.testing.assert_equal(a, b)

    @staticmethod
    def still(env):
        if isinstance(env, trocar.ParallelEnvironment):
            return {agent: np.zeros(env.action_space(agent).shape) for agent in env.possible_agents}
        return np.full(env.action_space.shape, 0.5)

    def test_models_too(self):
        model = trocar.make("lift_and_grasp", actions="discrete", layouts=3).model
        for again in self.ways():
            other = again(model)
            self.assertEqual((other.action_fields, other.state_fields), (model.action_fields, model.state_fields))

    def test_dictionaries_may_change_afterwards(self):
        task = json.loads(trocar.find("lift_and_grasp").read_text())
        env = trocar.make(task, folder=str(trocar.find("lift_and_grasp").parent))
        task.clear()
        self.assertEqual(pickle.loads(pickle.dumps(env)).task, env.task)


class Renamed(trocar.Environment):
    """Of other arguments than its parent."""

    def __init__(self, kind):
        super().__init__("lift_and_grasp", actions=kind)


class Metrics(unittest.TestCase):
    def test_are_those_of_a_simulation_with_the_same_hands(self):
        with trocar.make("instrument_navigation", seed=2, layouts=1, metrics=True) as env:
            env.reset(seed=2)
            env.step(np.full(env.action_space.shape, 0.5, np.float32))
            env.reset()  # what was before is no part of it
            surgeon, is_over = env.surgeon("expert", seed=2), False
            while not is_over:
                *_, terminated, truncated, info = env.step_by(surgeon)
                is_over = terminated or truncated
            found, ticks = env.metrics(), env._environment.tick
        self.assertTrue(info["is_success"])
        simulation = trocar.Simulation("instrument_navigation", seed=2, metrics=True)
        simulation.play(trocar.Surgeon("expert", simulation, seed=2), ticks)
        self.assertEqual(found, simulation.metrics())

    def test_are_collected_where_they_are_wanted_only(self):
        with trocar.make("peg_transfer") as env:
            self.assertEqual(code_of(env.metrics), "E-ENV-002")
        self.assertEqual(code_of(env.metrics), "E-ENV-002")


class PlayedBySurgeons(unittest.TestCase):
    def test_an_expert_finishes_what_chance_began(self):
        with trocar.make("lift_and_grasp", seed=3, actions="tip", most_seconds=90) as env:
            env.reset(seed=3)
            env.action_space.seed(3)
            for _ in range(20):
                env.step(0.3 * env.action_space.sample())
            surgeon = env.surgeon("expert", seed=3)
            is_over = False
            while not is_over:
                state, reward, terminated, truncated, info = env.step_by(surgeon)
                self.assertTrue(env.action_space.contains(info["action"].astype(np.float32)))
                is_over = terminated or truncated
            self.assertTrue(info["is_success"], surgeon.doing)
            self.assertEqual(code_of(lambda: env.step_by(surgeon)), "E-ENV-002")

    def test_another_goes_on_where_tissue_is_worked_on(self):
        with trocar.make("clip_and_cut", seed=1, most_seconds=90) as env:
            env.reset(seed=1)
            surgeon = env.surgeon("expert")
            for _ in range(40):
                env.step_by(surgeon)
            surgeon, is_over = env.surgeon("expert", seed=2), False
            while not is_over:
                state, reward, terminated, truncated, info = env.step_by(surgeon)
                is_over = terminated or truncated
            self.assertTrue(info["is_success"], surgeon.doing)

    def test_is_refused(self):
        with trocar.make("clip_and_cut") as env:
            env.reset(seed=1)
            self.assertEqual(code_of(lambda: env.surgeon("nobody")), "E-SCN-003")
        with trocar.make("lift_and_grasp", actions="discrete") as env:
            env.reset(seed=1)
            surgeon = env.surgeon()
            self.assertEqual(code_of(lambda: env.step_by(surgeon)), "E-CLI-001")
        self.assertEqual(code_of(lambda: env.surgeon()), "E-ENV-002")


class Geometry(unittest.TestCase):
    def test_observations_of_geometry_lie_in_their_spaces(self):
        for observation in ("depth", "masks", "normals", ("state", "picture", "depth", "masks", "normals")):
            with self.subTest(observation=observation):
                env = trocar.make("peg_transfer", observation=observation, picture_size=(48, 32))
                seen, _ = env.reset(seed=1)
                self.assertIn(seen, env.observation_space)
        self.assertEqual((seen["depth"].shape, seen["masks"].dtype, seen["normals"].shape),
                         ((32, 48), np.uint8, (32, 48, 3)))
        self.assertIn(trocar.CLASSES["object"], seen["masks"])
        np.testing.assert_array_equal(seen["depth"] > 0, seen["masks"] > 0)
        trocar.check_env(trocar.make("peg_transfer", observation=("masks", "depth"), picture_size=(32, 32)), steps=2)

    def test_flow_follows_a_tip(self):
        simulation = trocar.Simulation("peg_transfer")
        camera = trocar.Camera(160, 120)
        first = camera.geometry(simulation, flow=True)
        self.assertTrue(np.isnan(first["flow"]).all())

        def pixel():
            now = simulation.snapshot()
            tip = np.linalg.inv(now["camera"]) @ now["instruments"]["right"]["pose"][:, 3]
            return first["focal_length"] * np.array([tip[0], -tip[1]]) / -tip[2]

        before, inputs = pixel(), simulation.home()
        joints = inputs.hands
        joints[1, 0] += 0.05
        inputs.hands = joints
        simulation.step(inputs, ticks=1)
        seen = camera.geometry(simulation, flow=True)
        way = pixel() - before
        self.assertGreater(np.linalg.norm(way), 3)
        row, column = np.nonzero((seen["classes"] == trocar.CLASSES["dissector"]) & (seen["instances"] == 1))
        near = np.argsort(np.hypot(column + 0.5 - 80 - pixel()[0], row + 0.5 - 60 - pixel()[1]))[:5]
        flow = seen["flow"][row[near], column[near]]
        np.testing.assert_allclose(flow, np.broadcast_to(way, flow.shape), atol=0.15 * np.linalg.norm(way))
        self.assertNotIn("flow", camera.geometry(simulation))

    def test_a_pixel_of_the_gallbladder_leads_back_to_it(self):
        simulation = trocar.Simulation("cholecystectomy", seed=1)
        seen = trocar.Camera(160, 120).geometry(simulation)
        row, column = np.nonzero(seen["classes"] == trocar.CLASSES["gallbladder"])
        self.assertGreater(len(row), 50)
        depth = seen["depth"][row, column].astype(float)
        ray = np.stack([(column + 0.5 - 80) / seen["focal_length"], -(row + 0.5 - 60) / seen["focal_length"],
                        -np.ones(len(row))], axis=1)
        points = (depth[:, None] * ray) @ seen["pose"][:3, :3].T + seen["pose"][:3, 3]
        surface = next(s for s in simulation.surfaces() if s["name"] == "gallbladder")
        nodes = simulation.positions()[surface["first_node"]:surface["first_node"] + surface["node_count"]]
        nearest = np.sqrt(((points[:, None] - nodes[None]) ** 2).sum(-1)).min(1)
        self.assertLess(nearest.max(), 0.004)


class BadInput(unittest.TestCase):
    def test_actions(self):
        env = trocar.make("peg_transfer")
        good = np.zeros(10, np.float32)
        self.assertEqual(code_of(lambda: env.step(good)), "E-ENV-002")
        env.reset(seed=1)
        for wrong in (good[:9], np.zeros((2, 5)), np.full(10, np.nan), np.full(10, 1.01), "up", None, [[1], [2, 3]]):
            self.assertEqual(code_of(lambda: env.step(wrong)), "E-ENV-001", repr(wrong))
        # what single precision makes of 1 at most is cut; beyond that the message has every digit, and the number's name
        other = trocar.make("peg_transfer")
        other.reset(seed=1)
        above = np.full(10, np.nextafter(np.float32(1), np.float32(2)))
        self.assertGreater(above[0], 1)
        for sign in (1, -1):
            self.assertEqual(env.step(sign * above)[1], other.step(np.full(10, sign))[1])
            self.assertEqual(env.hash(), other.hash())
        good[3] = 1.00001
        with self.assertRaises(trocar.Error) as caught:
            env.step(good.astype(float).round(5))
        self.assertIn('"left.depth" of the action is 1.00001;', caught.exception.message)
        pool = trocar.make_vec("peg_transfer", 2)
        pool.reset(seed=1)
        pool.step(np.array([above, -above]))
        self.assertEqual(code_of(lambda: pool.step(np.full((2, 10), 1.00001))), "E-ENV-001")
        discrete = trocar.make("peg_transfer", actions="discrete")
        discrete.reset(seed=1)
        for wrong in ([0, 99], [-1, 0], [0.5, 0]):
            self.assertEqual(code_of(lambda: discrete.step(wrong)), "E-ENV-001", repr(wrong))
        discrete.step([1, 10])

    def test_closed(self):
        env, pool = trocar.make("peg_transfer"), trocar.make_vec("peg_transfer", 2)
        env.reset(seed=1)
        env.close()
        env.close()
        pool.close()
        for call in (env.reset, lambda: env.step(np.zeros(10)), pool.reset, lambda: pool.step(np.zeros((2, 10)))):
            self.assertEqual(code_of(call), "E-ENV-002")

    def test_pool(self):
        pool, other = trocar.make_vec("peg_transfer", 2), trocar.make_vec("peg_transfer", 2)
        self.assertEqual(code_of(lambda: pool.step(np.zeros((2, 10)))), "E-ENV-002")
        pool.reset(seed=1)
        other.reset(seed=1)  # two pools do not know each other
        for shape in ((2, 9), (1, 10), (20,)):
            self.assertEqual(code_of(lambda: pool.send(np.zeros(shape))), "E-ENV-001")
        self.assertEqual(code_of(lambda: pool.send(np.zeros((2, 10)), [0, 0])), "E-CLI-001")
        self.assertEqual(code_of(lambda: pool.send(np.zeros((1, 10)), [2])), "E-CLI-001")
        pool.send(np.zeros((2, 10)))
        self.assertEqual(code_of(lambda: pool.send(np.zeros((2, 10)))), "E-ENV-002")
        pool.recv()
        np.testing.assert_array_equal(pool.step(np.ones((2, 10)))[0].shape, other.step(np.ones((2, 10)))[0].shape)

    def test_settings(self):
        for code, settings in (("E-SCN-003", {"task": "juggling"}), ("E-SCN-003", {"actions": "wishes"}),
                               ("E-SCN-003", {"weights": {"joy": 1.0}}), ("E-CLI-001", {"layouts": -1}),
                               ("E-CLI-001", {"actions_per_second": 1000.0}), ("E-SCN-003", {"observation": "smell"})):
            with self.subTest(settings=settings):
                self.assertEqual(code_of(lambda: trocar.make(**{"task": "peg_transfer", **settings})), code)
        self.assertEqual(code_of(lambda: trocar.make_vec("peg_transfer", 0)), "E-CLI-001")


class Processes(unittest.TestCase):
    def test_fork_and_spawn_work_and_agree(self):
        expected = first_reward("peg_transfer")
        for method in ("fork", "spawn"):
            with self.subTest(method=method), multiprocessing.get_context(method).Pool(1) as workers:
                self.assertEqual(workers.apply(first_reward, ("peg_transfer",)), expected)


    def test_ctrl_c_ends_what_a_pool_does(self):
        program = ("import numpy, trocar\n"
                   "pool = trocar.make_vec('lift_and_grasp', 4, threads=2)\n"
                   "pool.reset(seed=1)\n"
                   "print('runs', flush=True)\n"
                   "try:\n"
                   "    while True:\n"
                   "        pool.step(numpy.zeros((4, 10)))\n"
                   "except KeyboardInterrupt:\n"
                   "    pool.close()\n"
                   "    print('ended', flush=True)\n")
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as child:
            self.assertEqual(child.stdout.readline(), "runs\n")
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            output, _ = child.communicate(timeout=30)
        self.assertEqual((output, child.returncode), ("ended\n", 0))

    def test_ctrl_c_ends_a_long_step(self):
        program = ("import trocar\n"
                   "simulation = trocar.Simulation('peg_transfer')\n"
                   "print('runs', flush=True)\n"
                   "simulation.step(simulation.home(), ticks=2_000_000_000)\n")
        with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
            self.assertEqual(child.stdout.readline(), "runs\n")
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            _, errors = child.communicate(timeout=30)
        self.assertIn("KeyboardInterrupt", errors)


if __name__ == "__main__":
    unittest.main()
