# SPDX-License-Identifier: Apache-2.0
"""What the laparoscope sees as points in space, each with its class: point_cloud.py [TASK [FILE.ply]]"""
import sys

import numpy as np
import trocar

task = sys.argv[1] if len(sys.argv) > 1 else "cholecystectomy"
simulation = trocar.Simulation(task, seed=1)
width, height = 320, 240
camera = trocar.Camera(width, height)
colour, seen = camera.draw(simulation), camera.geometry(simulation)

row, column = np.nonzero(seen["depth"])
ray = np.stack([(column + 0.5 - width / 2) / seen["focal_length"], -(row + 0.5 - height / 2) / seen["focal_length"],
                -np.ones(len(row))], axis=1)
points = (seen["depth"][row, column, None] * ray) @ seen["pose"][:3, :3].T + seen["pose"][:3, 3]

names = {number: name for name, number in trocar.CLASSES.items()}
classes, counts = np.unique(seen["classes"], return_counts=True)
for number, count in sorted(zip(classes, counts), key=lambda pair: -pair[1]):
    print(f"{names[number]:18} {100 * count / seen['classes'].size:5.1f} % of the picture")

if len(sys.argv) > 2:
    with open(sys.argv[2], "w") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n")
        file.write("".join(f"property float {axis}\n" for axis in "xyz"))
        file.write("".join(f"property uchar {name}\n" for name in ("red", "green", "blue")) + "end_header\n")
        for p, c in zip(points, colour[row, column]):
            file.write(f"{p[0]:.5f} {p[1]:.5f} {p[2]:.5f} {c[0]} {c[1]} {c[2]}\n")
    print(f"{len(points)} points in {sys.argv[2]}")
