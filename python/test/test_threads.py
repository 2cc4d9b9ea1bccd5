# SPDX-License-Identifier: Apache-2.0
"""One thread at a time in each object: every class and every public method of the package, found by looking."""
import inspect
import os
import random
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import trocar
from trocar import _trocar

BUSY = "in the middle of another call"
UNCHANGING = {"EnvironmentModel", "Hold"}  # the first is never changed, the second is what tests hold others with


class Objects:
    """One object of every class of the compiled part, and what its methods are called with. A new class or method wants its line."""

    def __init__(self, folder):
        file = os.path.join(folder, "state")
        model = _trocar.EnvironmentModel("lift_and_grasp")
        simulation = trocar.Simulation("lift_and_grasp", metrics=True)
        environment = _trocar.Environment(model, True)
        environment.reset(1)
        camera, surgeon, other = trocar.Camera(16, 16), trocar.Surgeon("expert", simulation), trocar.Surgeon("expert", simulation)
        pool = _trocar.Pool(model, count=2)
        everyone, actions = np.empty(0, np.int32), np.zeros((2, model.action_size))
        pool.reset(everyone, [1, 2])
        pool.receive(2)
        state, action, inputs = np.zeros(model.state_size, np.float32), np.zeros(model.action_size), simulation.home()
        saved = simulation.save()
        simulation.save_file(file)
        self.all = {"Simulation": simulation, "Environment": environment, "Camera": camera, "Surgeon": surgeon, "Pool": pool,
                    "Input": simulation.home()}
        environment.reset(1)
        self.arguments = {
            "Environment.set_ranges": (model, {"mass": 1}), "Environment.restore": (environment.save(),),
            "Pool.set_ranges": (everyone, {"light": 1}), "Pool.drawn": (0,),
            "Simulation.step": (inputs,), "Simulation.play": (other, 1), "Simulation.restore": (saved,),
            "Simulation.save_file": (file + "2",), "Simulation.restore_file": (file,),
            "Environment.reset": (1,), "Environment.step": (action,), "Environment.step_by": (other, action.copy()),
            "Environment.observe": (state,), "Environment.surgeon": ("expert",),
            "Surgeon.act": (trocar.Simulation("lift_and_grasp"),),
            "Camera.draw": (simulation,), "Camera.geometry": (environment,),
            "Pool.reset": (everyone, [1, 2]), "Pool.send": (actions, everyone), "Pool.receive": (2,),
        }
        self.functions = {  # whatever else takes an object: (object, call)
            "surgeons": (simulation, lambda: trocar.surgeons(simulation)), "Surgeon": (simulation, lambda: trocar.Surgeon("expert", simulation)),
            "step": (inputs, lambda: simulation.step(inputs)), "play": (other, lambda: simulation.play(other, 1)),
            "act": (simulation, lambda: surgeon.act(simulation)), "draw": (simulation, lambda: camera.draw(simulation)), "draw of a pool": (pool, lambda: camera.draw(pool, 0)),
            "geometry": (environment, lambda: camera.geometry(environment)), "step_by": (other, lambda: environment.step_by(other, action)),
        }

    def calls(self):
        """(name, call) of every public method and property, to be read and to be set."""
        for name, thing in self.all.items():
            for member, what in vars(getattr(_trocar, name)).items():
                if member.startswith("_"):
                    continue
                where = f"{name}.{member}"
                if isinstance(what, property):
                    value = getattr(thing, member)
                    yield where, lambda thing=thing, member=member: getattr(thing, member)
                    if what.fset is not None:
                        yield where + " =", lambda thing=thing, member=member, value=value: setattr(thing, member, value)
                else:
                    yield where, lambda thing=thing, member=member, where=where: getattr(thing, member)(*self.arguments.get(where, ()))


def is_refused(call):
    """Whether another call's being there is why; whatever else becomes of a call is its own affair, but it must be Trocar's."""
    try:
        call()
    except trocar.Error as error:
        return error.code == "E-ENV-002" and BUSY in error.message
    return False


class Compiled(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.objects = Objects(folder.name)

    def test_every_class_is_here(self):
        classes = {name for name, member in vars(_trocar).items() if inspect.isclass(member)}
        self.assertEqual(classes - UNCHANGING, set(self.objects.all))

    def test_every_method_of_an_object_in_use_is_refused(self):
        count = 0
        for name, call in self.objects.calls():
            with self.subTest(call=name):
                with _trocar.Hold(self.objects.all[name.split(".")[0]]):
                    self.assertTrue(is_refused(call))
                self.assertFalse(is_refused(call))  # and only then
                count += 1
        self.assertGreater(count, 60)

    def test_so_is_an_object_that_is_handed_over(self):
        for name, (thing, call) in self.objects.functions.items():
            with self.subTest(call=name):
                with _trocar.Hold(thing):
                    self.assertTrue(is_refused(call))
                self.assertFalse(is_refused(call))

    def test_a_signal_that_comes_into_a_step_is_told_so(self):
        program = ("import signal, trocar\n"
                   "simulation = trocar.Simulation('lift_and_grasp')\n"
                   "signal.signal(signal.SIGALRM, lambda *_: simulation.step(simulation.home()))\n"
                   "signal.setitimer(signal.ITIMER_REAL, 0.2)\n"
                   "home = simulation.home()\n"
                   "try:\n"
                   "    simulation.step(home, ticks=2_000_000_000)\n"
                   "except trocar.Error as error:\n"
                   "    print(error.code)\n"
                   "simulation.step(home)\n")
        done = subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True, timeout=60, check=True)
        self.assertEqual(done.stdout, "E-ENV-002\n")

    def test_readers_go_side_by_side(self):
        simulation, wrong = trocar.Simulation("lift_and_grasp"), []
        home, others = simulation.home(), [trocar.Simulation("lift_and_grasp") for _ in range(2)]

        def draw():
            camera = trocar.Camera(32, 32)
            first = camera.draw(simulation)
            if any((camera.draw(simulation) != first).any() for _ in range(20)):
                wrong.append("a picture")

        def step(other):
            for _ in range(20):
                other.step(home)

        calls = [draw, draw] + [lambda other=other: step(other) for other in others]
        threads = [threading.Thread(target=self.note(call, wrong)) for call in calls]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])
        self.assertEqual(others[0].hash(), others[1].hash())

    @staticmethod
    def note(call, wrong):
        def noted():
            try:
                call()
            except Exception as error:
                wrong.append(repr(error))
        return noted


