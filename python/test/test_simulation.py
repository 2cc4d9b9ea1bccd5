# SPDX-License-Identifier: Apache-2.0
"""The package's simulation: the same bits as the program's, state, read-outs, pictures, errors."""
import copy
import gc
import json
import os
import pickle
import shutil
import subprocess
import tempfile
import threading
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import trocar

ROOT = Path(__file__).resolve().parents[2]
RETRACTION = str(ROOT / "scenes/retraction.json")


def program(*arguments):
    """What the command prints as JSON."""
    environment = {**os.environ, "TROCAR_DATA_DIR": str(ROOT)}
    done = subprocess.run([os.environ["TROCAR_PROGRAM"], *arguments, "--json"], stdout=subprocess.PIPE, check=True,
                          env=environment)
    return json.loads(done.stdout)


class SameBits(unittest.TestCase):
    def test_script_gives_the_programs_hash(self):
        simulation = trocar.Simulation(RETRACTION, seed=0)
        simulation.step_script(40)
        self.assertEqual(simulation.hash(), program("simulate", RETRACTION, "--seed", "0", "--ticks", "40")["hash"])

    def test_surgeon_gives_the_programs_hash(self):
        simulation = trocar.Simulation("lift_and_grasp", seed=3)
        surgeon = trocar.Surgeon("expert", simulation, seed=3)
        simulation.play(surgeon, 120 * 600)
        self.assertTrue(surgeon.has_finished)
        self.assertEqual(simulation.hash(), program("play", "expert", "--task", "lift_and_grasp", "--seed", "3")["hash"])
        self.assertEqual(simulation.snapshot()["task"]["phase"], "completed")

    def test_inputs_through_python_give_the_same_bits(self):
        within, through = (trocar.Simulation("peg_transfer") for _ in range(2))
        surgeons = [trocar.Surgeon("novice", simulation) for simulation in (within, through)]
        within.play(surgeons[0], 60)
        for _ in range(60):
            acted = surgeons[1].act(through)
            copied = through.home()
            copied.hands, copied.laparoscope = acted.hands, acted.laparoscope
            copied.cut, copied.coagulate, copied.tools = acted.cut, acted.coagulate, acted.tools
            through.step(copied)
        self.assertEqual(within.hash(), through.hash())


