// SPDX-License-Identifier: Apache-2.0
/// \file tissue_benchmark_patient.cpp  The whole tick on the built-in patient, both hands pulling for a
/// minute.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tissue_benchmark.h"
#include "trocar/base/statistics.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/progress_bar.h"
#include "trocar/host/text_table.h"
#include "trocar/host/threads.h"
#include "trocar/simulation/simulation.h"

namespace trocar::bench {
namespace {

// What is asked of the true error in every tick [-].
constexpr double kErrorLimit = 1e-3;

}  // namespace

base::Status RunPatientCases(const BenchmarkOptions& options, BenchmarkResult& result) {
  const base::Result<std::filesystem::path> folder = host::FindDataFolder();
  if (!folder) return folder.error();
  base::Result<scene::Scene> read = files::ReadScene(*folder / "scenes/retraction.json");
  if (!read) return read.error();
  const auto scene = std::make_shared<const scene::Scene>(std::move(read).value());
  base::Result<simulation::Simulation> made =
      simulation::Simulation::Make(scene, {.threads = host::UseThreads(options.threads)});
  if (!made) return made.error();
  const int ticks = static_cast<int>(scene->script.Duration() / scene->tick_seconds) + 1;
  std::vector<double> tick_ms(static_cast<std::size_t>(ticks), INFINITY), errors;
  double volume_error = 0;
  std::vector<double> volumes;
  int unsettled = 0;
  std::uint64_t first_hash = 0;
  const int repeats = std::max(2, options.repeats);
  host::ProgressBar bar("the patient's script, the first time judged", repeats);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    made->Reset();
    for (int tick = 0; tick < ticks; ++tick) {
      bar.Show(repeat + static_cast<double>(tick) / ticks);
      const scene::Input input = scene::CalcScriptInput(*scene, tick * scene->tick_seconds);
      const host::Stopwatch stopwatch;
      made->Step(input);
      // the same work in every run: the shortest time is the one that nothing else disturbed
      double& ms = tick_ms[static_cast<std::size_t>(tick)];
      ms = std::min(ms, 1e3 * stopwatch.Seconds());
      if (repeat > 0) continue;
      for (const auto& organ : made->GetSnapshot().organs) {
        volume_error = std::max(volume_error, std::fabs(organ.volume / organ.target - 1.0));
      }
      const double error = made->CalcEquilibriumError();
      std::isfinite(error) ? errors.push_back(error) : void(++unsettled);
    }
    if (repeat == 0) first_hash = made->Hash();
    if (made->Hash() != first_hash)
      return WrongAnswer("patient/tick_p99", "two runs of the script end in different states");
    if (!std::isfinite(made->GetSnapshot().residual))
      return WrongAnswer("patient/tick_p99", "the residual is not finite");
  }
  bar.Finish();
  result.cases.push_back({"patient/nodes", static_cast<double>(made->GetSnapshot().positions.size()), "1"});
  result.cases.push_back({"patient/ticks", static_cast<double>(ticks), "1"});
  result.cases.push_back({"patient/tick_median", base::CalcPercentile(tick_ms, 0.5), "ms"});
  result.cases.push_back({"patient/tick_p99", base::CalcPercentile(tick_ms, 0.99), "ms"});
  result.cases.push_back({"patient/tick_max", base::CalcPercentile(tick_ms, 1.0), "ms"});
  result.cases.push_back({"patient/judged_ticks", static_cast<double>(errors.size()), "1"});
  result.cases.push_back({"patient/unsettled_ticks", static_cast<double>(unsettled), "1"});
  const auto is_over = [](double error) { return error > kErrorLimit; };
  result.cases.push_back({"patient/ticks_over_true_error_0.001",
                          static_cast<double>(std::count_if(errors.begin(), errors.end(), is_over)), "1"});
  result.cases.push_back({"patient/true_error_median", base::CalcPercentile(errors, 0.5), "1"});
  result.cases.push_back({"patient/true_error_p90", base::CalcPercentile(errors, 0.9), "1"});
  result.cases.push_back({"patient/true_error_max", base::CalcPercentile(errors, 1.0), "1"});
  result.cases.push_back({"patient/volume_error_max", volume_error, "1"});
  return {};
}

}  // namespace trocar::bench
