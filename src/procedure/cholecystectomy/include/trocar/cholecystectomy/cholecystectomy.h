// SPDX-License-Identifier: Apache-2.0
/// \file cholecystectomy.h  The cholecystectomy as a procedure, and the tissue of training tasks, which is judged alike.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "trocar/scene/procedure.h"

namespace trocar::cholecystectomy {

/// Rows of its measures.
enum Measure : std::size_t {
  kClearedShare,        ///< of the fat over the hepatocystic triangle's window
  kDetachedShare,       ///< of the bed's length, from the infundibulum on
  kStructuresEntering,  ///< tubes that enter the gallbladder and are not cut
  kMeasureCount
};
/// Rows of the critical view's criteria: the triangle, the cystic plate, two and only two structures.
enum Criterion : std::size_t { kTriangle, kPlate, kTwoStructures, kCriterionCount };
/// Rows of the sides from which it has to be seen.
enum Sight : std::size_t { kFromFront, kFromBehind, kSightCount };

const scene::Procedure& Cholecystectomy() noexcept;

/// Bands, sheets and ducts of a training task: the same errors and measures, which states of such tasks have always held, but no organ is
/// taken out and no view is asked for.
const scene::Procedure& TissueTask() noexcept;

}  // namespace trocar::cholecystectomy
