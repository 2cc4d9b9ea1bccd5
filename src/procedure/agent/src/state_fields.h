// SPDX-License-Identifier: Apache-2.0
/// \file state_fields.h  Parts of a surgeon's memory as fields of a state.
#pragma once

#include <deque>
#include <string_view>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/state_fields.h"
#include "trocar/math/random.h"
#include "trocar/math/state_fields.h"
#include "trocar/scene/input.h"

namespace trocar::base {

template <>
inline constexpr bool kIsPlainState<scene::HandControls> = sizeof(scene::HandControls) == 5;

}  // namespace trocar::base

namespace trocar::agent {

/// A queue as a field, such as what is to be done next.
template <typename T>
void VisitQueue(base::StateArchive& archive, std::string_view name, std::deque<T>& queue) {
  std::vector<T> list(queue.begin(), queue.end());
  archive.Field(name, list);
  if (archive.IsRestoring()) queue.assign(list.begin(), list.end());
}

}  // namespace trocar::agent
