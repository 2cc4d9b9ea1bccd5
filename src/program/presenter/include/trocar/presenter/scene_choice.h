// SPDX-License-Identifier: Apache-2.0
/// \file scene_choice.h  Which scene the simulator window plays: a file, a training task or an operation, by its name.
#pragma once

#include <optional>
#include <string>

#include "trocar/centre/course_page.h"
#include "trocar/presenter/operation_part.h"
#include "trocar/presenter/options.h"
#include "trocar/record/recording.h"
#include "trocar/simulation/simulation.h"

namespace trocar::presenter {

/// The scene that the options name; the demonstration where they name none. `task` may be a training task or, as for
/// `trocar play`, an operation: a scene of the data folder that has one.
///
/// \return kUnknownName with what is known, or the file's error
base::Result<scene::Scene> ReadChosenScene(const Options& options);

/// Likewise, ready to run.
base::Result<simulation::Simulation> MakeChosenSimulation(const Options& options);

/// What was read, and where it begins where that is not the first tick.
struct LoadedScene {
  simulation::Simulation simulation;
  std::optional<centre::Start> start;
};
/// Likewise; a part of an operation where the scripted expert has left it.
base::Result<LoadedScene> MakeChosenScene(const Options& options, const PartProgress& progress);

/// What a step of a course or an exam asks for, where it begins: at the first tick, or where the expert has left an operation.
/// \return the scene's error; kStateInvalid where the state is of another scene
base::Result<simulation::Simulation> MakeStartedSimulation(const Options& options,
                                                           const centre::Start& start);

/// What a recording of it is of. \param scene  as chosen
record::Description DescribeChosenScene(const Options& options, const scene::Scene& scene);

/// Who holds the instruments: "mouse and keyboard", a device's name.
std::string DescribeHands(const Options& options);

}  // namespace trocar::presenter
