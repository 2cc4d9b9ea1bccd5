// SPDX-License-Identifier: Apache-2.0
/// \file task_rules.h  Reading of a task's regions, goals and errors.
#pragma once

#include "trocar/core/json.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// Reads "regions" and "rules" of a task file; complains in the view's document.
/// \param scene  with its objects, which the rules name
Task ReadTaskRules(const core::JsonView& root, const Scene& scene);

}  // namespace trocar::scene
