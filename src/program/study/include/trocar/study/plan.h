// SPDX-License-Identifier: Apache-2.0
/// \file plan.h  A study as a file: parameters x patients x surgeons x seeds become runs. schemas/study-plan.schema.json has its form.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/scene/scene.h"

namespace trocar::study {

/// Parameter of a scene that a study may vary, besides patient, surgeon and seed.
struct Parameter {
  std::string_view name, about;
  double low, high;
  void (*apply)(scene::Scene& scene, double value);
};
/// "stiffness_scale", "gravity", "solver_max_error", ...
std::span<const Parameter> Parameters() noexcept;

/// The values that one parameter takes.
struct ParameterValues {
  std::string name;
  std::vector<double> values;
};

/// A moment of an operation at which a run may end.
enum class Until : std::uint8_t {
  kEnd,           ///< none: it goes on to its end
  kCriticalView,  ///< "critical_view": achieved, and seen from both sides
  kFree           ///< "free": what is taken out hangs on nothing
};

struct StudyPlan {
  std::string name, about;
  std::string task = procedures::kUsualProcedure, level = "normal";
  std::vector<std::string> surgeons{"expert"};
  std::vector<std::filesystem::path> patients{""};  ///< folders; "" is the scene's own
  std::vector<std::string> patient_prints{""};      ///< (patients) fingerprint of what each folder holds
  std::uint64_t first_seed = 1, last_seed = 1;      ///< both included
  std::vector<ParameterValues> parameters;          ///< every combination of their values
  double most_seconds = 1800;                       ///< of a run, simulated
  Until until = Until::kEnd;
};

/// \return kStudyInvalid with the field, or the file's error
base::Result<StudyPlan> ReadPlan(const std::filesystem::path& path);

/// One cell of the table.
struct Run {
  std::size_t index = 0;
  std::string key;  ///< SHA-256 of the inputs, 32 digits of it
  std::string surgeon;
  std::filesystem::path patient;
  std::uint64_t seed = 0;
  std::vector<double> values;  ///< (StudyPlan::parameters)
};
/// Parameters change slowest, seeds quickest. Equal inputs have equal keys, whatever the plan's name.
std::vector<Run> ListRuns(const StudyPlan& plan);

/// 32 digits of the SHA-256 of a text, or of a file's bytes. \return as of host::CalcSha256OfFile
std::string Fingerprint(std::string_view text);
base::Result<std::string> FingerprintFile(const std::filesystem::path& path);

}  // namespace trocar::study
