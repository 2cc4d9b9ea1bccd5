# SPDX-License-Identifier: Apache-2.0
"""Changes a task before it begins, and compares what the expert comes to: build/python/bin/python samples/python/slippery_rings.py [frictions ...]"""
import json
import sys

import trocar

file = trocar.find("peg_transfer")
for friction in [float(word) for word in sys.argv[1:]] or [0.9, 0.3]:
    task = json.loads(file.read_text())
    for thing in task["scene"]["objects"]:
        if thing["name"].startswith("ring"):
            thing["friction"] = friction
    simulation = trocar.Simulation(task, folder=str(file.parent), metrics=True)
    surgeon = trocar.Surgeon("expert", simulation)
    while not surgeon.has_finished:
        simulation.play(surgeon, 120)
    whole = {(m["metric"], m.get("hand")): m["value"] for m in simulation.metrics() if not {"phase", "tool"} & m.keys()}
    print(f"friction {friction}: {simulation.snapshot()['task']['phase']} after {whole['time', None]:.1f} s, "
          f"paths {whole['path_length', 'left']:.2f} and {whole['path_length', 'right']:.2f} m")
