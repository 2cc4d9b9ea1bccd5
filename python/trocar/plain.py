# SPDX-License-Identifier: Apache-2.0
"""Dictionaries as files hold them: texts, numbers, truth values, lists and dictionaries, and whatever numpy has of these."""
from __future__ import annotations

import math
import os
from typing import Any

import numpy as np

from .errors import Error


def plain(value: Any, where: str) -> Any:
    """A copy of Python's own values. ``where`` is the value's name in messages, "" for the whole dictionary."""
    try:
        return _plain(value, where)
    except RecursionError:
        raise Error("E-CLI-001", f"{where or 'the dictionary'} holds itself, or is too deep; give one that ends") from None


def _plain(value: Any, where: str) -> Any:
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        if not math.isfinite(value):
            raise Error("E-CLI-001", f"{where} is {value}; JSON has no such number: give a finite one")
        return float(value)
    if isinstance(value, dict):
        for key in value:
            if not isinstance(key, str):
                raise Error("E-CLI-001", f"a key of {where or 'the dictionary'} is {key!r}; keys are texts")
        return {str(key): _plain(part, f"{where}.{key}" if where else str(key)) for key, part in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.ndim else value[()]
        if not isinstance(value, list):
            return _plain(value, where)
    if isinstance(value, (list, tuple)):
        return [_plain(part, f"{where}[{i}]") for i, part in enumerate(value)]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise Error("E-CLI-001", f"{where} is {value!r} ({type(value).__name__}); a dictionary is JSON: it holds texts, numbers, "
                "truth values, lists and dictionaries")
