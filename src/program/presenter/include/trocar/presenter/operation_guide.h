// SPDX-License-Identifier: Apache-2.0
/// \file operation_guide.h  What comes next in an operation, in words with tool and key, and where: help for who has never seen one.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "trocar/assessment/milestone.h"
#include "trocar/presenter/key_bindings.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::presenter {

struct OperationStep {
  std::string_view
      text;  ///< with placeholders for keys; translated where it is shown; empty: nothing comes next
  std::optional<math::Vec3> target;  ///< where, world frame [m]
};

/// Texts of all steps, for translators.
std::span<const std::string_view> OperationStepTexts() noexcept;

/// From how the dissection stands, not from what was done so far: whoever does it in another order is told what is missing.
///
/// \param reached  of the operation so far
/// \pre the scene is an operation
OperationStep FindOperationStep(const scene::Scene& scene, std::span<const scene::StrandInfo> strands,
                                const simulation::Snapshot& now, assessment::Milestone reached);

/// A ring where the step is to be done; nothing without a target.
std::optional<view::Trail> MarkOperationStep(const OperationStep& step,
                                             const math::Pose& X_world_laparoscope);

}  // namespace trocar::presenter
