// SPDX-License-Identifier: Apache-2.0
/// \file ideal_path.h  Reading of a task's ideal path: the way that each tip would take in straight lines.
#pragma once

#include "trocar/host/json.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Reads "ideal_path" of a task file into Task::ideal_path; complains in the view's document.
/// \param scene  with its instruments, objects and model, which the stops name
/// \param task   with its regions
void ReadIdealPath(const host::JsonView& root, const scene::Scene& scene, scene::Task& task);

}  // namespace trocar::files
