# SPDX-License-Identifier: Apache-2.0
import numpy as np

from ..spaces import Box, Dict, MultiDiscrete


def batch_space(space, n=1):
    if isinstance(space, Box):
        return Box(np.stack([space.low] * n), np.stack([space.high] * n), dtype=space.dtype)
    if isinstance(space, MultiDiscrete):
        return MultiDiscrete(np.stack([space.nvec] * n))
    return Dict({name: batch_space(part, n) for name, part in space.items()})
