# SPDX-License-Identifier: Apache-2.0
"""What environments and pools have in common: one thread at a time uses them."""
from __future__ import annotations

import functools
import inspect
import threading
from typing import Any, Callable

from .errors import Error


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


def _in_turn(call: Callable) -> Callable:
    @functools.wraps(call)
    def guarded(self, *args: Any, **settings: Any):
        with self._turn:
            return call(self, *args, **settings)
    return guarded


def one_at_a_time(cls: type) -> type:
    """Every public method and property of the class takes its object's ``_turn``, which ``__new__`` has made."""
    def make(of: type, *_: Any, **__: Any):
        self = object.__new__(of)
        self._turn = Turn(cls.__name__)
        return self

    cls.__new__ = make
    for name, member in list(vars(cls).items()):
        if name.startswith("_") and name != "__exit__":
            continue
        if isinstance(member, property):
            setter = None if member.fset is None else _in_turn(member.fset)
            setattr(cls, name, property(_in_turn(member.fget), setter, doc=member.__doc__))
        elif inspect.isfunction(member):
            setattr(cls, name, _in_turn(member))
    return cls
