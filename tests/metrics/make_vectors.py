# SPDX-License-Identifier: Apache-2.0
"""The test vectors of the metrics: motions of known shape. tools/check-metrics --write tests/metrics/vectors runs it.

"metrics" is what tools/check-metrics computes; "analytic" is what a formula says, with a tolerance and the reason.
"""
import json
import math
import random


def reach(t, start, seconds):
    """Part of a minimum-jerk movement that is done at a time."""
    s = min(max((t - start) / seconds, 0.0), 1.0)
    return s**3 * (10 - 15 * s + 6 * s * s)


def columns(ticks, dt, functions):
    """Columns of a hand or the laparoscope, rounded to a nanometre."""
    def rounded(value):
        return [round(x, 9) for x in value] if isinstance(value, (list, tuple)) else round(value, 9)

    return {name: [rounded(function(i * dt)) for i in range(ticks)] for name, function in functions.items()}


def trace(rate, seconds, left, right=None, camera=None, **rest):
    dt, ticks = 1 / rate, round(seconds * rate) + 1
    made = {"format": "trocar-trace", "version": 1, "dt": dt, "ticks": ticks, "tool_names": ["grasper"], "organ_names": [],
            "hands": {"left": columns(ticks, dt, left), "right": columns(ticks, dt, right or {})}}
    if camera:
        made["camera"] = columns(ticks, dt, camera)
    made.update(rest)
    return made


def known(metric, value, tolerance, why, hand="left"):
    return {"metric": metric, "hand": hand, "value": value, "tolerance": tolerance, "why": why}


def straight_reach():
    made = trace(120, 3, {"tip": lambda t: (0.12 * reach(t, 0.5, 2), 0.16 * reach(t, 0.5, 2), -0.1),
                          "insertion": lambda t: 0.1 + 0.05 * reach(t, 0.5, 2)})
    return "A straight minimum-jerk reach of 200 mm in 2 s, with half a second of rest before and after; the right hand is still.", made, [
        known("path_length", 0.2, 4e-4, "length of the line; up to a noise step is lost at the end"),
        known("path_sum", 0.2, 1e-6, "length of the line"),
        known("path_sum", 0, 0, "a still hand", "right"),
        known("max_speed", 1.875 * 0.2 / 2, 5e-4, "1.875 L / T of a minimum-jerk movement"),
        known("depth_path", 0.05, 5e-4, "change of the insertion"),
        known("movements", 1, 0, "one reach"),
        known("movement_straightness", 1, 1e-9, "a straight line"),
        known("sparc", -1.41, 0.04, "minimum-jerk movement: healthy reaching"),
        known("idle_fraction", 0.39, 0.015, "1 s of rests, and 30 s^2 (1 - s)^2 L / T < 5 mm/s for 0.17 s of the reach; less, as that is averaged over 0.2 s"),
        known("path_length", 0, 0, "a still hand", "right"),
        known("movements", 0, 0, "a still hand", "right"),
        known("idle_fraction", 1, 0, "a still hand", "right")]


def circle():
    rate, cone = 2 * math.pi / 4, math.pi / 6
    made = trace(60, 8, {
        "tip": lambda t: (0.03 * math.cos(rate * t), 0.03 * math.sin(rate * t), -0.1),
        "axis": lambda t: (math.sin(cone) * math.cos(rate * t), math.sin(cone) * math.sin(rate * t), -math.cos(cone)),
        "spin": lambda t: math.remainder(math.pi * t / 8 + 2.5, 2 * math.pi),
        "insertion": lambda t: 0.12 + 0.01 * math.sin(rate * t)},
        ideal_path={"left": 2 * math.pi * 0.03}, outcome={"phase": "completed", "is_completed": True, "task_time": 8})
    return "Two rounds of a circle of 30 mm in 8 s; the shaft sweeps a cone of 30 degrees, the spin goes half a turn and wraps.", made, [
        known("path_length", 4 * math.pi * 0.03, 1e-3, "two circumferences"),
        known("economy_of_motion", 0.5, 2e-3, "once round would have been enough"),
        known("path_sum", 480 * 2 * 0.03 * math.sin(rate / 120), 1e-6, "480 chords"),
        known("economy_sum", 0.5, 1e-3, "once round would have been enough"),
        known("spin_path", math.pi, 0.01, "half a turn"),
        known("angular_path", math.pi + 4 * math.pi * math.sin(cone), 0.03, "spin, and two circles of latitude"),
        known("angular_area", 2 * cone, 0.01, "the cone's whole angle, both ways"),
        known("angular_volume", (4 * cone * cone * 0.02) ** (1 / 3), 0.005, "both angles and 20 mm of depth"),
        known("depth_path", 0.08, 2e-3, "four times the amplitude of 10 mm, twice"),
        known("mean_speed", 0.03 * rate, 5e-4, "radius times angular speed"),
        known("movements", 1, 0, "it never stops")]


