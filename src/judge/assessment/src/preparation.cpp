// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/preparation.h"

#include <memory>
#include <system_error>
#include <utility>

#include "trocar/agent/surgeon.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/assessment/play_state.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/text_table.h"
#include "trocar/host/threads.h"
#include "trocar/host/user_folder.h"
#include "trocar/host/version.h"
#include "trocar/patient/patient.h"
#include "trocar/procedures/find_procedure.h"
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

base::Result<Preparation> Operate(const Step& step, const PreparationSettings& settings,
                                  std::shared_ptr<const scene::Scene> scene,
                                  simulation::Simulation simulation, Preparation preparation) {
  auto surgeon = agent::MakeSurgeon("expert", scene, settings.surgeon_seed);
  if (!surgeon.ok()) return surgeon.error();
  MilestoneWatch watch(scene::ProcedureOf(*scene));
  while (!watch.HasReached(step.from)) {
    const simulation::Snapshot& now = simulation.GetSnapshot();
    if ((*surgeon)->HasFinished() || now.time >= kMostSeconds) {
      return Error{ErrorCode::kPreparationFailed,
                   "the scripted expert came only to \"" + std::string(NameOf(watch.Reached())) + "\" in " +
                       host::FormatNumber(now.time, 4) + " s, and the step begins at \"" +
                       std::string(NameOf(step.from)) +
                       "\"; choose another patient for the step, or begin it at \"start\""};
    }
    simulation.Step((*surgeon)->Act(now));
    watch.See(simulation.GetSnapshot());
    if (settings.progress && simulation.GetSnapshot().tick % kProgressTicks == 0 &&
        !settings.progress(simulation.GetSnapshot().time, std::string((*surgeon)->Doing())))
      return Error{ErrorCode::kCancelled, "the preparation of the step was given up"};
  }
  preparation.seconds = simulation.GetSnapshot().time;
  if (const auto saved = SavePlay(preparation.state, preparation.surgeon, simulation, **surgeon); !saved.ok())
    return saved.error();
  return preparation;
}

}  // namespace

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
  const auto scene = std::make_shared<const scene::Scene>(std::move(**found));
  auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(settings.threads)});
  if (!simulation.ok()) return simulation.error();
  preparation.surgeon = "expert, seed " + std::to_string(settings.surgeon_seed);
  preparation.state = CacheOr(settings.cache) / "starts" /
                      (base::HashText(simulation->ModelFingerprint()) + "-" + std::string(NameOf(step.from)) +
                       "-seed-" + std::to_string(settings.surgeon_seed) + ".state");
  // a state that another version has left, or that is damaged, is made anew
  auto surgeon = agent::MakeSurgeon("expert", scene, settings.surgeon_seed);
  if (!surgeon.ok()) return surgeon.error();
  if (RestorePlay(preparation.state, preparation.surgeon, *simulation, **surgeon).ok()) {
    preparation.seconds = simulation->GetSnapshot().time;
    return preparation;
  }
  simulation->Reset();
  preparation.was_cached = false;
  return Operate(step, settings, scene, std::move(*simulation), std::move(preparation));
}

}  // namespace trocar::assessment