class State(unittest.TestCase):
    def test_restored_state_goes_on_to_the_same_bits(self):
        simulation = trocar.Simulation("peg_transfer")
        begin = simulation.home()
        begin.hands = begin.hands + np.array([[0.05, 0, 0, 0.01, 0], [0, 0.05, 0, 0, 0.2]])
        simulation.step(begin, 20)
        state, before = simulation.save(), simulation.hash()
        simulation.step(begin, 20)
        after = simulation.hash()
        self.assertNotEqual(before, after)
        simulation.restore(state)
        self.assertEqual(simulation.hash(), before)
        with tempfile.TemporaryDirectory() as folder:
            simulation.save_file(Path(folder) / "state")
            simulation.restore_file(Path(folder) / "state")
        simulation.step(begin, 20)
        self.assertEqual(simulation.hash(), after)

    def test_damaged_state_is_refused(self):
        simulation = trocar.Simulation("peg_transfer")
        state = bytearray(simulation.save())
        state[len(state) // 2] ^= 1
        before = simulation.hash()
        with self.assertRaises(trocar.Error) as caught:
            simulation.restore(bytes(state))
        self.assertEqual(caught.exception.code, "E-SIM-006")
        self.assertEqual(simulation.hash(), before)


class Texts(unittest.TestCase):
    def test_names_in_errors_stay_within_their_line(self):
        for name in ("x\nFORGED: all is well", "x\x1b[2J", "x\u202e", "x\x9b"):
            for make in (trocar.Simulation, trocar.Environment, lambda scene: trocar.Simulation("cholecystectomy", patient=scene)):
                with self.assertRaises(trocar.Error) as caught:
                    make(name)
                self.assertTrue(str(caught.exception).isprintable(), repr(str(caught.exception)))
                self.assertTrue(caught.exception.message.isprintable())


class ReadOuts(unittest.TestCase):
    def test_forces_and_contacts_say_which_organ(self):
        simulation = trocar.Simulation(RETRACTION, seed=0)
        touched = set()
        for _ in range(40):  # the left hand comes to the fundus after five seconds
            simulation.step_script(18)
            for tool in simulation.snapshot()["instruments"].values():
                if tool["is_touching"] and tool["surface"]:
                    touched.add(tool["surface"])
                    self.assertGreater(np.linalg.norm(tool["force"]) + tool["pinch"], 0)
        self.assertTrue(touched, "no tool touched an organ in six seconds of retraction")
        names = [surface["name"] for surface in simulation.surfaces()]
        self.assertLessEqual(touched, set(names))

    def test_positions_belong_to_surfaces(self):
        simulation = trocar.Simulation(RETRACTION, seed=0)
        positions = simulation.positions()
        self.assertEqual(positions.shape[1], 3)
        self.assertEqual(sum(surface["node_count"] for surface in simulation.surfaces()), len(positions))
        self.assertTrue(np.isfinite(positions).all())

    def test_operation_says_what_its_critical_view_lacks(self):
        simulation = trocar.Simulation("cholecystectomy")
        simulation.step(simulation.home(), 2)
        view = simulation.critical_view()
        self.assertFalse(view["is_achieved"])
        self.assertTrue(view["missing"])
        self.assertEqual(simulation.snapshot()["operation"]["phase"], "Preparation")
        self.assertEqual(simulation.errors(), [])
        self.assertIsNone(trocar.Simulation("peg_transfer").critical_view())


class Metrics(unittest.TestCase):
    def values(self, simulation):
        return {(m["metric"], m.get("hand")): m["value"] for m in simulation.metrics() if "phase" not in m and "tool" not in m}

    def test_a_straight_way_has_its_length_and_time(self):
        simulation = trocar.Simulation("instrument_navigation", metrics=True)
        begin, tip = simulation.home(), lambda: simulation.snapshot()["instruments"]["left"]["pose"][:3, 3]
        first, hands = tip(), begin.hands
        for tick in range(120):
            hands[0, 3] += 0.02 / 120  # along its shaft
            begin.hands = hands
            simulation.step(begin)
        values = self.values(simulation)
        way = np.linalg.norm(tip() - first)
        self.assertGreater(way, 0.01)
        self.assertAlmostEqual(values["path_length", "left"], way, delta=0.03 * way)
        self.assertLess(values.get(("path_length", "right"), 0.0), 0.001)
        self.assertAlmostEqual(values["time", None], 1.0, delta=0.02)
        simulation.reset()
        self.assertLess(self.values(simulation).get(("path_length", "left"), 0.0), 1e-6)

    def test_are_the_programs_own_of_the_recording(self):
        with tempfile.TemporaryDirectory() as folder:
            recording = str(Path(folder) / "attempt.trocar")
            program("play", "expert", "--task", "instrument_navigation", "--seed", "2", "--record", recording)
            written = program("metrics", recording)["metrics"]
        simulation = trocar.Simulation("instrument_navigation", seed=2, metrics=True)
        simulation.play(trocar.Surgeon("expert", simulation, seed=2), 120 * 600)
        self.assertEqual(simulation.metrics(), written)

    def test_are_collected_where_they_are_wanted_only(self):
        with self.assertRaises(trocar.Error) as caught:
            trocar.Simulation("peg_transfer").metrics()
        self.assertEqual(caught.exception.code, "E-ENV-002")


class Dictionaries(unittest.TestCase):
    def test_a_task_is_what_its_file_holds(self):
        file = trocar.find("peg_transfer")
        task = json.loads(file.read_text())
        given, named = trocar.Simulation(task, folder=str(file.parent), seed=3), trocar.Simulation("peg_transfer", seed=3)
        self.assertEqual(given.hash(), named.hash())
        task["scene"]["objects"][0]["at_mm"][2] += 3  # the others are sums of parameters
        self.assertNotEqual(trocar.Simulation(task, seed=3).hash(), named.hash())

    def test_a_scene_with_a_patient_starts_from_its_folder(self):
        scene = json.loads(Path(RETRACTION).read_text())
        scene["settings"]["gravity_m_s2"] = 0
        simulation = trocar.Simulation(scene, folder=str(ROOT / "scenes"))
        self.assertEqual(simulation.name, scene["name"])
        with self.assertRaises(trocar.Error):
            trocar.Simulation(scene, folder=str(ROOT))

    def test_a_patient_is_generated(self):
        folder = Path(tempfile.mkdtemp())  # the test's own: others make patients at the same time
        self.addCleanup(shutil.rmtree, folder)
        self.enterContext(unittest.mock.patch.dict(os.environ, TMPDIR=str(folder)))
        usual, ill = (trocar.Simulation("cholecystectomy", patient={"seed": 5, "set": {"acute_cholecystitis": level}})
                      for level in (0, 0.5))
        self.assertNotEqual(usual.hash(), trocar.Simulation("cholecystectomy").hash())
        usual.step(usual.home(), 2), ill.step(ill.home(), 2)
        self.assertNotEqual(usual.hash(), ill.hash())
        self.assertEqual(len(list(folder.glob("trocar-patient-*"))), 2)
        del usual, ill
        gc.collect()
        self.assertEqual(list(folder.glob("trocar-patient-*")), [])

    def test_environments_take_them(self):
        file = trocar.find("peg_transfer")
        task = json.loads(file.read_text())
        with trocar.make(task, folder=str(file.parent)) as given, trocar.make("peg_transfer") as named:
            given.reset(seed=1), named.reset(seed=1)
            self.assertEqual(given.hash(), named.hash())
        with trocar.make("cholecystectomy", patient={"seed": 2}, layouts=2) as environment:
            environment.reset(seed=1)
            environment.step(np.zeros(environment.action_space.shape))

    def test_what_is_wrong_is_said(self):
        task = json.loads(trocar.find("peg_transfer").read_text())
        task["scene"]["objects"][0]["mass_g"] = -1
        for wrong, code, word in ((task, "E-SCN-", "mass_g"), ({1, 2}, "E-CLI-001", "dictionary"), ({"a": float("nan")}, "E-CLI-001", "JSON")):
            with self.assertRaises(trocar.Error) as caught:
                trocar.Simulation(wrong)
            self.assertIn(word, str(caught.exception))
            self.assertTrue(caught.exception.code.startswith(code) or code == "E-SCN-", caught.exception.code)
        # in a scene to look at an environment has nothing to do
        scene = json.loads(Path(RETRACTION).read_text())
        for nothing in (RETRACTION, scene):
            with self.assertRaises(trocar.Error):
                trocar.make(nothing, folder=str(ROOT / "scenes"))
        for wrong in (5, {"sead": 1}, {"seed": "five"}):
            with self.assertRaises(trocar.Error) as caught:
                trocar.Simulation("cholecystectomy", patient=wrong)
            self.assertEqual(caught.exception.code, "E-CLI-001")
        with self.assertRaises(trocar.Error):
            trocar.Simulation("cholecystectomy", patient={"set": {"kidney": 1}})


    def test_numbers_of_numpy_are_numbers(self):
        file = trocar.find("peg_transfer")
        usual, other = json.loads(file.read_text()), json.loads(file.read_text())
        usual["scene"]["objects"][0]["mass_g"], usual["scene"]["objects"][0]["at_mm"] = 2.5, [10.0, 0.0, 3.0]
        for number in (np.float32(2.5), np.float64(2.5), np.array(2.5), np.float16(2.5)):
            other["scene"]["objects"][0]["mass_g"] = number
            other["scene"]["objects"][0]["at_mm"] = np.array([10, 0, 3], np.int64)
            self.assertEqual(trocar.Simulation(other, folder=file.parent).hash(), trocar.Simulation(usual, folder=str(file.parent)).hash())
        for patient in ({"seed": np.int64(5), "set": {"acute_cholecystitis": np.float32(0.5)}}, {"seed": np.array(5), "set": {"acute_cholecystitis": np.array(0.5)}}):
            self.assertEqual(trocar.Simulation("cholecystectomy", patient=patient).hash(),
                             trocar.Simulation("cholecystectomy", patient={"seed": 5, "set": {"acute_cholecystitis": 0.5}}).hash())
        weights = {"path": np.float32(3), "time": np.int8(-2)}
        with trocar.make("peg_transfer", weights=weights) as given, trocar.make("peg_transfer", weights={"path": 3.0, "time": -2.0}) as usual:
            given.reset(seed=1), usual.reset(seed=1)
            self.assertEqual(given.step(np.full(10, 0.5))[1], usual.step(np.full(10, 0.5))[1])
        with trocar.make("peg_transfer", seed=np.int64(3), layouts=np.int32(2), actions_per_second=np.float32(10), most_seconds=np.float64(3),
                         moves_camera=np.bool_(True), picture_size=np.array([24, 16]), observation="masks") as environment:
            self.assertEqual(environment.observation_space.shape, (16, 24))
        self.assertEqual(trocar.Simulation("peg_transfer", seed=np.uint64(3), threads=np.int8(1)).hash(), trocar.Simulation("peg_transfer", seed=3).hash())

    def test_what_is_no_json_is_named(self):
        def task(value, where="mass_g"):
            task = json.loads(trocar.find("peg_transfer").read_text())
            task["scene"]["objects"][0][where] = value
            return task

        loop = task(1)
        loop["scene"]["more"] = loop
        for wrong, field in ((task(np.float32("nan")), "scene.objects[0].mass_g is nan"), (task(np.array([1.0, np.inf]), "at_mm"), "scene.objects[0].at_mm[1] is inf"),
                             (task({1}), "scene.objects[0].mass_g is {1} (set)"), (task(np.complex64(1)), "scene.objects[0].mass_g"),
                             (task({5: 1}), "a key of scene.objects[0].mass_g is 5"), (loop, "holds itself")):
            with self.assertRaises(trocar.Error) as caught:
                trocar.Simulation(wrong)
            self.assertEqual(caught.exception.code, "E-CLI-001")
            self.assertIn(field, caught.exception.message)
        for wrong, field in (({"set": {"acute_cholecystitis": [1]}}, "patient.set.acute_cholecystitis"), ({"set": {"acute_cholecystitis": np.inf}}, "patient.set.acute_cholecystitis is inf"),
                             ({"set": {"acute_cholecystitis": None}}, "patient.set.acute_cholecystitis is None"), ({"seed": -1}, "patient.seed is -1"),
                             ({"seed": 2 ** 64}, "patient.seed"), ({"seed": True}, '"seed"'), ({"seed": np.float32(1.5)}, '"seed"')):
            with self.assertRaises(trocar.Error) as caught:
                trocar.Simulation("cholecystectomy", patient=wrong)
            self.assertEqual(caught.exception.code, "E-CLI-001")
            self.assertIn(field, caught.exception.message)
        for wrong, field in (({"path": "much"}, "weights.path is 'much'"), ({"path": np.nan}, "weights.path is nan"), ({"path": None}, "weights.path")):
            with self.assertRaises(trocar.Error) as caught:
                trocar.make("peg_transfer", weights=wrong)
            self.assertIn(field, caught.exception.message)


class Copies(unittest.TestCase):
    ways = staticmethod(lambda: (lambda thing: pickle.loads(pickle.dumps(thing)), copy.copy, copy.deepcopy))

    def test_a_simulation_goes_on_in_its_copies(self):
        task = json.loads(trocar.find("lift_and_grasp").read_text())
        simulation = trocar.Simulation(task, seed=3, folder=str(trocar.find("lift_and_grasp").parent), metrics=True)
        task.clear()  # what was made of it stays
        simulation.play(trocar.Surgeon("expert", simulation, seed=3), 200)
        for again in self.ways():
            other, inputs = again(simulation), simulation.home()
            self.assertEqual((other.hash(), other.tick), (simulation.hash(), 200))
            state = simulation.save()
            other.step(inputs, 20)
            self.assertNotEqual(other.hash(), simulation.hash())
            simulation.step(inputs, 20)
            self.assertEqual(other.hash(), simulation.hash())
            simulation.restore(state)
            self.assertTrue(other.metrics())

    def test_inputs_and_cameras_have_copies(self):
        simulation = trocar.Simulation("cholecystectomy")
        inputs, camera = simulation.home(), trocar.Camera(24, 16)
        inputs.hands, inputs.cut, inputs.tools, inputs.assistant = inputs.hands + 1 / 3, (True, False), (1, 0), "retract"
        for again in self.ways():
            other = again(inputs)
            self.assertEqual(other, inputs)
            other.cut = (False, False)
            self.assertNotEqual(other, inputs)
            np.testing.assert_array_equal(again(camera).draw(simulation), camera.draw(simulation))

    def test_what_has_no_copy_says_so(self):
        simulation = trocar.Simulation("lift_and_grasp")
        with self.assertRaises(TypeError):
            pickle.dumps(trocar.Surgeon("expert", simulation))


class Pictures(unittest.TestCase):
    def test_camera_draws_what_changes(self):
        simulation = trocar.Simulation("peg_transfer")
        camera = trocar.Camera(96, 64)
        first = camera.draw(simulation)
        self.assertEqual((first.shape, first.dtype), ((64, 96, 3), np.uint8))
        self.assertGreater(first.std(), 5)
        np.testing.assert_array_equal(first, camera.draw(simulation))
        moved = simulation.home()
        moved.hands = moved.hands + np.array([[0.2, 0, 0, 0.02, 0]] * 2)
        simulation.step(moved, 60)
        self.assertGreater(np.abs(first.astype(int) - camera.draw(simulation)).mean(), 0.5)

    def test_camera_may_be_used_by_another_thread(self):
        simulation, camera, seen = trocar.Simulation("peg_transfer"), trocar.Camera(32, 32), []
        camera.draw(simulation)
        thread = threading.Thread(target=lambda: seen.append(camera.draw(simulation)))
        thread.start()
        thread.join()
        np.testing.assert_array_equal(seen[0], camera.draw(simulation))


class Errors(unittest.TestCase):
    def check(self, code, call):
        with self.assertRaises(trocar.Error) as caught:
            call()
        self.assertEqual(caught.exception.code, code)
        self.assertTrue(caught.exception.message and caught.exception.remedy)
        self.assertEqual(caught.exception.meaning, trocar.error_table()[code])

    def test_errors_carry_codes(self):
        simulation = trocar.Simulation("peg_transfer")
        inputs = simulation.home()
        self.check("E-SCN-003", lambda: trocar.Simulation("juggling"))
        self.check("E-CLI-001", lambda: trocar.Simulation("peg_transfer", threads=0))
        self.check("E-CLI-001", lambda: trocar.Simulation("peg_transfer", seed=-1))
        self.check("E-CLI-001", lambda: trocar.make("peg_transfer", seed=1.5))
        self.check("E-SCN-003", lambda: trocar.Simulation("cholecystectomy", level="heroic"))
        self.check("E-SCN-003", lambda: trocar.make("cholecystectomy", level="heroic"))
        self.check("E-SCN-003", lambda: trocar.Surgeon("nobody", simulation))
        self.check("E-CLI-001", lambda: simulation.step(inputs, -1))
        self.check("E-CLI-001", lambda: trocar.Camera(4, 4))
        self.check("E-ENV-001", lambda: setattr(inputs, "hands", np.zeros(9)))
        self.check("E-ENV-001", lambda: setattr(inputs, "hands", np.full((2, 5), np.nan)))
        self.check("E-SCN-003", lambda: setattr(inputs, "assistant", "dance"))

    def test_errors_travel_between_processes(self):
        error = trocar.Error("E-ENV-001", "wrong; do right", "a meaning")
        for made in (pickle.loads(pickle.dumps(error)), copy.deepcopy(error)):
            self.assertEqual((made.code, made.remedy, made.meaning, str(made)), ("E-ENV-001", "do right", "a meaning", str(error)))

    def test_errors_are_made_of_their_text(self):
        """Gymnasium's AsyncVectorEnv does it with what its processes give, the text or the error."""
        error = trocar.Error("E-ENV-001", "wrong,\non two lines; do right")
        self.assertEqual(error.meaning, trocar.error_table()["E-ENV-001"])
        for made in (trocar.Error(str(error)), trocar.Error(error), type(error)(*error.args)):
            self.assertEqual((made.code, made.message, made.meaning, str(made)), ("E-ENV-001", error.message, error.meaning, str(error)))
        other = trocar.Error("something else")
        self.assertEqual((other.code, other.message, str(other)), ("", "something else", "something else"))


class Package(unittest.TestCase):
    def test_stubs_name_what_is_there(self):
        import ast
        from trocar import _trocar
        text = Path(_trocar.__file__).with_name("_trocar.pyi").read_text()
        said = {node.name for node in ast.parse(text).body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(said, {name for name, member in vars(_trocar).items() if callable(member) and not name.startswith("_")})
        for node in ast.parse(text).body:
            if isinstance(node, ast.ClassDef):
                members = {part.target.id if isinstance(part, ast.AnnAssign) else part.name for part in node.body}
                there = {name for name in vars(getattr(_trocar, node.name)) if not name.startswith("_")}
                self.assertEqual({name for name in members if not name.startswith("_")}, there, node.name)


if __name__ == "__main__":
    unittest.main()
