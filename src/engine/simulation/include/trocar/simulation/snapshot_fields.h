// SPDX-License-Identifier: Apache-2.0
/// \file snapshot_fields.h  Every value of a snapshot. Fields are counted, not listed: what somebody adds is visited.
#pragma once

#include <type_traits>

#include "trocar/base/fields.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::simulation {

/// Calls visitor.Value(leaf) for every number, truth value and enumerator, and visitor.Length(list) before the elements of a
/// list, in an order that is fixed.
/// \param value  a Snapshot or a part of one, const or not
template <typename T, typename Visitor>
void VisitFields(T& value, Visitor& visitor) {
  using Plain = std::remove_const_t<T>;
  if constexpr (std::is_arithmetic_v<Plain> || std::is_enum_v<Plain>) {
    visitor.Value(value);
  } else if constexpr (base::kIsList<Plain>) {
    visitor.Length(value);
    for (auto& element : value) VisitFields(element, visitor);
  } else if constexpr (base::kIsFixedList<Plain>) {
    for (auto& element : value) VisitFields(element, visitor);
  } else {
    base::ForEachField(value, [&](auto& field) { VisitFields(field, visitor); });
  }
}

}  // namespace trocar::simulation
