// SPDX-License-Identifier: Apache-2.0
/// \file preparation.h  Makes what a step of a course needs before it can begin: a patient that is generated, and the state from
/// which a part of an operation goes on. What takes long is kept in the user's cache folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "trocar/assessment/course.h"
#include "trocar/base/result.h"

namespace trocar::assessment {

struct PreparationSettings {
  std::filesystem::path cache;     ///< empty: host::FindCacheFolder
  int threads = 1;                 ///< of the solver; the bits are the same for any number
  std::uint64_t surgeon_seed = 1;  ///< of the scripted expert who operates up to the part
  /// Called now and then with the simulated time [s] and what the expert does; false gives up. May be empty.
  std::function<bool(double seconds, const std::string& doing)> progress;
};

struct Preparation {
  std::filesystem::path patient;  ///< folder; empty for the scene's own
  /// A file for --restore of trocar play: the state, and the memory of the expert who came so far. Empty where the step
  /// begins at the first tick.
  std::filesystem::path state;
  double seconds = 0;       ///< simulated time at which the part begins [s]
  std::string surgeon;      ///< who came so far, as SavePlay wrote it: "expert, seed 1"
  bool was_cached = false;  ///< nothing had to be computed
};

/// Generated patients lie in the cache by seed, settings and version of the program.
/// \return the folder, empty for the scene's own patient; the error of the generator
base::Result<std::filesystem::path> PreparePatient(const PatientChoice& patient,
                                                   const std::filesystem::path& cache = {});

/// Lets the scripted expert operate until the step's first moment, unless a state of this model lies in the cache.
/// \return kPreparationFailed where the expert does not come so far; kCancelled where progress gave up
base::Result<Preparation> PrepareStep(const Step& step, const PreparationSettings& settings = {});

}  // namespace trocar::assessment