def staircase():
    def place(t):
        return sum(reach(t, 0.3 + 1.5 * i, 0.8) for i in range(5))

    made = trace(100, 7.8, {"tip": lambda t: (0.02 * place(t), 0.0, -0.1 - 0.015 * place(t)),
                            "insertion": lambda t: 0.1 + 0.015 * place(t)})
    return "Five steps of 25 mm, each a minimum-jerk reach of 0.8 s, with 0.7 s of rest between them.", made, [
        known("movements", 5, 0, "five steps"),
        known("path_length", 0.125, 1e-3, "five steps of 25 mm"),
        known("depth_path", 0.075, 1e-3, "five steps of 15 mm"),
        known("idle_fraction", 0.5, 0.1, "the rests"),
        known("movement_straightness", 1, 1e-6, "each step is straight")]


def two_hands():
    def sway(shift):
        return lambda t: (0.05 * math.sin(2 * t + shift), 0.0, -0.1)

    def in_turn(t):
        return sway(0)(t) if t < 10 else sway(math.pi / 2)(t)

    made = trace(50, 20, {"tip": sway(0), "tool": lambda t: 1 if 5 <= t < 8 else 0}, {"tip": in_turn},
                 # no step of these lies just at the noise step, where rounding would decide
                 {"lens": lambda t: (0.0, 0.0013 * t, -0.05), "direction": lambda t: (0.0, math.cos(0.013 * t), -math.sin(0.013 * t)),
                  "roll": lambda t: 0.02 * t - 0.1},
                 tool_names=["grasper", "hook"],
                 phases=[{"name": "Preparation", "start": 0, "end": 10}, {"name": "ClippingCutting", "start": 10, "end": 15},
                         {"name": "Preparation", "start": 15, "end": 20}])
    return "Both hands sway, together in the first half and in turn in the second; the left changes its tool; three spans of two phases.", made, [
        known("bimanual_fraction", 1 - 1.5 * 2 / math.pi * math.asin(0.05), 0.005, "slower than 5 of 100 mm/s near each turn", ""),
        known("tool_exchanges", 2, 0, "to the hook and back"),
        known("path_length", 0.026, 5e-4, "the lens moves 1.3 mm/s", "camera"),
        known("view_angular_path", 0.26, 0.005, "0.013 rad/s", "camera"),
        known("view_roll_max", 0.3, 1e-9, "the last tick", "camera")]


def noise():
    source = random.Random(22)

    def trembling(place):
        return lambda t: tuple(x + source.gauss(0, 2e-4) for x in place(t))

    made = trace(120, 4, {"tip": trembling(lambda t: (0.1 * reach(t, 0.5, 3), 0, -0.1))}, {"tip": trembling(lambda t: (0, 0.1, -0.1))})
    return "A reach of 100 mm in 3 s and a still hand, both with tracker noise of 0.2 mm rms on each axis.", made, [
        known("path_length", 0.1, 0.006, "the line; noise adds little"),
        known("path_length", 0, 0.02, "a still hand", "right"),
        known("path_sum", 480 * math.sqrt(2) * 2e-4 * math.sqrt(8 / math.pi), 0.012,
              "480 steps of a Maxwell distribution: without a filter a still hand travels", "right"),
        known("movements", 0, 0, "a still hand", "right")]


