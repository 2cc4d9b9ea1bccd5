# SPDX-License-Identifier: Apache-2.0
"""A child of fork: what works there, what is refused, and that nothing waits for threads that did not come along."""
import argparse
import hashlib
import inspect
import multiprocessing
import os
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import trocar

TASK = "lift_and_grasp"
PICTURES = {"observation": "mixture", "picture_size": (16, 16)}
REFUSED = "E-ENV-002"
MOST_SECONDS = 60.0  # a child that takes longer waits for ever


def zeros(env):
    return np.zeros(env.action_space.shape, np.float32)


class Parent:
    """One object of every kind, each used before the fork; the pool is at work in it."""

    def __init__(self):
        self.simulation, self.threaded = trocar.Simulation(TASK), trocar.Simulation("clip_and_cut", threads=3)
        self.threaded.step(self.threaded.home(), 2)
        self.surgeon, self.inputs = trocar.Surgeon("expert", self.simulation), self.simulation.home()
        self.simulation.play(self.surgeon, 10)
        self.camera = trocar.Camera(16, 16)
        self.camera.draw(self.simulation)
        self.states, self.pictures, self.shown = trocar.make(TASK), trocar.make(TASK, **PICTURES), trocar.make(TASK, render_mode="rgb_array")
        self.agents = trocar.make_parallel(TASK)
        self.pool, self.drawn_pool = trocar.make_vec(TASK, 3, threads=2, render_mode="rgb_array"), trocar.make_vec(TASK, 2, threads=2, **PICTURES)
        for env in (self.states, self.pictures, self.shown, self.agents, self.pool, self.drawn_pool):
            env.reset(seed=1)
        self.shown.render()
        self.pool.send(zeros(self.pool))

    def end(self):
        self.pool.recv()


def begin(env):
    env.reset(seed=1)
    return env.step(zeros(env))[1]


# what a child does with the parent's objects, or with new ones: (what, whether it can)
CASES = {
    "Simulation": (lambda p: p.simulation.step(p.inputs, 3), True),
    "Simulation, with threads": (lambda p: p.threaded.step(p.threaded.home(), 3), True),
    "Simulation, new": (lambda p: trocar.Simulation(TASK).step(p.inputs, 3), True),
    "Simulation, new, with threads": (lambda p: trocar.Simulation("clip_and_cut", threads=3).step(p.threaded.home(), 3), True),
    "Simulation, new, patient": (lambda p: trocar.Simulation("cholecystectomy", patient={"seed": 2}).hash(), True),
    "Surgeon": (lambda p: p.simulation.play(p.surgeon, 3), True),
    "Input": (lambda p: setattr(p.inputs, "hands", p.inputs.hands), True),
    "Camera": (lambda p: p.camera.draw(p.simulation), False),
    "Camera, geometry": (lambda p: p.camera.geometry(p.simulation, flow=True), False),
    "Camera, new": (lambda p: trocar.Camera(16, 16), False),
    "Environment": (lambda p: begin(p.states), True),
    "Environment, new": (lambda p: begin(trocar.make(TASK, layouts=2)), True),
    "Environment, pictures": (lambda p: begin(p.pictures), False),
    "Environment, new, pictures": (lambda p: begin(trocar.make(TASK, **PICTURES)), False),
    "Environment, render": (lambda p: p.shown.render(), False),
    "ParallelEnvironment": (lambda p: p.agents.reset(seed=1), True),
    "VectorEnvironment": (lambda p: p.pool.reset(seed=1), False),
    "VectorEnvironment, recv": (lambda p: p.pool.recv(), False),
    "VectorEnvironment, send": (lambda p: p.pool.send(zeros(p.pool)), False),
    "VectorEnvironment, step": (lambda p: p.drawn_pool.step(zeros(p.drawn_pool)), False),
    "VectorEnvironment, new": (lambda p: begin(trocar.make_vec(TASK, 2)), True),
    "Environment, clone": (lambda p: begin(p.states.clone()), True),
    "VectorEnvironment, render": (lambda p: p.pool.render(), False),
    "StableBaselinesVecEnv, new": (lambda p: trocar.make_sb3(TASK, 2).reset(), True),
    "RlGamesVecEnv, new": (lambda p: trocar.make_rl_games(TASK, 2).reset(), True),
    "CleanRlVectorEnvironment, new": (lambda p: trocar.make_cleanrl(TASK, 2).reset(), True),
    "VectorEnvironment, new, pictures": (lambda p: begin(trocar.make_vec(TASK, 2, **PICTURES)), False),
}


class Said(str):
    """What a call has to tell of its child."""


def answer(call, parent):
    try:
        said = call(parent)
    except trocar.Error as error:
        return error.code
    return said if isinstance(said, Said) else "done"


