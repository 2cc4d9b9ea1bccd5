# SPDX-License-Identifier: Apache-2.0
"""Sets that values are drawn from."""
import numpy as np


class Space:
    def __init__(self, shape, dtype):
        self.shape, self.dtype = shape, None if dtype is None else np.dtype(dtype)
        self.np_random = np.random.default_rng()

    def seed(self, seed=None):
        self.np_random = np.random.default_rng(seed)
        return seed

    def __contains__(self, x):
        return self.contains(x)


class Box(Space):
    def __init__(self, low, high, shape=None, dtype=np.float32):
        super().__init__(tuple(np.shape(low) if shape is None else shape), dtype)
        self.low, self.high = (np.broadcast_to(np.asarray(bound, dtype), self.shape) for bound in (low, high))

    def sample(self):
        low, high = (np.where(np.isfinite(bound), bound, other) for bound, other in ((self.low, -1), (self.high, 1)))
        return self.np_random.uniform(low, high).astype(self.dtype)

    def contains(self, x):
        return np.shape(x) == self.shape and bool(((x >= self.low) & (x <= self.high)).all())


class MultiDiscrete(Space):
    def __init__(self, nvec):
        self.nvec = np.asarray(nvec, np.int64)
        super().__init__(self.nvec.shape, np.int64)

    def sample(self):
        return self.np_random.integers(0, self.nvec)

    def contains(self, x):
        return np.shape(x) == self.shape and bool(((np.asarray(x) >= 0) & (x < self.nvec)).all())


class Dict(Space):
    def __init__(self, spaces):
        super().__init__(None, None)
        self.spaces = dict(spaces)

    def sample(self):
        return {name: space.sample() for name, space in self.spaces.items()}

    def contains(self, x):
        return x.keys() == self.spaces.keys() and all(x[name] in space for name, space in self.spaces.items())

    def __getitem__(self, name):
        return self.spaces[name]

    def keys(self):
        return self.spaces.keys()

    def items(self):
        return self.spaces.items()
