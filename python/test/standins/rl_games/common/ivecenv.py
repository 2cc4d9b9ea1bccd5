# SPDX-License-Identifier: Apache-2.0
"""A stand-in after rl_games' published ``IVecEnv``."""


class IVecEnv:
    def step(self, actions):
        raise NotImplementedError

    def reset(self):
        raise NotImplementedError

    def get_env_info(self):
        raise NotImplementedError
