# SPDX-License-Identifier: Apache-2.0
"""Lets a scripted surgeon play and prints what its tools feel: build/python/bin/python samples/python/forces.py [picture.ppm]"""
import sys

import numpy as np

import trocar

simulation = trocar.Simulation("lift_and_grasp", seed=1)
surgeon = trocar.Surgeon("expert", simulation)
while not surgeon.has_finished:
    simulation.play(surgeon, 60)
    tools = simulation.snapshot()["instruments"]
    forces = {hand: f"{np.linalg.norm(tool['force']):.2f} N on {tool['object'] or tool['surface'] or 'nothing'}"
              for hand, tool in tools.items()}
    print(f"{simulation.time:5.1f} s  left {forces['left']}, right {forces['right']}: {surgeon.doing}")
task = simulation.snapshot()["task"]
print(f"{task['phase']} after {task['time']:.1f} s, score {task['score']:.0f}")
if len(sys.argv) > 1:
    picture = trocar.Camera(640, 480).draw(simulation)
    with open(sys.argv[1], "wb") as file:
        file.write(b"P6 640 480 255\n" + picture.tobytes())
