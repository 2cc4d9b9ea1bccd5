// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/preparation.h"

#include <algorithm>
#include <memory>
#include <system_error>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/assessment/play_state.h"
#include "trocar/assessment/preparation_forecast.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/operation_level_file.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/text_table.h"
#include "trocar/host/threads.h"
#include "trocar/host/user_folder.h"
#include "trocar/host/version.h"
#include "trocar/patient/patient.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/simulation/engine_bits.h"
#include "trocar/simulation/simulation.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr double kMostSeconds = 3600;         // that the expert operates [s]
constexpr std::uint64_t kProgressTicks = 60;  // between two calls

fs::path CacheOr(const fs::path& cache) {
  return cache.empty() ? host::FindCacheFolder() : cache;
}

/// Name in the cache: the same patient of the same program has the same.
std::string PatientName(const PatientChoice& patient) {
  base::StateHash hash;
  base::AddStateTo(hash, patient.Text() + "; " + std::string(host::VersionText()));
  return "patient-" + std::to_string(*patient.seed) + "-" + base::HashText(hash.Value());
}

/// The expert, the operation, and where its states lie.
class PartState {
 public:
  /// \param scene  of the operation
  static base::Result<PartState> Make(std::shared_ptr<const scene::Scene> scene,
                                      const PreparationSettings& settings) {
    auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(settings.threads)});
    if (!simulation.ok()) return simulation.error();
    PartState state(std::move(scene), std::move(*simulation), settings);
    if (const auto made = state.Begin(); !made.ok()) return made.error();
    return state;
  }

  /// Goes to a moment of which there is a state. \return false where there is none that fits; then it stands at the first tick
  base::Result<bool> Find(Milestone milestone, Preparation& preparation) {
    const std::string name = PreparedFileName(simulation_, milestone, settings_->surgeon_seed);
    for (const fs::path& folder : {Delivered(), Kept()}) {
      std::error_code ignored;
      if (folder.empty() || !fs::is_regular_file(folder / name, ignored)) continue;
      // one that another version has left, or that is damaged, is made anew
      if (RestorePlay(folder / name, who_, simulation_, *surgeon_).ok()) {
        preparation.state = folder / name;
        preparation.was_delivered = folder != Kept();
        preparation.seconds = simulation_.GetSnapshot().time;
        return true;
      }
      if (const auto begun = Begin(); !begun.ok()) return begun.error();
    }
    return false;
  }

  /// Operates up to the moment, and keeps it and those on the way.
  base::Status OperateUpTo(Milestone target, Milestone reached, Preparation& preparation) {
    MilestoneWatch watch(scene::ProcedureOf(*scene_));
    watch.Begin(reached);
    PreparationForecast forecast(reached, target, simulation_.GetSnapshot().time, ClockSeconds());
    while (!watch.HasReached(target)) {
      const simulation::Snapshot& now = simulation_.GetSnapshot();
      if (surgeon_->HasFinished() || now.time >= kMostSeconds) return Refuse(watch.Reached(), target);
      simulation_.Step(surgeon_->Act(now));
      const Milestone before = watch.Reached();
      watch.See(simulation_.GetSnapshot());
      if (watch.Reached() != before) {
        const fs::path path =
            Kept() / PreparedFileName(simulation_, watch.Reached(), settings_->surgeon_seed);
        if (const auto saved = SavePlay(path, who_, simulation_, *surgeon_); !saved.ok()) return saved;
        preparation.state = path;
      }
      if ((watch.HasReached(target) || simulation_.GetSnapshot().tick % kProgressTicks == 0) &&
          !Tell(forecast, watch.Reached()))
        return Error{ErrorCode::kCancelled, "the preparation of the step was given up"};
    }
    preparation.seconds = simulation_.GetSnapshot().time;
    return {};
  }

  const std::string& Who() const { return who_; }

 private:
  PartState(std::shared_ptr<const scene::Scene> scene, simulation::Simulation simulation,
            const PreparationSettings& settings)
      : scene_(std::move(scene)),
        simulation_(std::move(simulation)),
        settings_(&settings),
        who_("expert, seed " + std::to_string(settings.surgeon_seed)) {}

  static double ClockSeconds() { return static_cast<double>(host::NowNanoseconds()) * 1e-9; }

  /// The first tick, and an expert who has done nothing.
  base::Status Begin() {
    simulation_.Reset();
    auto surgeon = agent::MakeSurgeon("expert", scene_, settings_->surgeon_seed);
    if (!surgeon.ok()) return surgeon.error();
    surgeon_ = std::move(*surgeon);
    return {};
  }
  fs::path Kept() const {
    return settings_->states.empty() ? CacheOr(settings_->cache) / "starts" : settings_->states;
  }
  /// \return empty: nothing came with the program
  fs::path Delivered() const {
    if (settings_->delivered) return *settings_->delivered;
    const auto data = host::FindDataFolder();
    return data.ok() ? *data / kDeliveredStates : fs::path();
  }
  bool Tell(PreparationForecast& forecast, Milestone reached) const {
    if (!settings_->progress) return true;
    const double seconds = simulation_.GetSnapshot().time;
    forecast.See(reached, seconds, ClockSeconds());
    return settings_->progress({seconds, std::string(surgeon_->Doing()), forecast.Share(),
                                forecast.SecondsLeft(), forecast.IsLate()});
  }
  Error Refuse(Milestone reached, Milestone target) const {
    return {ErrorCode::kPreparationFailed,
            "the scripted expert came only to \"" + std::string(NameOf(reached)) + "\" in " +
                host::FormatNumber(simulation_.GetSnapshot().time, 4) + " s, and the step begins at \"" +
                std::string(NameOf(target)) +
                "\"; choose another patient for the step, or begin it at \"start\""};
  }

  std::shared_ptr<const scene::Scene> scene_;
  simulation::Simulation simulation_;
  const PreparationSettings* settings_;
  std::string who_;
  std::unique_ptr<agent::Surgeon> surgeon_;
};

