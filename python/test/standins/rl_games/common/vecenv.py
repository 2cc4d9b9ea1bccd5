# SPDX-License-Identifier: Apache-2.0
from .env_configurations import configurations

vecenv_config: dict = {}


def register(config_name, func):
    vecenv_config[config_name] = func


def create_vec_env(config_name, num_actors, **kwargs):
    return vecenv_config[configurations[config_name]["vecenv_type"]](config_name, num_actors, **kwargs)
