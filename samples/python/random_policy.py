# SPDX-License-Identifier: Apache-2.0
"""What random actions reach in every environment: build/python/bin/python samples/python/random_policy.py [seconds] [task ...]"""
import sys

import trocar

seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 5.0
print(f"{'environment':24} {'state':>6} {'action':>6} {'return':>9}  after {seconds:g} s of random actions")
for task in sys.argv[2:] or trocar.environments():
    with trocar.make(task, actions="tip", most_seconds=seconds) as environment:
        environment.reset(seed=1)
        environment.action_space.seed(1)
        total, is_over = 0.0, False
        while not is_over:
            _, reward, terminated, truncated, info = environment.step(environment.action_space.sample())
            total += reward
            is_over = terminated or truncated
        print(f"{task:24} {environment.model.state_size:6} {environment.model.action_size:6} {total:9.3f}")
