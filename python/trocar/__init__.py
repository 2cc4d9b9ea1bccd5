# SPDX-License-Identifier: Apache-2.0
"""Trocar, an open laparoscopic surgery simulator, in Python.

>>> import trocar
>>> simulation = trocar.Simulation("peg_transfer")
>>> environment = trocar.make("peg_transfer")
>>> pool = trocar.make_vec("peg_transfer", num_envs=4)

Lengths in metres, angles in radians, forces in newtons, the world frame x to the patient's left, y cranial, z anterior.
"""
from ._trocar import CLASSES, FEATURES, Input, Surgeon, __version__, default_weights, error_table, find, surgeons, tasks
from .checker import check_env, check_vector_env
from .environments import Environment, VectorEnvironment, environments, make, make_vec
from .errors import Error
from .objects import Camera, Simulation
from .parallel import ParallelEnvironment, make_parallel

__all__ = [
    "CLASSES", "FEATURES", "Camera", "Environment", "Error", "Input", "ParallelEnvironment", "Simulation", "Surgeon",
    "VectorEnvironment", "__version__", "check_env", "check_vector_env", "default_weights", "environments", "error_table",
    "find", "make", "make_parallel", "make_vec", "surgeons", "tasks",
]
