# SPDX-License-Identifier: Apache-2.0
"""Trains the baselines, judges them on unseen seeds, and renews their page.

  build/python/bin/python samples/python/baselines/run.py                      all: every task, three algorithms, five seeds, 20 minutes of processor
                                                                               time each, which is 10 minutes of two cores
  build/python/bin/python samples/python/baselines/run.py --task reach --algorithm ppo --seeds 1:5 --minutes 3
  build/python/bin/python samples/python/baselines/run.py --page               the page anew, of what was measured so far

What was measured is added to docs/baselines.json, from which docs/baselines.md and its curves are written. A run that is there
already, of the same minutes, is not repeated. Needs python3-torch.
"""
import argparse
import datetime
import json
import os
import pathlib
import sys
import time

import common  # first: it says how many threads torch gets

import numpy as np

import trocar

import cloning
import ppo
import sac

ROOT = pathlib.Path(__file__).resolve().parents[3]
RESULTS, PAGE, PICTURES = ROOT / "docs" / "baselines.json", ROOT / "docs" / "baselines.md", ROOT / "docs" / "images" / "baselines"
ALGORITHMS = {"ppo": ppo.train, "sac": sac.train, "cloning": cloning.train}
NAMES = {"random": "random actions", "expert": "scripted expert", "ppo": "PPO", "sac": "SAC", "cloning": "behaviour cloning"}
COLOURS = {"ppo": "#1f77b4", "sac": "#d62728", "cloning": "#2ca02c"}


def read():
    return json.loads(RESULTS.read_text())["runs"] if RESULTS.exists() else []


def write(runs):
    RESULTS.write_text(json.dumps({"format": "trocar-baselines", "version": 1, "runs": runs}, indent=1) + "\n")


def measure(task, algorithm, seed, minutes, episodes):
    """One run: what it took, and what it comes to over unseen seeds."""
    begin, work = time.monotonic(), time.process_time()
    run = {"task": task, "algorithm": algorithm, "seed": seed, "minutes": minutes, "date": datetime.date.today().isoformat(),
           "machine": f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.0f}", "version": trocar.__version__}
    seeds = common.UNSEEN[:episodes]
    if algorithm in ALGORITHMS:
        act, curve = ALGORITHMS[algorithm](task, 60 * minutes, seed)
        run.update(actions=curve.taken, curve={"actions": curve.actions, "success": curve.success, "goals": curve.goals},
                   seconds=round(time.monotonic() - begin, 1), processor_seconds=round(time.process_time() - work, 1))
        run.update(common.judge(lambda unseen: common.play(task, unseen, act), seeds))
    else:
        attempt = common.play_random if algorithm == "random" else common.play_expert
        run.update(common.judge(lambda unseen: attempt(task, unseen), seeds))
    return run


def write_curve(path, task, runs):
    """Share of the last 100 episodes that succeeded, a line for each seed."""
    width, height, left, top, across, up = 640, 360, 60, 40, 440, 260
    last = max((run["curve"]["actions"][-1] for run in runs), default=1) or 1
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="white"/>', f'<text x="{left}" y="24" font-size="15">{task}: success while training</text>',
             f'<text x="{left + across / 2}" y="{height - 12}" text-anchor="middle">actions</text>']
    for share in (0, 0.5, 1):
        lines += [f'<line x1="{left}" y1="{top + up * (1 - share)}" x2="{left + across}" y2="{top + up * (1 - share)}" stroke="#ddd"/>',
                  f'<text x="{left - 8}" y="{top + up * (1 - share) + 4}" text-anchor="end">{100 * share:.0f} %</text>',
                  f'<text x="{left + share * across}" y="{top + up + 18}" text-anchor="middle">{share * last:.0f}</text>']
    named = []
    for run in runs:
        points = " ".join(f"{left + across * a / last:.1f},{top + up * (1 - s):.1f}" for a, s in zip(run["curve"]["actions"], run["curve"]["success"]))
        lines.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[run["algorithm"]]}" stroke-width="1.6"/>')
        if run["algorithm"] not in named:
            named.append(run["algorithm"])
            lines.append(f'<text x="{left + across + 12}" y="{top + 20 * len(named)}" fill="{COLOURS[run["algorithm"]]}">{NAMES[run["algorithm"]]}</text>')
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join([*lines, "</svg>\n"]))


