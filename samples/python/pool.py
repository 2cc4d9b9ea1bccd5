# SPDX-License-Identifier: Apache-2.0
"""Steps a pool of environments and says how fast: build/python/bin/python samples/python/pool.py [task] [environments]"""
import sys
import time

import trocar

task = sys.argv[1] if len(sys.argv) > 1 else "peg_transfer"
count = int(sys.argv[2]) if len(sys.argv) > 2 else 4
with trocar.make_vec(task, num_envs=count) as pool:
    pool.reset(seed=1)
    pool.action_space.seed(1)
    steps, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < 3:
        states, rewards, terminated, truncated, infos = pool.step(pool.action_space.sample())
        steps += count
    seconds = time.perf_counter() - begin
    print(f"{task}: {count} environments on {pool.threads} threads, {steps / seconds:.0f} actions/s, "
          f"{steps * pool.model.ticks_per_action / seconds:.0f} ticks/s")
