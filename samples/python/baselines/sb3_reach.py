# SPDX-License-Identifier: Apache-2.0
"""Stable-Baselines3's PPO with its defaults on reach, from the whole scaled state: sb3_reach.py --path DIR [--path DIR ...] [--seeds 5]

Stable-Baselines3 and Gymnasium are not shipped: --path names folders that hold them, as unpacked sources do. With Debian's python3-torch
(1.13) Stable-Baselines3 2.3.2 and Gymnasium 0.29.1 fit; besides they want cloudpickle, pandas and matplotlib, of Debian, too.

  build/python/bin/python samples/python/baselines/sb3_reach.py --path stable-baselines3-2.3.2 --path Gymnasium-0.29.1

After each seed's training the share of the 100 unseen seeds 10001 to 10100 that succeed without noise is printed.
"""
import argparse
import sys
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--path", action="append", default=[], help="folder with stable_baselines3 or gymnasium in it; may be repeated")
    parser.add_argument("--actions", type=int, default=50_000, help="of training, in all environments together")
    parser.add_argument("--environments", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=5)
    arguments = parser.parse_args()
    sys.path[:0] = arguments.path
    try:
        from stable_baselines3 import PPO
    except ImportError as missing:
        sys.exit(f"{missing}; name a folder that holds it with --path")
    import common
    import trocar
    for seed in range(1, arguments.seeds + 1):
        begin = time.monotonic()
        env = trocar.make_sb3(num_envs=arguments.environments, **common.settings_of("reach"))
        env.seed(1_000_000 * seed)
        model = PPO("MlpPolicy", env, seed=seed, device="cpu")
        env.seed(1_000_000 * seed)  # PPO's own seed names others
        model.learn(arguments.actions)
        trained = time.monotonic() - begin
        found = common.judge(lambda unseen: common.play("reach", unseen, lambda seen: model.predict(seen, deterministic=True)[0]))
        print(f"seed {seed}: {model.num_timesteps} actions in {trained:.0f} s, {100 * found['success']:.0f} % of {found['episodes']} unseen seeds", flush=True)
        env.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