def row(name, runs):
    success = 100 * np.array([run["success"] for run in runs])
    goals = 100 * np.array([run["goals"] for run in runs])
    spread = f" ({success.min():.0f} to {success.max():.0f})" if len(runs) > 1 else ""
    trained = (f"{min(run['minutes'] for run in runs):g} min of processor time, {np.mean([run['actions'] for run in runs]):,.0f} actions") if "actions" in runs[0] else "-"
    return (f"| {name} | {len(runs)} | {trained} | {success.mean():.0f} %{spread} | {goals.mean():.0f} % | {runs[0]['episodes']} | "
            f"{runs[-1]['machine']}, {runs[-1]['date']} |")


def write_page(runs):
    lines = ["# Baselines", "",
             "What PPO, SAC and behaviour cloning reach in at most 10 minutes of two cores, beside random actions and the scripted expert: a figure to compare with, not the best that can be reached.",
             f"Every policy sees the whole state, each number over its range (`observation=\"scaled\"`), and moves all of `actions=\"tip\"`; every seed is another start. Judged over unseen",
             f"seeds from {common.UNSEEN[0]} on, without noise. Our own short code: `samples/python/baselines`. `samples/python/baselines/run.py` trains, judges and renews this page, which is",
             "written from [baselines.json](baselines.json) (`--page` alone).", ""]
    asked = [(task, algorithm) for task in common.tasks() for algorithm in ALGORITHMS]
    missing = [f"{task}: {', '.join(NAMES[a] for t, a in asked if t == task and not any(r['task'] == t and r['algorithm'] == a for r in runs))}" for task in common.tasks()
               if any(t == task and not any(r["task"] == t and r["algorithm"] == a for r in runs) for t, a in asked)]
    for task in common.tasks():
        own = [run for run in runs if run["task"] == task]
        if not own:
            continue
        lines += [f"## {task}", "", f"An episode is cut off after {common.MOST_SECONDS.get(task, 60)} s.", "",
                  "| policy | seeds | trained | success, mean (least to most) | goals done | episodes each | machine, date |", "|---|---|---|---|---|---|---|"]
        for algorithm, name in NAMES.items():
            if chosen := [run for run in own if run["algorithm"] == algorithm]:
                lines.append(row(name, chosen))
        curves = [run for run in own if run["algorithm"] in ("ppo", "sac")]
        if curves:
            write_curve(PICTURES / f"{task}.svg", task, curves)
            lines += ["", f"![learning curves of {task}](images/baselines/{task}.svg)"]
        lines.append("")
    if missing:
        lines += ["## Not measured yet", "", "The command without options would train these, too, for 20 minutes of processor time and five seeds each:", "", *[f"- {one}" for one in missing], ""]
    PAGE.write_text("\n".join(lines).rstrip("\n") + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--task", action="append", choices=common.tasks(), help="only this one; may be repeated")
    parser.add_argument("--algorithm", action="append", choices=[*ALGORITHMS, "random", "expert"], help="only this one; may be repeated")
    parser.add_argument("--seeds", default="1:5", help="first and last seed of training")
    parser.add_argument("--minutes", type=float, default=20, help="of processor time for training, each (20: 10 minutes of two cores)")
    parser.add_argument("--episodes", type=int, default=len(common.UNSEEN), help="unseen seeds that it is judged on")
    parser.add_argument("--page", action="store_true", help="train nothing, only write the page")
    arguments = parser.parse_args()
    first, last = (int(part) for part in arguments.seeds.split(":"))
    for task in [] if arguments.page else arguments.task or common.tasks():
        for algorithm in arguments.algorithm or ["random", "expert", *ALGORITHMS]:
            for seed in range(first, last + 1) if algorithm in ALGORITHMS else [1]:
                minutes = arguments.minutes if algorithm in ALGORITHMS else 0
                if any((run["task"], run["algorithm"], run["seed"], run["minutes"]) == (task, algorithm, seed, minutes) for run in read()):
                    continue
                run = measure(task, algorithm, seed, minutes, arguments.episodes)
                print(f"{task} {NAMES[algorithm]}, seed {seed}: {100 * run['success']:.0f} % of {run['episodes']}, {100 * run['goals']:.0f} % of the goals", flush=True)
                write([*read(), run])
                write_page(read())
    write_page(read())
    return 0


if __name__ == "__main__":
    sys.exit(main())
