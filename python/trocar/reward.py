# SPDX-License-Identifier: Apache-2.0
"""Terms of a reward that an environment's user writes: a Python function, or an expression, which may stand in a JSON file.

An expression knows the fields of the state by their names (``left.tip``, ``region.end.centre``; ``state["goal.The bead.done"]``
where a name has blanks), the features of the reward (``goal``, ``force``; ``feature["time"]`` where the state has the name, too), numbers,
+ - * / **, comparisons (1 or 0), parts of a vector (``left.tip[2]``), and ``norm``, ``dot``, ``abs``, ``sqrt``, ``exp``, ``min``, ``max``, ``clip(x, low, high)`` and
``before(x)``: what x was before the action.
"""
from __future__ import annotations

import ast
import json
import os
from collections.abc import Mapping
from typing import Any, Callable, Iterator, Union

import numpy as np

from . import _trocar
from .errors import Error

Term = Union[str, dict, Callable[["State", "State", dict], float]]


class State(Mapping):
    """A state by its fields' names: ``state["left.tip"]`` is (3,), a single number a float. Of several states (n, 3) and (n,)."""

    def __init__(self, fields: list, row: np.ndarray) -> None:
        self._fields, self._row = fields if isinstance(fields, dict) else _by_name(fields), row

    def __getitem__(self, name: str) -> Any:
        first, count = self._fields[name]
        part = self._row[..., first:first + count]
        return part if count > 1 else part[..., 0] if part.ndim > 1 else float(part[0])

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)


def _by_name(fields: list) -> dict[str, tuple[int, int]]:
    return {field["name"]: (field["first"], field["count"]) for field in fields}


def _wrong(term: str, what: str) -> Error:
    return Error("E-CLI-001", f'the reward term "{term}" {what}')


def _level(*values: Any) -> list[Any]:
    """Numbers of each environment beside vectors of each."""
    if max(map(np.ndim, values)) < 2:
        return list(values)
    return [value[:, None] if np.ndim(value) == 1 else value for value in values]


_BINARY = {ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide, ast.Pow: np.power}
_COMPARE = {ast.Lt: np.less, ast.LtE: np.less_equal, ast.Gt: np.greater, ast.GtE: np.greater_equal, ast.Eq: np.equal,
            ast.NotEq: np.not_equal}
_OF_VECTORS = {"norm": (1, lambda x: np.linalg.norm(x, axis=-1)), "dot": (2, lambda a, b: (a * b).sum(-1))}
_CALLS = {**_OF_VECTORS, "abs": (1, np.abs), "sqrt": (1, np.sqrt), "exp": (1, np.exp), "min": (2, np.minimum), "max": (2, np.maximum),
          "clip": (3, np.clip)}


class Expression:
    """A term as a text. Called with (states now, states before, features), each of n environments; gives (n,)."""

    def __init__(self, term: str, text: str, fields: list) -> None:
        self._term, self._fields = term, _by_name(fields)
        try:
            tree = ast.parse(text, mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError) as wrong:
            raise _wrong(term, f"is no expression: {text!r}; {getattr(wrong, 'msg', None) or wrong}") from None
        try:
            self._calc = self._compile(tree.body, is_before=False)
        except RecursionError:
            raise _wrong(term, "is too deep; split it into several terms") from None

    def __call__(self, now: np.ndarray, before: np.ndarray, features: dict[str, np.ndarray]) -> np.ndarray:
        with np.errstate(all="ignore"):  # what is not finite is refused by its name
            value = self._calc((State(self._fields, now), State(self._fields, before), features))
        if np.ndim(value) > 1:
            raise _wrong(self._term, "gives a vector; take its norm, or one of its parts: left.tip[2]")
        return np.broadcast_to(np.asarray(value, np.float64), (len(now),))

    def _name(self, name: str, is_before: bool, of: str = "") -> Callable:
        if not of and name in self._fields and name in _trocar.FEATURES:
            raise Error("E-SCN-003", f'the reward term "{self._term}" names "{name}", which the state has and the features have; '
                        f'write state["{name}"] or feature["{name}"]')
        if of != "feature" and name in self._fields:
            return lambda at: at[is_before][name]
        if of != "state" and name in _trocar.FEATURES:
            if is_before:
                raise _wrong(self._term, f"asks for {name} before the action; features are of the action")
            return lambda at: at[2][name]
        near = [known for known in (*self._fields, *_trocar.FEATURES) if known.split(".")[0] == name.split(".")[0]]
        raise Error("E-SCN-003", f'the reward term "{self._term}" names "{name}"; the state and the features have '
                    + ", ".join(near or [*sorted({known.split(".")[0] for known in self._fields}), *_trocar.FEATURES]))

    def _compile(self, node: ast.AST, is_before: bool) -> Callable:
        again = lambda part: self._compile(part, is_before)  # noqa: E731
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
            try:
                value = float(node.value)
            except OverflowError:
                raise _wrong(self._term, "has a number that is too large") from None
            return lambda at: value
        if isinstance(node, (ast.Name, ast.Attribute)):
            return self._name(_dotted(node, self._term), is_before)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
            part, sign = again(node.operand), -1.0 if isinstance(node.op, ast.USub) else 1.0
            return lambda at: sign * part(at)
        if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
            left, right, call = again(node.left), again(node.right), _BINARY[type(node.op)]
            return lambda at: call(*_level(left(at), right(at)))
        if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARE:
            left, right, call = again(node.left), again(node.comparators[0]), _COMPARE[type(node.ops[0])]
            return lambda at: np.asarray(call(*_level(left(at), right(at))), np.float64)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            if node.func.id == "before" and len(node.args) == 1 and not is_before:
                return self._compile(node.args[0], True)
            count, call = _CALLS.get(node.func.id, (None, None))
            if count == len(node.args):
                parts, name = [again(part) for part in node.args], node.func.id

                def calc(at):
                    values = [part(at) for part in parts]
                    if name in _OF_VECTORS and any(np.ndim(value) != 2 for value in values):
                        raise _wrong(self._term, f"takes {name} of what is no vector: {ast.unparse(node)}")
                    return call(*_level(*values))
                return calc
        if isinstance(node, ast.Subscript):
            key = node.slice
            if isinstance(node.value, ast.Name) and node.value.id in ("state", "feature") and isinstance(key, ast.Constant) and isinstance(key.value, str):
                return self._name(key.value, is_before, of=node.value.id)
            if isinstance(key, ast.Constant) and isinstance(key.value, int) and isinstance(node.value, (ast.Name, ast.Attribute, ast.Subscript)):
                part, at_index = again(node.value), key.value
                name = self._size_of(node.value)
                if not 0 <= at_index < name:
                    raise _wrong(self._term, f"asks for part {at_index} of {ast.unparse(node.value)}, which has {name}")
                return lambda at: part(at)[..., at_index]
        raise _wrong(self._term, f"has {ast.unparse(node)!r}, which is none of: names of the state and of features, numbers, + - * / **, "
                     f"comparisons, parts of a vector, before and {', '.join(_CALLS)}")

    def _size_of(self, node: ast.AST) -> int:
        name = node.slice.value if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant) else _dotted(node, self._term)
        return self._fields.get(name, (0, 1))[1]


