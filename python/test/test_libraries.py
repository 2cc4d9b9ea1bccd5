# SPDX-License-Identifier: Apache-2.0
"""Gymnasium's registry, Stable-Baselines3's VecEnv, rl_games' IVecEnv and CleanRL's infos, against stand-ins of their interfaces."""
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np

import trocar

STANDINS = pathlib.Path(__file__).parent / "standins"


def with_standins(program):
    """Runs a program that finds the stand-ins; its output."""
    paths = os.pathsep.join([str(STANDINS), os.environ.get("PYTHONPATH", "")])
    ran = subprocess.run([sys.executable, "-W", "error", "-c", program], env={**os.environ, "PYTHONPATH": paths}, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


class Gymnasium(unittest.TestCase):
    def test_every_environment_has_a_name_there(self):
        output = with_standins("""
import gymnasium, numpy, trocar
assert issubclass(trocar.Environment, gymnasium.Env) and issubclass(trocar.VectorEnvironment, gymnasium.vector.VectorEnv)
names = sorted(name for name in gymnasium.registry if name.startswith("trocar/"))
assert names == sorted(map(trocar.environment_id, trocar.environments())), names
for name in names:
    if "Cholecystectomy" in name:
        continue
    env = gymnasium.make(name, actions="tip")
    trocar.check_env(env, steps=1)
    assert env.spec.id == name and env.spec.kwargs["actions"] == "tip" and env.spec.version == 0
    again = gymnasium.make(env.spec.id, **env.spec.kwargs)  # a spec says all that is wanted to make one more
    numpy.testing.assert_array_equal(env.reset(seed=4)[0], again.reset(seed=4)[0])
pool = gymnasium.make_vec("trocar/PegTransfer-v0", num_envs=2, render_mode="rgb_array", render_size=(48, 32))
trocar.check_vector_env(pool, steps=2)
assert pool.spec.kwargs["num_envs"] == 2
pictures = pool.render()
assert isinstance(pictures, tuple) and [picture.shape for picture in pictures] == [(32, 48, 3)] * 2
print(*names)
""")
        self.assertIn("trocar/PegTransfer-v0", output.split())
        self.assertIn("trocar/CameraNavigation30-v0", output.split())

    def test_a_module_in_the_name_is_enough(self):
        self.assertEqual(with_standins("import gymnasium; print(gymnasium.make('trocar:trocar/WireRun-v0').spec.name)"), "WireRun\n")

    def test_spec_is_there_without_gymnasium_too(self):
        env = trocar.make("lift_and_grasp", actions="tip", most_seconds=3.0)
        self.assertEqual((env.spec.id, env.spec.name, env.spec.kwargs), ("trocar/LiftAndGrasp-v0", "LiftAndGrasp", {"task": "lift_and_grasp", "actions": "tip", "most_seconds": 3.0}))
        self.assertIsNone(trocar.make(str(trocar.find("lift_and_grasp"))).spec)
        self.assertEqual(trocar.make_vec("lift_and_grasp", 2).spec.kwargs["num_envs"], 2)


SB3 = """
import numpy, trocar
env = trocar.make_sb3("lift_and_grasp", 3, observation="scaled", actions="tip", most_seconds=0.3, render_mode="rgb_array", render_size=(40, 24))
"""


class StableBaselines(unittest.TestCase):
    def test_is_a_vec_env(self):
        with_standins("from stable_baselines3.common.vec_env import VecEnv\n" + SB3 + """
assert isinstance(env, VecEnv) and env.metadata["render_modes"] == ["human", "rgb_array"]
assert env.get_attr("render_mode", 1) == ["rgb_array"] and env.get_attr("task", [0, 2]) == ["lift_and_grasp"] * 2
""")

    def test_episodes_end_as_it_wants(self):
        env = trocar.make_sb3("lift_and_grasp", 3, observation="scaled", actions="tip", most_seconds=0.3)
        self.assertEqual(env.seed(5), [5, 6, 7])
        first = env.reset()
        self.assertEqual((first.shape, first.dtype), ((3, env.observation_space.shape[0]), np.float32))
        self.assertEqual([info["seed"] for info in env.reset_infos], [5, 6, 7])
        total = np.zeros(3)
        for step in range(3):
            seen, rewards, dones, infos = env.step(np.full((3, 10), 7.0))  # its algorithms clip, its users forget to
            total += rewards
            self.assertEqual((rewards.dtype, dones.dtype, len(infos)), (np.float32, bool, 3))
            self.assertEqual(dones.tolist(), [step == 2] * 3)
        for i, info in enumerate(infos):
            self.assertTrue(info["TimeLimit.truncated"])
            self.assertIn(info["terminal_observation"], env.observation_space)
            self.assertAlmostEqual(info["terminal_observation"][-1], 1, places=5)
            self.assertFalse((info["terminal_observation"] == seen[i]).all())
            self.assertAlmostEqual(info["episode"]["r"], total[i], places=5)
            self.assertEqual(info["episode"]["l"], 3)
        self.assertNotIn("episode", env.step(np.zeros((3, 10)))[3][0])

    def test_options_are_of_the_next_reset(self):
        env = trocar.make_sb3("lift_and_grasp", 2)
        env.set_options({"friction": 0.5})
        env.reset()
        self.assertEqual([info["layout"] > 0 for info in env.reset_infos], [True, True])
        self.assertEqual([env.pool._pool.drawn(i)["friction"] for i in range(2)], [0.5, 0.5])
        env.set_options([{"mass": 2.0}, {"mass": 3.0}])
        env.reset()
        self.assertEqual([env.pool._pool.drawn(i)["mass"] for i in range(2)], [2, 3])

    def test_pictures(self):
        env = trocar.make_sb3("lift_and_grasp", 2, render_mode="rgb_array", render_size=(40, 24))
        env.reset()
        self.assertEqual([image.shape for image in env.get_images()], [(24, 40, 3)] * 2)


class RlGames(unittest.TestCase):
    def test_is_registered_and_made(self):
        with_standins("""
import numpy, trocar
from rl_games.common import vecenv
from rl_games.common.ivecenv import IVecEnv
trocar.register_rl_games()
env = vecenv.create_vec_env("trocar", 3, task="peg_transfer", actions="tip", observation="scaled", most_seconds=0.2, seed=4)
assert isinstance(env, IVecEnv)
info = env.get_env_info()
assert set(info) >= {"action_space", "observation_space", "state_space", "use_global_observations", "agents", "value_size"}
first = env.reset()
assert first.shape == (3, *info["observation_space"].shape)
class Tensor:  # as torch's
    def detach(self): return self
    def cpu(self): return self
    def numpy(self): return numpy.full((3, 10), 2.0)
observations, rewards, dones, infos = env.step(Tensor())
assert not dones.any() and rewards.dtype == numpy.float32
observations, rewards, dones, infos = env.step(Tensor())
assert dones.all() and infos["time_outs"].all()
""")


class CleanRl(unittest.TestCase):
    def test_infos_have_what_its_scripts_print(self):
        envs = trocar.make_cleanrl("peg_transfer", 2, most_seconds=0.2)
        envs.reset(seed=1)
        _, first, *_, infos = envs.step(np.full((2, 10), 3.0))
        self.assertNotIn("final_info", infos)
        _, second, terminations, truncations, infos = envs.step(np.zeros((2, 10)))
        over = np.nonzero(infos["final_info"]["_episode"])[0]
        self.assertEqual(over.tolist(), [0, 1])
        np.testing.assert_allclose(infos["final_info"]["episode"]["r"][over], first + second)
        self.assertEqual(infos["final_info"]["episode"]["l"].tolist(), [2, 2])
        self.assertTrue(np.logical_or(terminations, truncations).all())

    def test_infos_of_older_scripts(self):
        envs = trocar.make_cleanrl("peg_transfer", 2, form="0.29", most_seconds=0.1)
        envs.reset(seed=1)
        infos = envs.step(np.zeros((2, 10)))[-1]
        for info in infos["final_info"]:
            self.assertEqual((info["episode"]["l"], info["episode"]["r"].shape), (np.array([1]), (1,)))
        self.assertEqual(infos["final_observation"][0].shape, envs.single_observation_space.shape)
        with self.assertRaises(trocar.Error):
            trocar.make_cleanrl("peg_transfer", 2, form="2")


if __name__ == "__main__":
    unittest.main()
