# SPDX-License-Identifier: Apache-2.0
configurations: dict = {}


def register(name, config):
    configurations[name] = config
