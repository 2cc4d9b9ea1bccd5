// SPDX-License-Identifier: Apache-2.0
/// \file attempt_end.h  Whether an attempt was brought to its end: one answer for everything that asks.
#pragma once

#include "trocar/scene/task.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

/// A task ends by its own goals, also one in which there is an organ to operate on; only where there is no task, the operation's end
/// is the attempt's.
/// \param phase  kNone: there is no task
/// \param is_operation_completed  what is taken out has left the abdomen in its bag
constexpr bool HasCompleted(scene::TaskPhase phase, bool is_operation_completed) noexcept {
  return phase == scene::TaskPhase::kNone ? is_operation_completed : phase == scene::TaskPhase::kCompleted;
}
inline bool HasCompleted(const Snapshot& now) noexcept {
  return HasCompleted(now.task.phase, now.operation.is_completed);
}

}  // namespace trocar::simulation