def _dotted(node: ast.AST, term: str) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value, term)}.{node.attr}"
    raise _wrong(term, f"has {ast.unparse(node)!r} in the place of a name")


class Terms:
    """All terms of an environment, with their weights."""

    def __init__(self, given: Any, fields: list) -> None:
        self._fields = _by_name(fields)
        self._terms: dict[str, tuple[float, Any, bool]] = {}
        for name, term in _read(given).items():
            weight, is_function = 1.0, False
            if isinstance(term, dict):
                unknown = set(term) - {"about", "expression", "function", "weight"}
                if unknown or ("expression" in term) == ("function" in term):
                    raise _wrong(name, 'is a dictionary with either "expression" or "function", and perhaps "weight" and "about"')
                weight = term.get("weight", 1.0)
                if isinstance(weight, bool) or not isinstance(weight, (int, float, np.number)) or not np.isfinite(weight):
                    raise _wrong(name, f"has the weight {weight!r}; a weight is a finite number")
                term = term.get("expression", term.get("function"))
            if isinstance(term, str):
                term = Expression(name, term, fields)
            elif callable(term):
                is_function = True
            else:
                raise _wrong(name, f"is {term!r}; give a function of (state, before, features), or an expression as a text")
            self._terms[name] = float(weight), term, is_function

    def __bool__(self) -> bool:
        return bool(self._terms)

    def calc(self, now: np.ndarray, before: np.ndarray, features: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """What each adds to the rewards of n environments, times its weight; states (n, size), features (n,)."""
        out = {}
        for name, (weight, term, is_function) in self._terms.items():
            if is_function:
                value = np.array([_number(name, term(State(self._fields, now[i]), State(self._fields, before[i]),
                                                      {key: float(row[i]) for key, row in features.items()}))
                                  for i in range(len(now))], np.float64)
            else:
                value = term(now, before, features)
            if not np.isfinite(value).all():
                raise _wrong(name, f"is {value[~np.isfinite(value)][0]}; a reward is a finite number")
            out[name] = weight * value
        return out


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _wrong(name, f"gives {value!r}; a reward is a number") from None


def _read(given: Any) -> dict[str, Any]:
    if given is None:
        return {}
    if isinstance(given, (str, os.PathLike)):
        path = os.fspath(given)
        try:
            with open(path, encoding="utf-8") as file:
                given = json.load(file)
        except (OSError, ValueError) as wrong:
            raise Error("E-IO-001" if isinstance(wrong, OSError) else "E-IO-004", f"{path}: {wrong}; it is a JSON file of reward terms") from wrong
        if not isinstance(given, dict) or given.get("format") != "trocar-reward-terms" or given.get("version") != 1:
            raise Error("E-IO-005", f'{path}: at format: must be "trocar-reward-terms" of version 1')
        given = given.get("terms")
    if not isinstance(given, dict) or not all(isinstance(name, str) for name in given):
        raise Error("E-CLI-001", f"the reward terms are {given!r}; give a dictionary of names, or a JSON file")
    return given
