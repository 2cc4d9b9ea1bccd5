// SPDX-License-Identifier: Apache-2.0
/// \file snapshot_samples.h  Snapshots in which every list has elements, and the values of a snapshot in a row, for tests.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "trocar/base/state_hash.h"
#include "trocar/math/random.h"
#include "trocar/simulation/snapshot_codec.h"
#include "trocar/simulation/snapshot_fields.h"

namespace trocar::simulation {

/// Visits with two functions.
template <typename OnValue, typename OnLength>
struct CallingVisitor {
  OnValue on_value;
  OnLength on_length;

  template <typename T>
  void Value(T& value) {
    on_value(value);
  }
  template <typename List>
  void Length(List& list) {
    on_length(list);
  }
};

/// \param on_value  called with each value  \param on_length  with each list before its elements
template <typename OnValue, typename OnLength>
void Visit(auto& snapshot, OnValue on_value, OnLength on_length) {
  CallingVisitor<OnValue, OnLength> visitor{on_value, on_length};
  VisitFields(snapshot, visitor);
}
template <typename OnValue>
void VisitValues(auto& snapshot, OnValue on_value) {
  Visit(snapshot, on_value, [](const auto&) {});
}

/// Every list has so many elements.
inline constexpr std::size_t kSampleLength = 3;

/// Of a scene that has some of everything.
inline SnapshotLayout MakeSampleLayout() {
  SnapshotLayout layout;
  Visit(
      layout.shape, [](auto&) {}, [](auto& list) { list.resize(kSampleLength); });
  // what lies behind a count may be anything
  layout.shape.event_count = kEventRing;
  layout.shape.fact_count = layout.shape.operation.topology.tube_piece_count = kSampleLength;
  layout.model = 0x0123456789abcdef;
  layout.surfaces = layout.neighbours = layout.rules = 4;
  layout.phases = layout.procedure_errors = 4;
  layout.tools = {4, 4};
  layout.goal_steps.assign(kSampleLength, 5);
  return layout;
}

/// The bits of all values, in the order of the visit; lengths of lists before their elements.
inline std::vector<std::uint64_t> BitsOf(const Snapshot& snapshot) {
  std::vector<std::uint64_t> bits;
  Visit(
      snapshot,
      [&](const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_same_v<T, double>) {
          bits.push_back(std::bit_cast<std::uint64_t>(value));
        } else if constexpr (std::is_same_v<T, float>) {
          bits.push_back(std::bit_cast<std::uint32_t>(value));
        } else {
          bits.push_back(static_cast<std::uint64_t>(value));
        }
      },
      [&](const auto& list) { bits.push_back(list.size()); });
  return bits;
}

/// Of these bits; quicker than a comparison of them.
inline std::uint64_t HashBits(const Snapshot& snapshot) {
  base::StateHash hash;
  Visit(
      snapshot,
      [&](const auto& value) {
        using T = std::remove_cvref_t<decltype(value)>;
        if constexpr (std::is_floating_point_v<T>) {
          hash.Add(static_cast<double>(value));
        } else {
          hash.Add(static_cast<std::uint64_t>(value));
        }
      },
      [&](const auto& list) { hash.Add(std::uint64_t{list.size()}); });
  return hash.Value();
}

/// Calls change(value) for the value of that number alone.
template <typename Change>
void ChangeValue(Snapshot& snapshot, std::size_t which, Change change) {
  std::size_t met = 0;
  VisitValues(snapshot, [&](auto& value) {
    if (met++ == which) change(value);
  });
}

inline std::size_t CountValues(const Snapshot& snapshot) {
  std::size_t count = 0;
  VisitValues(snapshot, [&](const auto&) { ++count; });
  return count;
}

/// Moves real numbers a little, most of them, and nothing else; the tick goes on.
inline void GoOn(Snapshot& snapshot, math::Random& random) {
  VisitValues(snapshot, [&](auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<T, double>) {
      if (random.Uniform() < 0.7) value += 1e-4 * (random.Uniform() - 0.5);
    } else if constexpr (std::is_same_v<T, float>) {
      if (random.Uniform() < 0.1) value = static_cast<float>(random.Uniform());
    }
  });
  ++snapshot.tick;
}

}  // namespace trocar::simulation
