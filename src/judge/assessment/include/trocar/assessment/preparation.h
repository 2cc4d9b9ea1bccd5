// SPDX-License-Identifier: Apache-2.0
/// \file preparation.h  Makes what a step of a course needs before it can begin: a patient that is generated, and the state from
/// which a part of an operation goes on. What takes long is delivered with the program, or kept in the user's cache folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trocar/assessment/course.h"
#include "trocar/assessment/milestone.h"
#include "trocar/base/result.h"
#include "trocar/simulation/simulation.h"

namespace trocar::assessment {

/// How far the expert is.
struct PreparationProgress {
  double seconds = 0;                  ///< simulated time [s]
  std::string doing;                   ///< the expert's own words
  double share = 0;                    ///< of the way to the step's first moment [-]; never less than before
  std::optional<double> seconds_left;  ///< by the clock, estimated [s]; nothing where it is not known
  bool is_late = false;                ///< it takes longer than foreseen
};

struct PreparationSettings {
  std::filesystem::path cache;  ///< empty: host::FindCacheFolder
  /// States that came with the program; nothing: kDeliveredStates of the data folder; an empty path: none.
  std::optional<std::filesystem::path> delivered;
  std::filesystem::path states;    ///< where new ones are kept; empty: starts/ of the cache
  int threads = 1;                 ///< of the solver; the bits are the same for any number
  std::uint64_t surgeon_seed = 1;  ///< of the scripted expert who operates up to the part
  /// Called now and then, at the end with the share 1; false gives up. May be empty.
  std::function<bool(const PreparationProgress&)> progress;
};

/// Folder of the data folder with the states that a package brings along.
inline constexpr const char* kDeliveredStates = "parts";

struct Preparation {
  std::filesystem::path patient;  ///< folder; empty for the scene's own
  /// A file for --restore of trocar play: the state, and the memory of the expert who came so far. Empty where the step
  /// begins at the first tick.
  std::filesystem::path state;
  double seconds = 0;          ///< simulated time at which the part begins [s]
  std::string surgeon;         ///< who came so far, as SavePlay wrote it: "expert, seed 1"
  bool was_cached = false;     ///< nothing had to be computed
  bool was_delivered = false;  ///< with the program
};

/// Generated patients lie in the cache by seed, settings and version of the program.
/// \return the folder, empty for the scene's own patient; the error of the generator
base::Result<std::filesystem::path> PreparePatient(const PatientChoice& patient,
                                                   const std::filesystem::path& cache = {});

/// Name of the file of a state: model, engine and who came so far.
std::string PreparedFileName(const simulation::Simulation& simulation, Milestone from,
                             std::uint64_t surgeon_seed);

/// Lets the scripted expert operate until the step's first moment, unless a state of this model by this engine was delivered or lies in
/// the cache; from the last moment before it of which there is one. States of the moments between are kept as well.
/// \return kPreparationFailed where the expert does not come so far; kCancelled where progress gave up
base::Result<Preparation> PrepareStep(const Step& step, const PreparationSettings& settings = {});

/// The course's steps that begin in the middle of an operation, once for each level. Of steps that begin with the same state the first.
/// \return the error of the levels' file
base::Result<std::vector<Step>> ListPreparedSteps(const Course& course);

}  // namespace trocar::assessment
