// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "trocar/anatomy/ct_phantom.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/bench/benchmark.h"
#include "trocar/contours/growth_rehearsal.h"
#include "trocar/host/progress_bar.h"
#include "trocar/host/text_table.h"
#include "work_folder.h"

namespace trocar::bench {
namespace {

using images::CtPhase;

/// The figures that a simulated user must reach (docs/contours.md).
constexpr double kLeastLiver = 0.95, kLeastGallbladder = 0.85;

base::Result<images::LabelVolume> FindMap(const BenchmarkOptions& options, std::uint64_t seed) {
  if (options.labels.empty()) {
    const auto patient = anatomy::GeneratePatient(seed);
    if (!patient) return patient.error();
    return anatomy::DrawLabels(*patient);
  }
  auto map = images::ReadLabelVolume(options.labels);
  const auto largest =
      map.ok() && !map->labels.empty() ? *std::max_element(map->labels.begin(), map->labels.end()) : 0;
  // the Visible Human's reference names nothing
  if (map.ok() && map->names.empty() && largest == 6) map->names = anatomy::VisibleHumanLabels();
  return map;
}

base::Result<std::vector<contours::GrowthTrial>> Try(const images::LabelVolume& map, CtPhase phase,
                                                     std::uint64_t seed, bool uses_prior) {
  images::CtSettings settings;
  settings.phase = phase, settings.seed = seed;
  const auto phantom = anatomy::MakeCtPhantom(map, settings);
  if (!phantom) return phantom.error();
  const WorkFolder folder;
  if (auto made = folder.Status(); !made) return made.error();
  if (auto status = anatomy::WriteCtPhantom(folder.Path() / "ct", *phantom); !status) return status.error();
  auto workspace = contours::ContourWorkspace::Open({folder.Path() / "ct" / "slices", {}, {}, {}});
  if (!workspace) return workspace.error();
  contours::GrowingUser user;
  user.uses_prior = uses_prior;
  return contours::RehearseGrowth(*workspace, phantom->labels, user, seed);
}

/// Of the trials of one organ in one phase.
struct Sums {
  int count = 0, clicks = 0, dragged = 0, drawn = 0;
  double grown = 0, corrected = 0, least = 1, seconds = 0;
  void Add(const contours::GrowthTrial& trial) {
    ++count;
    clicks += trial.clicks, dragged += trial.dragged, drawn += trial.drawn;
    grown += trial.dice_grown, corrected += trial.dice_corrected, seconds += trial.seconds;
    least = std::min(least, trial.dice_corrected);
  }
};

void AddCases(const std::string& name, const Sums& sums, BenchmarkResult& result) {
  const auto add = [&](const char* what, double value, const char* unit) {
    result.cases.push_back({name + ", " + what, value, unit});
  };
  const double n = sums.count;
  add("Dice grown", sums.grown / n, "1");
  add("Dice corrected", sums.corrected / n, "1");
  add("least Dice corrected", sums.least, "1");
  add("clicks", sums.clicks / n, "");
  add("points dragged", sums.dragged / n, "");
  add("slices drawn", sums.drawn / n, "");
  add("time to grow", sums.seconds / n, "s");
}

}  // namespace

base::Result<BenchmarkResult> RunGrowthBenchmark(const BenchmarkOptions& options) {
  BenchmarkResult result;
  std::map<std::string, Sums> all;  // by phase and organ
  host::ProgressBar bar("growing", 3.0 * options.repeats);
  int done = 0;
  for (int i = 0; i < options.repeats; ++i) {
    const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(i);
    const auto map = FindMap(options, seed);
    if (!map) return map.error();
    for (const CtPhase phase : {CtPhase::kNone, CtPhase::kArterial, CtPhase::kPortalVenous}) {
      bar.Show(done++);
      const auto trials = Try(*map, phase, seed, true);
      if (!trials) return trials.error();
      for (const contours::GrowthTrial& trial : *trials) {
        const std::string name = std::string(NameOf(phase)) + ", " + trial.organ;
        all[name].Add(trial);
        if (!trial.refusal.empty())
          result.notes.push_back(name + ", seed " + std::to_string(seed) + ": refused, " + trial.refusal);
      }
    }
  }
  bar.Finish();
  for (const auto& [name, sums] : all) AddCases(name, sums, result);
  result.notes.push_back(
      "CT phantoms: 0.8 mm pixels, 3 mm slices, noise 12 HU. Dice over all slices, those between contours by "
      "shape. The figures to reach: liver " +
      host::FormatNumber(kLeastLiver) + ", gallbladder " + host::FormatNumber(kLeastGallbladder));
  return result;
}

}  // namespace trocar::bench
