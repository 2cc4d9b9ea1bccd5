# SPDX-License-Identifier: Apache-2.0
"""What the package's objects have in common: copies by what they were made of, and one thread at a time."""
from __future__ import annotations

import copy
import functools
import inspect
import operator
import threading
from typing import Any, Callable, Optional

from . import _trocar
from .errors import Error

_SEEDS = 2 ** 64


def seed_of(given: Any, name: str = "a seed") -> Optional[int]:
    """A seed as a whole number, also one of numpy's; None stays None."""
    if given is None:
        return None
    try:
        seed = -1 if isinstance(given, bool) else operator.index(given)
    except TypeError:
        seed = -1
    if not 0 <= seed < _SEEDS:
        raise Error("E-CLI-001", f"{name} is {given!r}; it is a whole number from 0 to 2^64 - 1")
    return seed


def _again(cls: type, arguments: tuple, settings: dict) -> Any:
    return cls(*arguments, **settings)


class Made:
    """Pickles and copies are made anew of the same arguments, so that they begin where a new one begins."""

    def __new__(cls, *arguments: Any, **settings: Any):
        self = super().__new__(cls)
        # dictionaries may change later; what was made of them does not
        self._made_of = tuple(map(_kept, arguments)), {name: _kept(value) for name, value in settings.items()}
        return self

    def __reduce__(self):
        return _again, (type(self), *self._made_of)


def _kept(argument: Any) -> Any:
    return copy.deepcopy(argument) if isinstance(argument, (dict, list)) else argument


class Turn:
    """One thread's claim to an object. Another one is refused, as the objects of the compiled part do, and does not wait."""

    def __init__(self, what: str) -> None:
        self._what, self._lock = what, threading.RLock()

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise Error("E-ENV-002", f"this {self._what} is in the middle of another call; give each thread its own, or let "
                        "threads take turns with a threading.Lock")

    def __exit__(self, *_: Any) -> None:
        self._lock.release()


class Taken(Made):
    """An object whose public methods take its ``_turn``: classes of these are decorated with :func:`one_at_a_time`."""

    def __new__(cls, *arguments: Any, **settings: Any):
        self = super().__new__(cls, *arguments, **settings)
        self._turn = Turn(cls.__name__)
        return self


def _in_turn(call: Callable) -> Callable:
    @functools.wraps(call)
    def guarded(self, *args: Any, **settings: Any):
        with self._turn:
            return call(self, *args, **settings)
    return guarded


def one_at_a_time(cls: type) -> type:
    """Every public method and property of the class takes its object's turn."""
    for name, member in list(vars(cls).items()):
        if name.startswith("_") and name != "__exit__":
            continue
        if isinstance(member, property):
            setter = None if member.fset is None else _in_turn(member.fset)
            setattr(cls, name, property(_in_turn(member.fget), setter, doc=member.__doc__))
        elif inspect.isfunction(member):
            setattr(cls, name, _in_turn(member))
    return cls


class EnvironmentModel(Made, _trocar.EnvironmentModel):
    __doc__ = _trocar.EnvironmentModel.__doc__

    def __init__(self, task: Any, *, seed: Any = 1, patient: Any = "", **settings: Any) -> None:
        super().__init__(task, seed=seed_of(seed), patient=list(patient) if isinstance(patient, tuple) else patient, **settings)


class Camera(Made, _trocar.Camera):
    __doc__ = _trocar.Camera.__doc__


class Simulation(Made, _trocar.Simulation):
    __doc__ = _trocar.Simulation.__doc__

    def __init__(self, task: Any, *, seed: Any = 1, **settings: Any) -> None:
        super().__init__(task, seed=seed_of(seed), **settings)

    def __reduce__(self):
        return (*super().__reduce__(), self.save())

    def __setstate__(self, state: bytes) -> None:
        self.restore(state)
