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

/// Simulation of the scene that the options name, ready to run.
base::Result<simulation::Simulation> MakeChosenSimulation(const Options& options);

/// A loaded scene, and where it begins unless that is the first tick.
struct LoadedScene {
  simulation::Simulation simulation;
  std::optional<centre::Start> start;
};
/// Loads the scene that the options name; a part of an operation begins where the scripted expert has left it.
base::Result<LoadedScene> MakeChosenScene(const Options& options, const PartProgress& progress);

/// Simulation for a step of a course or an exam, at its beginning: the first tick, or where the expert has left an operation.
/// \return the scene's error; kStateInvalid where the state is of another scene
base::Result<simulation::Simulation> MakeStartedSimulation(const Options& options,
                                                           const centre::Start& start);

/// Description for a recording of the chosen scene. \param scene  as chosen
record::Description DescribeChosenScene(const Options& options, const scene::Scene& scene);

/// Name of what holds the instruments: "mouse and keyboard", a device's name.
std::string DescribeHands(const Options& options);

}  // namespace trocar::presenter