Milestone Before(Milestone milestone) {
  return static_cast<Milestone>(static_cast<int>(milestone) - 1);
}

}  // namespace

std::string PreparedFileName(const simulation::Simulation& simulation, Milestone from,
                             std::uint64_t surgeon_seed) {
  return base::HashText(simulation.ModelFingerprint()) + "-" + std::string(NameOf(from)) + "-seed-" +
         std::to_string(surgeon_seed) + "-engine-" + std::to_string(simulation::kEngineBits) + ".state";
}

base::Result<fs::path> PreparePatient(const PatientChoice& patient, const fs::path& cache) {
  if (!patient.seed) return patient.folder;
  const fs::path folder = CacheOr(cache) / "patients" / PatientName(patient);
  std::error_code ignored;
  if (fs::is_regular_file(folder / "patient.json", ignored)) return folder;
  const auto made = anatomy::GeneratePatient(*patient.seed, patient.settings);
  if (!made.ok()) return made.error();
  if (const auto written = files::WritePatient(folder, *made); !written.ok()) return written.error();
  return folder;
}

base::Result<Preparation> PrepareStep(const Step& step, const PreparationSettings& settings) {
  Preparation preparation;
  if (!step.IsOperation()) return preparation;
  auto patient = PreparePatient(step.patient, settings.cache);
  if (!patient.ok()) return patient.error();
  preparation.patient = std::move(*patient);
  preparation.was_cached = true;
  if (step.from == Milestone::kStart) return preparation;
  auto found = files::FindOperation(step.operation, preparation.patient, settings.surgeon_seed, step.level);
  if (!found.ok()) return found.error();
  if (!*found) {
    return Error{ErrorCode::kUnknownName, "there is no operation \"" + step.operation + "\"; delivered is " +
                                              std::string(procedures::kUsualProcedure)};
  }
  auto part = PartState::Make(std::make_shared<const scene::Scene>(std::move(**found)), settings);
  if (!part.ok()) return part.error();
  preparation.surgeon = part->Who();
  // the moment itself, else the last one before it
  for (Milestone reached = step.from; reached != Milestone::kStart; reached = Before(reached)) {
    const auto is_found = part->Find(reached, preparation);
    if (!is_found.ok()) return is_found.error();
    if (!*is_found) continue;
    if (reached == step.from) return preparation;
    preparation.was_cached = preparation.was_delivered = false;
    if (const auto done = part->OperateUpTo(step.from, reached, preparation); !done.ok()) return done.error();
    return preparation;
  }
  preparation.was_cached = false;
  if (const auto done = part->OperateUpTo(step.from, Milestone::kStart, preparation); !done.ok())
    return done.error();
  return preparation;
}

base::Result<std::vector<Step>> ListPreparedSteps(const Course& course) {
  const auto levels = files::ListOperationLevels();
  if (!levels.ok()) return levels.error();
  std::vector<Step> steps;
  const auto add = [&steps](Step step, const std::string& level) {
    step.level = level;
    const bool is_known = std::any_of(steps.begin(), steps.end(), [&](const Step& other) {
      return other.operation == step.operation && other.level == step.level && other.from == step.from &&
             other.patient.Text() == step.patient.Text();
    });
    if (!is_known) steps.push_back(std::move(step));
  };
  // level by level: the state of a part that comes later goes on from the one before
  for (const scene::OperationLevel& level : *levels) {
    for (const Step& step : course.steps) {
      if (step.IsOperation() && step.from != Milestone::kStart) add(step, level.key);
    }
  }
  return steps;
}

}  // namespace trocar::assessment