class Wrapped(unittest.TestCase):
    def test_every_class_is_guarded(self):
        classes = {name for name in trocar.__all__ if inspect.isclass(getattr(trocar, name))}
        compiled = {name for name in classes if issubclass(getattr(trocar, name), getattr(_trocar, name, ()))}
        self.assertEqual(classes - compiled - {"Error"}, set(self.all()) | set(self.adapters()))

    @staticmethod
    def all():
        return {"Environment": trocar.make("lift_and_grasp", observation="mixture", render_mode="rgb_array", metrics=True),
                "VectorEnvironment": trocar.make_vec("lift_and_grasp", 2), "ParallelEnvironment": trocar.make_parallel("lift_and_grasp")}

    @staticmethod
    def adapters():
        return {"StableBaselinesVecEnv": trocar.make_sb3("lift_and_grasp", 2), "RlGamesVecEnv": trocar.make_rl_games("lift_and_grasp", 2),
                "CleanRlVectorEnvironment": trocar.make_cleanrl("lift_and_grasp", 2)}

    def test_every_method_of_an_object_in_use_is_refused(self):
        for name, thing in (self.all() | self.adapters()).items():
            holds, ends = threading.Event(), threading.Event()

            def hold():
                with thing._turn:
                    holds.set()
                    ends.wait()

            other = threading.Thread(target=hold)
            other.start()
            holds.wait()
            members = [member for member in dir(type(thing)) if not member.startswith("_") and member in vars(type(thing))]
            for member in members:
                what = inspect.getattr_static(type(thing), member)
                with self.subTest(call=f"{name}.{member}"):
                    if isinstance(what, property):
                        self.assertTrue(is_refused(lambda: getattr(thing, member)))
                        if what.fset is not None:
                            self.assertTrue(is_refused(lambda: setattr(thing, member, None)))
                    elif inspect.isfunction(what):
                        self.assertTrue(is_refused(getattr(thing, member)))
            ends.set()
            other.join()
            self.assertFalse(is_refused(thing.reset))
            self.assertGreater(len(members), 6 if name in self.all() else 1)

    def test_what_a_thread_gets_belongs_together(self):
        """Without a turn for the whole of a step, one thread would see the state after another one's action."""
        env, seen, wrong = trocar.make("lift_and_grasp", actions_per_second=120), [], []
        env.reset(seed=1)
        field = next(f for f in env.state_fields if f["name"] == "time")

        def go():
            end = time.time() + 1
            while time.time() < end:
                try:
                    seen.append(env.step(np.zeros(10))[0][field["first"]])
                except trocar.Error as error:
                    if BUSY not in error.message:
                        wrong.append(str(error))
                        return

        threads = [threading.Thread(target=go) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])
        self.assertEqual(len(seen), len(set(seen)))  # each moment once


def hammer(seconds, seed):
    """Every method of every object from several threads at a time. (calls that were done, calls that were refused, what else came)"""
    with tempfile.TemporaryDirectory() as folder:
        calls = list(Objects(folder).calls())
        for thing in Wrapped.all().values():
            thing.reset(seed=1)
            calls += [(f"{type(thing).__name__}.reset", thing.reset)]
            if not isinstance(thing, trocar.ParallelEnvironment):
                calls += [(f"{type(thing).__name__}.step", lambda thing=thing: thing.step(np.zeros(thing.action_space.shape)))]
        counts, wrong, end = {"done": 0, "refused": 0}, [], time.time() + seconds

        def go(mine):
            while time.time() < end:
                name, call = mine.choice(calls)
                try:
                    counts["refused" if is_refused(call) else "done"] += 1
                except Exception as error:
                    wrong.append(f"{name}: {error!r}")

        threads = [threading.Thread(target=go, args=(random.Random(seed + i),)) for i in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return counts["done"], counts["refused"], wrong


class Hammered(unittest.TestCase):
    def test_nothing_ends_the_process(self):
        program = ("import faulthandler, test_threads\n"
                   "faulthandler.enable()\n"
                   "done, refused, wrong = test_threads.hammer(6, 1)\n"
                   "print(done, refused, len(wrong), *wrong[:5])\n")
        done = subprocess.run([sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200,
                              cwd=os.path.dirname(os.path.abspath(__file__)))
        self.assertEqual(done.returncode, 0, done.stderr)
        calls, refused, wrong = (int(word) for word in done.stdout.split()[:3])
        self.assertEqual(wrong, 0, done.stdout)
        self.assertGreater(calls, 100)
        self.assertGreater(refused, 20)


if __name__ == "__main__":
    unittest.main()
