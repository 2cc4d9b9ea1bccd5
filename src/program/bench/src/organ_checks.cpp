// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>

#include "trocar/base/statistics.h"
#include "trocar/bench/physics_checks.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/progress_bar.h"
#include "trocar/host/text_table.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"

namespace trocar::bench {
namespace {

/// The target of a tick [s].
constexpr double kTickTarget = 0.004;

}  // namespace

base::Result<PhysicsCheck> CheckVolume(const std::filesystem::path& path) {
  auto read = files::ReadScene(path);
  if (!read.ok()) return read.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation.ok()) return simulation.error();
  const double duration = scene->script.Duration();
  const auto ticks = static_cast<int>(std::lround(duration / scene->tick_seconds));
  PhysicsCheck check{
      "Volume of each organ while both hands work",
      "\"" + scene->name + "\" with its script of " + host::FormatNumber(duration) +
          " s: at every tick the volume enclosed by each organ's surface against what is inside, and the "
          "pressure that keeps it. The time is one thread's on this machine, in this build.",
      {},
      {"Pressure inside above outside", "time [s]", "pressure [Pa]"},
      {}};
  const auto& organs = scene->patient.organs;
  std::vector<double> errors(organs.size(), 0.0), seconds;
  for (std::size_t i = 0; i < std::min<std::size_t>(organs.size(), 6); ++i)
    check.lines.push_back({organs[i].name, {}});
  host::ProgressBar progress("playing " + scene->name, ticks);
  for (int tick = 0; tick < ticks; ++tick) {
    simulation->Step(scene::CalcScriptInput(*scene, simulation->GetSnapshot().time));
    const simulation::Snapshot& now = simulation->GetSnapshot();
    seconds.push_back(now.tick_seconds);
    for (std::size_t i = 0; i < organs.size(); ++i) {
      errors[i] = std::max(errors[i], std::fabs(now.organs[i].volume / now.organs[i].target - 1.0));
      if (i < check.lines.size()) check.lines[i].points.push_back({now.time, now.organs[i].pressure});
    }
    progress.Show(tick);
  }
  progress.Finish();
  for (std::size_t i = 0; i < organs.size(); ++i) {
    check.figures.push_back({"largest volume error, " + organs[i].name, 100 * errors[i], 0.0, 0.01, "%"});
  }
  std::sort(seconds.begin(), seconds.end());
  const auto percentile = [&](double share) {
    return seconds.empty() ? std::nan("")
                           : 1e3 * seconds[static_cast<std::size_t>(share * double(seconds.size() - 1))];
  };
  check.figures.push_back({"time per tick, median", percentile(0.5), 0.0, 1e3 * kTickTarget, "ms"});
  check.figures.push_back({"time per tick, 99 of 100", percentile(0.99), 0.0, 1e3 * kTickTarget, "ms", true});
  return check;
}

base::Result<PhysicsCheck> CheckTickRate(const std::filesystem::path& path, double time) {
  std::vector<std::vector<math::Vec3>> ends;
  std::vector<math::Vec3> start;
  const std::vector<double> rates{60, 120, 240};
  host::ProgressBar progress("three tick rates", static_cast<double>(rates.size()));
  for (const double rate : rates) {
    auto read = files::ReadScene(path);
    if (!read.ok()) return read.error();
    read->tick_seconds = 1.0 / rate;
    const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
    auto simulation = simulation::Simulation::Make(scene);
    if (!simulation.ok()) return simulation.error();
    start = simulation->GetSnapshot().positions;
    const auto ticks = static_cast<int>(std::lround(time * rate));
    for (int tick = 0; tick < ticks; ++tick) {
      simulation->Step(scene::CalcScriptInput(*scene, simulation->GetSnapshot().time));
    }
    // the hands hold still until the tissue has come to rest
    for (int tick = 0; tick < 120; ++tick) simulation->Step(scene::CalcScriptInput(*scene, time));
    ends.push_back(simulation->GetSnapshot().positions);
    progress.Show(static_cast<double>(ends.size()));
  }
  progress.Finish();
  double largest = 0;
  for (std::size_t i = 0; i < start.size(); ++i)
    largest = std::max(largest, math::Distance(ends[1][i], start[i]));
  PhysicsCheck check{
      "Tick-rate independence",
      "The script is played for " + host::FormatNumber(time) +
          " s at 60, 120 and 240 ticks a second, then the hands hold still for 120 ticks; the largest "
          "distance of a node from where 120 a second put it, over the largest displacement. What the "
          "hands take between the jaws depends a little on when the jaws are seen to close.",
      {},
      {},
      {}};
  for (const std::size_t other : {0u, 2u}) {
    double apart = 0;
    for (std::size_t i = 0; i < start.size(); ++i)
      apart = std::max(apart, math::Distance(ends[other][i], ends[1][i]));
    check.figures.push_back({"difference at " + host::FormatNumber(rates[other]) + " a second",
                             100 * apart / largest, 0.0, 5.0, "%"});
  }
  return check;
}

}  // namespace trocar::bench
