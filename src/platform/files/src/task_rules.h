// SPDX-License-Identifier: Apache-2.0
/// \file task_rules.h  Reading of a task's regions, goals and errors.
#pragma once

#include "trocar/host/json.h"
#include "trocar/scene/scene.h"

namespace trocar::files {

/// Reads "regions" and "rules" of a task file; complains in the view's document.
/// \param scene  with its objects, which the rules name
scene::Task ReadTaskRules(const host::JsonView& root, const scene::Scene& scene);

}  // namespace trocar::files
