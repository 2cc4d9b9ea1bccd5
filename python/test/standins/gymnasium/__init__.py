# SPDX-License-Identifier: Apache-2.0
"""A stand-in after Gymnasium's published interface: see README.md."""


class Env:
    metadata: dict = {"render_modes": []}
    render_mode = None
    spec = None

    @property
    def unwrapped(self):
        return self


class Wrapper(Env):
    pass


from . import spaces, vector  # noqa: E402,F401
from .envs.registration import make, make_vec, register, registry, spec  # noqa: E402,F401
