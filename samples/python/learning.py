# SPDX-License-Identifier: Apache-2.0
"""What the samples that learn share: networks, how a policy is judged on unseen seeds, and the picture of a learning curve."""
import os
from concurrent.futures import ThreadPoolExecutor

# small networks, beside simulations on every core: more threads of torch's would wait for each other. Before torch is there
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import torch

import trocar


def network(sizes, activation=torch.nn.Tanh):
    """Layers of the given widths with an activation between them."""
    layers = []
    for width, following in zip(sizes, sizes[1:]):
        layers += [torch.nn.Linear(width, following), activation()]
    return torch.nn.Sequential(*layers[:-1])


def columns(fields, names):
    """Places of named fields in a state or an action."""
    places = {field["name"]: range(field["first"], field["first"] + field["count"]) for field in fields}
    return [place for name in names for place in places[name]]


def play(task, seed, make_policy, tremble=0.0, patience=np.inf, **settings):
    """One episode of a layout: (success, share of the goals that were done, seconds).

    ``make_policy(environment, seed)`` gives a function from a state to an action. ``tremble`` is the spread of what is added to
    actions, by the seed: some tasks have one layout only. After ``patience`` seconds in which no step of a goal was done it is given up.
    """
    random = np.random.default_rng(seed)
    with trocar.make(task, seed=seed, **settings) as environment:
        policy = make_policy(environment, seed)
        state, _ = environment.reset(seed=seed)
        done, steps, is_over, last = 0.0, 0, False, 0
        most_idle = patience * 120 / environment.model.ticks_per_action
        while not is_over:
            action = policy(state)
            action = np.clip(action + tremble * random.standard_normal(action.shape), -1, 1)
            state, _, terminated, truncated, info = environment.step(action)
            done += info["features"]["goal"]
            steps += 1
            last = steps if info["features"]["step"] > 0 else last
            is_over = terminated or truncated or steps - last >= most_idle
        return info["is_success"], done, steps * environment.model.ticks_per_action / 120


def _gather(attempt, seeds, threads, show):
    """Shares of ``attempt``'s (success, goals done) over seeds; simulations step beside each other."""
    played = []
    with ThreadPoolExecutor(threads) as pool:
        for one in pool.map(attempt, seeds):
            played.append(one[:2])
            if len(played) % 20 == 0 or len(played) == len(seeds):
                success, done = np.mean(played, axis=0)
                show(f"{100 * success:.0f} % of {len(played)} attempts succeed, {100 * done:.1f} % of the goals are done")
    return tuple(float(share) for share in np.mean(played, axis=0))


def judge(task, seeds, make_policy, threads=2, show=lambda text: None, **settings):
    """(share of successes, mean share of goals done) over seeds; says how it goes after each 20. ``settings`` as of ``play``."""
    return _gather(lambda seed: play(task, seed, make_policy, **settings), seeds, threads, show)


def random_policy(environment, seed):
    environment.action_space.seed(seed)
    return lambda state: environment.action_space.sample()


def judge_expert(task, seeds, level="normal", most_seconds=600.0, threads=2, show=lambda text: None):
    """As ``judge`` of the scripted expert, which commands every tick; a seed is its hand's, too."""
    def attempt(seed):
        simulation = trocar.Simulation(task, level=level, seed=seed)
        surgeon = trocar.Surgeon("expert", simulation, seed=seed)
        while not surgeon.has_finished and simulation.time < most_seconds:
            simulation.play(surgeon, 120)
        state = simulation.snapshot()["task"]
        return state["phase"] == "completed", np.mean([goal["is_done"] for goal in state["goals"].values()])
    return _gather(attempt, seeds, threads, show)


def write_curve(path, title, x_label, x, curves):
    """A learning curve as SVG. ``curves``: name to values of 0 to 1, each as long as ``x``."""
    width, height, left, top, right, bottom = 640, 400, 60, 40, 150, 50
    across, up = width - left - right, height - top - bottom
    last = max(x[-1], 1e-9)
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="white"/>',
             f'<text x="{left}" y="24" font-size="15">{title}</text>',
             f'<text x="{left + across / 2}" y="{height - 12}" text-anchor="middle">{x_label}</text>']
    for share in (0, 0.25, 0.5, 0.75, 1):
        y = top + up * (1 - share)
        lines.append(f'<line x1="{left}" y1="{y}" x2="{left + across}" y2="{y}" stroke="#ddd"/>')
        lines.append(f'<text x="{left - 8}" y="{y + 4}" text-anchor="end">{100 * share:.0f} %</text>')
    for share in (0, 0.25, 0.5, 0.75, 1):
        lines.append(f'<text x="{left + share * across}" y="{top + up + 18}" text-anchor="middle">{share * last:.5g}</text>')
    colours = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd")
    for number, (name, values) in enumerate(curves.items()):
        points = " ".join(f"{left + across * a / last:.1f},{top + up * (1 - b):.1f}" for a, b in zip(x, values))
        colour, y = colours[number % len(colours)], top + 14 + 20 * number
        lines.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
        lines.append(f'<text x="{left + across + 10}" y="{y}" fill="{colour}">{name}</text>')
    with open(path, "w") as file:
        file.write("\n".join([*lines, "</svg>\n"]))


def print_results(results, seeds):
    """``results``: name to (successes, goals)."""
    print(f"over {len(seeds)} unseen seeds, {seeds[0]} to {seeds[-1]}:")
    print(f"{'policy':12} {'success':>8} {'goals done':>11}")
    for name, (success, goals) in results.items():
        print(f"{name:12} {100 * success:6.0f} % {100 * goals:9.1f} %")
