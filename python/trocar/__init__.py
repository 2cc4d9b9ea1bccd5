# SPDX-License-Identifier: Apache-2.0
"""Trocar, an open laparoscopic surgery simulator, in Python.

>>> import trocar
>>> simulation = trocar.Simulation("peg_transfer")
>>> environment = trocar.make("peg_transfer")
>>> pool = trocar.make_vec("peg_transfer", num_envs=4)

Lengths in metres, angles in radians, forces in newtons, the world frame x to the patient's left, y cranial, z anterior.
"""
from . import data as _data  # noqa: F401  where a wheel has the delivered files, before anybody asks for them
from ._trocar import CLASSES, FEATURES, RANGES, Input, Surgeon, __version__, default_weights, error_table, find, surgeons, tasks
from .adapters import CleanRlVectorEnvironment, RlGamesVecEnv, StableBaselinesVecEnv, make_cleanrl, make_rl_games, make_sb3, register_rl_games
from .checker import check_env, check_vector_env
from .environments import CONTACT_FIELDS, Environment, VectorEnvironment, environments, make, make_vec
from .errors import Error
from .objects import Camera, Simulation
from .parallel import ParallelEnvironment, make_parallel
from .registration import environment_id, register_all

__all__ = [
    "CLASSES", "CONTACT_FIELDS", "Camera", "CleanRlVectorEnvironment", "Environment", "Error", "FEATURES", "Input", "ParallelEnvironment",
    "RANGES", "RlGamesVecEnv", "Simulation", "StableBaselinesVecEnv", "Surgeon", "VectorEnvironment", "__version__", "check_env",
    "check_vector_env", "default_weights", "environment_id", "environments", "error_table", "find", "make", "make_cleanrl", "make_parallel",
    "make_rl_games", "make_sb3", "make_vec", "register_all", "register_rl_games", "surgeons", "tasks",
]

try:
    register_all()
except Error:
    pass  # the delivered tasks are not there: every call that wants one says so