def acts():
    def force(t):
        return 5 * (1 - abs(t % 2 - 1))

    left = {"force": force, "in_view": lambda t: int(not 2 <= t < 3), "in_contact": lambda t: int(force(t) > 1),
            "grasping": lambda t: int(1 <= t < 1.5), "press": lambda t: 0.004 * force(t) / 5,
            "touching_tool": lambda t: int(4 <= t < 4.2 or 4.4 <= t < 4.5 or 6 <= t < 6.1)}
    right = {"tool": lambda t: 0, "pedal": lambda t: int(1 <= t < 3), "has_current": lambda t: int(1.5 <= t < 2.5),
             "duct_distance": lambda t: 0.02 - 0.009 * (t - 0.5) if 1.5 <= t < 2.5 else -1, "in_contact": lambda t: int(1.5 <= t < 2.5)}

    def event(time, kind, hand, **rest):
        return {"time": time, "kind": kind, "hand": hand, "organ": -1, **rest}

    events = [event(0.9, "grasp_missed", 0), event(1, "grasp", 0), event(1.5, "slip", 0), event(2, "grasp", 0),
              event(3, "release", 0), event(3.4, "tear", 0), event(5.5, "grasp", 0), event(5.6, "pinch_damage", 0),
              event(2, "liver_grasped", 0, severity="minor", text="Liver was grasped"),
              event(4, "energy_near_duct", 1, severity="major"), event(5, "wire_touched", -1, severity="minor", is_rule=True),
              event(7, "wrong_structure_cut", 1, severity="critical")]
    events.sort(key=lambda e: e["time"])
    made = trace(50, 8, left, right, is_operation=True, events=events, tool_names=["hook"], organ_names=["cystic_duct"],
                 phases=[{"name": "Preparation", "start": 0, "end": 4}, {"name": "ClippingCutting", "start": 4, "end": 8}],
                 clips=[{"time": 4.5, "hand": 1, "vessel": "cystic_duct", "gap": 0.003, "angle": 1.3},
                        {"time": 5.0, "hand": 1, "vessel": "cystic_duct", "gap": 0.003, "angle": 1.5},
                        {"time": 5.5, "hand": 1, "is_lost": True},
                        {"time": 6.5, "hand": 1, "vessel": "cystic_duct", "gap": 0.006, "is_misplaced": True, "angle": 0.9}],
                 fluids=[{"time": float(t), "blood": 1e-6 * max(0, t - 3), "bile": 0.0} for t in range(9)],
                 goals=[{"name": "clip", "points": 10.0, "time": 6.5}, {"name": "cut", "points": 10.0}],
                 stones_spilled=3, stones_lost=1, critical_view_time=4.2,
                 outcome={"phase": "running", "is_completed": False, "score": 12.5, "task_time": 7.5})
    return "Two still hands that grasp, press, burn, clip and err: everything that is no motion.", made, [
        known("max_force", 5, 1e-9, "the triangle's top"),
        known("force_excess", 4 * 0.5 * 2 * 0.8, 2e-3, "four triangles, 2 N high and 0.8 s wide, above 3 N"),
        known("force_exceedances", 4, 0, "four triangles"),
        known("out_of_view_time", 1, 1e-9, "from 2 s to 3 s"),
        known("grasp_efficiency", 0.75, 1e-12, "three of four"),
        known("regrasps", 1, 0, "at 2 s; the one at 5.5 s is 2.5 s after letting go"),
        known("instrument_collisions", 2, 0, "the second follows within half a second", ""),
        known("cautery_time", 1, 1e-9, "from 1.5 s to 2.5 s", "right"),
        known("cautery_efficiency", 0.5, 1e-9, "1 s of 2 s", "right"),
        known("cautery_duct_distance", 0.02 - 0.009 * 1.98, 1e-9, "the last tick with current", "right"),
        known("blood_lost", 5e-6, 1e-15, "1 mL/s for 5 s", ""),
        known("clips_placed", 3, 0, "one of four is lost", ""),
        known("errors", 4, 0, "three of the operation, one rule", ""),
        known("goals_done_fraction", 0.5, 0, "one of two", "")]


def write(folder, calc):
    folder.mkdir(parents=True, exist_ok=True)
    for make in (straight_reach, circle, staircase, two_hands, noise, acts):
        about, made, analytic = make()
        vector = {"format": "trocar-metric-vector", "version": 1, "about": about, "trace": made, "metrics": calc(made),
                  "analytic": analytic}
        text = json.dumps(vector, separators=(",", ":"))
        for key in ('"trace":', '"hands":', '"right":', '"metrics":', '"analytic":', '{"metric"'):
            text = text.replace(key, "\n" + key)
        (folder / f"{make.__name__}.json").write_text(text + "\n", encoding="utf-8")
        values = {(v["metric"], v["hand"]): v["value"] for v in reversed(vector["metrics"]) if not v["phase"] and not v["tool"]}
        for entry in analytic:
            value = values[entry["metric"], entry["hand"]]
            mark = "" if abs(value - entry["value"]) <= entry["tolerance"] else "   NOT WITHIN"
            print(f"{make.__name__:16} {entry['hand']:7}{entry['metric']:24}{value:12.6g} formula {entry['value']:.6g} +- {entry['tolerance']:g}{mark}")
