# SPDX-License-Identifier: Apache-2.0
"""Many environments as one."""
import enum


class AutoresetMode(enum.Enum):
    NEXT_STEP = "NextStep"
    SAME_STEP = "SameStep"
    DISABLED = "Disabled"


class VectorEnv:
    metadata: dict = {}
    spec = None
    render_mode = None
    closed = False

    @property
    def unwrapped(self):
        return self
