// SPDX-License-Identifier: Apache-2.0
#include "golden_play.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/task.h"
#if !defined(__EMSCRIPTEN__)
#include "trocar/anatomy/generate_patient.h"
#include "trocar/host/threads.h"
#endif

namespace trocar::bits {
namespace {

namespace fs = std::filesystem;

std::string OptionOf(const std::vector<std::string>& arguments, const std::string& option) {
  for (std::size_t i = 0; i + 1 < arguments.size(); ++i)
    if (arguments[i] == option) return arguments[i + 1];
  return {};
}

base::Error NotUnderstood(const std::string& golden) {
  return {base::ErrorCode::kUsage,
          "golden " + golden + ": scene_bits plays neither such a command nor such a name"};
}

#if defined(__EMSCRIPTEN__)
base::Result<fs::path> WriteGeneratedPatient(std::uint64_t, const fs::path&) {
  return base::Error{base::ErrorCode::kUsage, "no patient is made in a page; leave this golden out"};
}
base::Threads ThreadsOf(int) {
  return {};
}
#else
base::Threads ThreadsOf(int count) {
  return host::UseThreads(count);
}

/// The folder of a patient that is generated, written as `trocar anatomy generate` writes it.
base::Result<fs::path> WriteGeneratedPatient(std::uint64_t seed, const fs::path& scratch) {
  const auto patient = anatomy::GeneratePatient(seed);
  if (!patient.ok()) return patient.error();
  const fs::path folder = scratch / ("patient_" + std::to_string(seed));
  fs::remove_all(folder);
  fs::create_directories(scratch);
  if (const auto written = files::WritePatient(folder, *patient); !written.ok()) return written.error();
  return folder;
}
#endif

base::Result<scene::Scene> ReadGoldenScene(const Golden& golden, const fs::path& repository,
                                           const fs::path& patient_folder) {
  if (!golden.scene.empty()) return files::ReadScene(repository / golden.scene, patient_folder);
  constexpr std::uint64_t kSeed = 1;  // of `trocar play`
  auto operation = files::FindOperation(golden.task, patient_folder, kSeed);
  if (!operation.ok()) return operation.error();
  if (*operation) return std::move(**operation);
  const auto path = files::FindTask(golden.task);
  if (!path.ok()) return path.error();
  return files::ReadTask(*path, {.seed = kSeed, .patient_folder = patient_folder});
}

}  // namespace

base::Result<std::vector<Golden>> ReadGoldens(const fs::path& repository) {
  const fs::path file = repository / "tests" / "golden" / "goldens.json";
  std::ifstream stream(file);
  const auto document = nlohmann::json::parse(stream, nullptr, false);
  if (document.is_discarded() || !document.contains("goldens"))
    return base::Error{base::ErrorCode::kFileMissing, "no goldens can be read from " + file.string()};
  std::vector<Golden> goldens;
  for (const auto& entry : document.at("goldens")) {
    Golden golden;
    golden.name = entry.at("name").get<std::string>();
    golden.lane = entry.at("lane").get<std::string>();
    golden.hash = entry.at("hash").get<std::string>();
    const auto arguments = entry.at("arguments").get<std::vector<std::string>>();
    if (arguments.size() == 4 && arguments[0] == "simulate" && arguments[2] == "--ticks") {
      golden.scene = arguments[1];
      golden.ticks = std::stoull(arguments[3]);
    } else if (arguments.size() == 4 && arguments[0] == "play" && arguments[2] == "--task") {
      golden.surgeon = arguments[1];
      golden.task = OptionOf(arguments, "--task");
    } else {
      return NotUnderstood(golden.name);
    }
    if (const auto seed = entry.find("patient_seed"); seed != entry.end()) {
      golden.has_generated_patient = true;
      golden.patient_seed = seed->get<std::uint64_t>();
    }
    goldens.push_back(std::move(golden));
  }
  return goldens;
}

base::Result<GoldenPlay> GoldenPlay::Make(const Golden& golden, const fs::path& repository,
                                          const fs::path& scratch, int threads) {
  fs::path patient_folder;
  if (golden.has_generated_patient) {
    auto folder = WriteGeneratedPatient(golden.patient_seed, scratch);
    if (!folder.ok()) return folder.error();
    patient_folder = std::move(*folder);
  }
  auto read = ReadGoldenScene(golden, repository, patient_folder);
  if (!read.ok()) return read.error();
  auto shared = std::make_shared<const scene::Scene>(std::move(*read));
  std::unique_ptr<agent::Surgeon> surgeon;
  if (!golden.surgeon.empty()) {
    auto made = agent::MakeSurgeon(golden.surgeon, shared, 1);
    if (!made.ok()) return made.error();
    surgeon = std::move(*made);
  }
  auto simulation = simulation::Simulation::Make(shared, {.threads = ThreadsOf(threads)});
  if (!simulation.ok()) return simulation.error();
  GoldenPlay play(std::move(shared), std::move(*simulation), std::move(surgeon));
  if (golden.ticks > 0) play.most_ticks_ = golden.ticks;
  if (play.scene_->operation)
    play.most_seconds_ = std::min(play.most_seconds_, play.scene_->operation->level.time_limit);
  return play;
}

GoldenPlay::GoldenPlay(std::shared_ptr<const scene::Scene> scene, simulation::Simulation simulation,
                       std::unique_ptr<agent::Surgeon> surgeon)
    : scene_(std::move(scene)), simulation_(std::move(simulation)), surgeon_(std::move(surgeon)) {}

bool GoldenPlay::IsOver() const {
  const simulation::Snapshot& seen = simulation_.GetSnapshot();
  if (surgeon_ == nullptr) return seen.tick >= most_ticks_;
  return surgeon_->HasFinished() || seen.time >= most_seconds_;
}

scene::Input GoldenPlay::DecideInput() {
  const simulation::Snapshot& seen = simulation_.GetSnapshot();
  return surgeon_ != nullptr ? surgeon_->Act(seen) : scene::CalcScriptInput(*scene_, seen.time);
}

}  // namespace trocar::bits
