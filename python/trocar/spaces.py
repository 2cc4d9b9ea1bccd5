# SPDX-License-Identifier: Apache-2.0
"""Spaces of actions and observations: Gymnasium's where it can be imported, else the same few here."""
from __future__ import annotations

from collections import OrderedDict
from typing import Any, Optional

import numpy as np

try:
    from gymnasium.spaces import Box, Dict, MultiDiscrete, Space
    from gymnasium.vector.utils import batch_space
except ImportError:

    class Space:
        """A set that values can be drawn from. ``seed`` begins its own row of random numbers."""

        def __init__(self, shape: Optional[tuple], dtype: Any, seed: Optional[int] = None) -> None:
            self._shape = shape
            self.dtype = None if dtype is None else np.dtype(dtype)
            self.np_random = np.random.default_rng(seed)

        @property
        def shape(self):
            return self._shape

        def seed(self, seed: Optional[int] = None):
            self.np_random = np.random.default_rng(seed)
            return seed

        def __contains__(self, x: Any) -> bool:
            return self.contains(x)

    class Box(Space):
        """Arrays between two bounds, both included."""

        def __init__(self, low, high, shape=None, dtype=np.float32, seed=None) -> None:
            shape = np.shape(low) if shape is None else tuple(shape)
            super().__init__(shape, dtype, seed)
            self.low = np.broadcast_to(np.asarray(low, self.dtype), shape).copy()
            self.high = np.broadcast_to(np.asarray(high, self.dtype), shape).copy()

        def sample(self):
            if self.dtype.kind in "ui":
                return self.np_random.integers(self.low, self.high, endpoint=True, size=self.shape).astype(self.dtype)
            bounded = np.isfinite(self.low) & np.isfinite(self.high)
            uniform = self.np_random.uniform(np.where(bounded, self.low, 0), np.where(bounded, self.high, 1))
            return np.where(bounded, uniform, self.np_random.normal(size=self.shape)).astype(self.dtype)

        def contains(self, x: Any) -> bool:
            x = np.asarray(x)
            return (x.shape == self.shape and np.can_cast(x.dtype, self.dtype)
                    and bool(np.all(x >= self.low)) and bool(np.all(x <= self.high)))

        def __eq__(self, other: Any) -> bool:
            return (isinstance(other, Box) and self.shape == other.shape and self.dtype == other.dtype
                    and np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high))

        def __repr__(self) -> str:
            return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"

    class MultiDiscrete(Space):
        """Several choices; choice i is one of 0 to nvec[i] - 1."""

        def __init__(self, nvec, dtype=np.int64, seed=None) -> None:
            self.nvec = np.array(nvec, dtype)
            super().__init__(self.nvec.shape, dtype, seed)

        def sample(self):
            return self.np_random.integers(0, self.nvec).astype(self.dtype)

        def contains(self, x: Any) -> bool:
            x = np.asarray(x)
            return (x.shape == self.shape and x.dtype.kind in "ui" and bool(np.all(x >= 0))
                    and bool(np.all(x < self.nvec)))

        def __eq__(self, other: Any) -> bool:
            return isinstance(other, MultiDiscrete) and np.array_equal(self.nvec, other.nvec)

        def __repr__(self) -> str:
            return f"MultiDiscrete({self.nvec})"

    class Dict(Space):
        """Named spaces together."""

        def __init__(self, spaces, seed=None) -> None:
            self.spaces = OrderedDict(spaces)
            super().__init__(None, None, seed)

        def seed(self, seed=None):
            for i, space in enumerate(self.spaces.values()):
                space.seed(None if seed is None else seed + i)
            return seed

        def sample(self):
            return OrderedDict((name, space.sample()) for name, space in self.spaces.items())

        def contains(self, x: Any) -> bool:
            return (isinstance(x, dict) and x.keys() == self.spaces.keys()
                    and all(x[name] in space for name, space in self.spaces.items()))

        def __getitem__(self, name):
            return self.spaces[name]

        def keys(self):
            return self.spaces.keys()

        def items(self):
            return self.spaces.items()

        def __eq__(self, other: Any) -> bool:
            return isinstance(other, Dict) and self.spaces == other.spaces

    def batch_space(space: Space, n: int = 1) -> Space:
        """The space of `n` values of a space in one array."""
        if isinstance(space, Box):
            return Box(np.repeat(space.low[None], n, 0), np.repeat(space.high[None], n, 0), dtype=space.dtype)
        if isinstance(space, MultiDiscrete):
            return MultiDiscrete(np.repeat(space.nvec[None], n, 0))
        return Dict({name: batch_space(part, n) for name, part in space.items()})


def action_space(fields: list) -> Space:
    """Of the fields of an environment's action."""
    if fields and fields[0]["choices"]:
        return MultiDiscrete(np.array([field["choices"] for field in fields], np.int64))
    return Box(np.float32(-1), np.float32(1), (len(fields),), np.float32)