def run_forked(call, parent, ends_like_a_program):
    """What a child of os.fork comes to, and how it ends; None where it takes too long."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        try:
            said = answer(call, parent)
        except BaseException as error:
            said = repr(error)
        os.write(writer, said.encode())
        os.close(writer)
        if not ends_like_a_program:
            os._exit(0)
        parent.__dict__.clear()  # with what it holds
        sys.exit(0)
    os.close(writer)
    said, end, status = b"", time.monotonic() + MOST_SECONDS, None
    while time.monotonic() < end and status is None:
        if select.select([reader], [], [], 0.1)[0]:
            said += os.read(reader, 4096)
        pid, ended = os.waitpid(child, os.WNOHANG)
        status = ended if pid else None
    if status is None:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    os.close(reader)
    return said.decode(), None if status is None else os.waitstatus_to_exitcode(status)


class Forked(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.parent = Parent()
        cls.addClassCleanup(cls.parent.end)

    def test_every_class_is_here(self):
        classes = {name for name in trocar.__all__ if inspect.isclass(getattr(trocar, name))}
        self.assertEqual({name.split(",")[0] for name in CASES}, classes - {"Error"})

    def test_children_of_fork_do_it_or_are_told(self):
        for name, (call, can) in CASES.items():
            with self.subTest(case=name):
                self.assertEqual(run_forked(call, self.parent, False), ("done" if can else REFUSED, 0))

    def test_children_of_multiprocessing_do_it_or_are_told(self):
        context = multiprocessing.get_context("fork")
        for name, (call, can) in CASES.items():
            with self.subTest(case=name):
                answers = context.SimpleQueue()
                child = context.Process(target=lambda: answers.put(answer(call, self.parent)))
                child.start()
                child.join(MOST_SECONDS)
                if child.is_alive():
                    child.kill()
                self.assertEqual(child.exitcode, 0)
                self.assertEqual(answers.get(), "done" if can else REFUSED)


def steps_of_a_simulation(simulation, count):
    """One call a tick, so that each begins and ends the work of its threads."""
    inputs = simulation.home()
    home = np.array(inputs.hands)
    for i in range(count):
        inputs.hands = home + 0.02 * np.sin(0.1 * i)
        simulation.step(inputs, 1)
    return Said(simulation.hash())


def steps_of_a_pool(count, threads):
    pool = trocar.make_vec(TASK, 8, threads=threads)
    pool.reset(seed=3)
    actions = np.random.default_rng(5).uniform(-1, 1, (count, *pool.action_space.shape)).astype(np.float32)
    digest = hashlib.sha256()
    for action in actions:
        digest.update(np.asarray(pool.step(action)[0]).tobytes())
    return Said(digest.hexdigest())


def steps_of_an_environment(env, count):
    actions = np.random.default_rng(7).uniform(-1, 1, (count, *env.action_space.shape)).astype(np.float32)
    digest = hashlib.sha256()
    env.reset(seed=4)
    for action in actions:
        observation, _, ended, cut, _ = env.step(action)
        digest.update(np.asarray(observation).tobytes())
        if ended or cut:
            env.reset()
    return Said(digest.hexdigest())


class Work(unittest.TestCase):
    """A child does not only begin: it goes on for long, and comes to the parent's bits."""

    def check(self, call, parent=None):
        self.assertEqual(run_forked(call, parent, False), (call(parent), 0))

    def test_a_simulation_of_four_threads_goes_on_in_a_child(self):
        simulation = trocar.Simulation("clip_and_cut", threads=4)
        simulation.step(simulation.home(), 5)
        self.check(lambda _: steps_of_a_simulation(simulation, 40))

    def test_a_thousand_steps_in_a_child(self):
        simulation, env = trocar.Simulation(TASK, threads=4), trocar.make(TASK)
        simulation.step(simulation.home(), 1)
        env.reset(seed=1)
        self.check(lambda _: steps_of_a_simulation(simulation, 1000))
        self.check(lambda _: steps_of_an_environment(env, 1000))

    def test_environments_of_four_threads_made_in_a_child(self):
        pool = trocar.make_vec(TASK, 8, threads=4)  # its threads stay behind
        pool.reset(seed=1)
        pool.step(zeros(pool))
        self.assertEqual(run_forked(lambda _: steps_of_a_pool(50, 4), None, False), (steps_of_a_pool(50, 1), 0))


class Patients(unittest.TestCase):
    def test_a_child_leaves_its_parents_patient(self):
        folder = Path(tempfile.mkdtemp())  # the test's own: others make patients at the same time
        self.addCleanup(shutil.rmtree, folder)
        self.enterContext(unittest.mock.patch.dict(os.environ, TMPDIR=str(folder)))
        parent = argparse.Namespace(ill=trocar.Simulation("cholecystectomy", patient={"seed": 2}))
        made = list(folder.glob("trocar-patient-*"))
        self.assertEqual(len(made), 1)
        self.assertEqual(run_forked(lambda p: vars(p).clear(), parent, False), ("done", 0))
        self.assertTrue(made.pop().is_dir())


class AsAProgram(unittest.TestCase):
    def test_children_end_as_programs_do(self):
        """Destructors, and what libraries do at a process's end. In a program of its own: unittest would go on in the child."""
        program = ("import sys, test_fork\n"
                   "parent = test_fork.Parent()\n"
                   "for name in sys.argv[1:]:\n"
                   "    print(name, *test_fork.run_forked(test_fork.CASES[name][0], parent, True), sep='|', flush=True)\n"
                   "parent.end()\n")
        done = subprocess.run([sys.executable, "-c", program, *CASES], stdout=subprocess.PIPE, text=True, timeout=280, check=True,
                              cwd=os.path.dirname(os.path.abspath(__file__)))
        found = dict(line.split("|", 1) for line in done.stdout.splitlines())
        self.assertEqual(found, {name: f"{'done' if can else REFUSED}|0" for name, (_, can) in CASES.items()})

    def test_the_message_says_what_to_do(self):
        trocar.Camera(16, 16)
        for call in (CASES["Camera, new"][0], lambda _: trocar.make(TASK, **PICTURES).reset(seed=1)):
            reader, writer = os.pipe()
            child = os.fork()
            if child == 0:
                try:
                    call(None)
                except trocar.Error as error:
                    os.write(writer, str(error).encode())
                os._exit(0)
            os.waitpid(child, 0)
            said = os.read(reader, 4096).decode()
            os.close(reader)
            os.close(writer)
            self.assertIn("fork", said)
            self.assertIn("spawn", said)
            self.assertNotIn("update", said)


if __name__ == "__main__":
    unittest.main()
