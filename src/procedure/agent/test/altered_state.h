// SPDX-License-Identifier: Apache-2.0
/// \file altered_state.h  Values that no hand of these courses brings about: put into a saved state, they show that it is
/// missed without them. What they are need not be likely, only another than before and of consequence.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <type_traits>

#include "trocar/math/vector.h"
#include "trocar/simulation/simulation.h"

namespace trocar::agent {

/// By field, what is done with its bytes.
using Alteration = std::map<std::string, std::function<void(std::span<std::byte>)>>;

template <typename T>
std::function<void(std::span<std::byte>)> SetTo(const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  return [=](std::span<std::byte> bytes) {
    ASSERT_GE(bytes.size(), sizeof(T));
    std::memcpy(bytes.last(sizeof(T)).data(), &value, sizeof(T));
  };
}

/// Every element of a list of plain values, whose length stays.
template <typename T>
std::function<void(std::span<std::byte>)> FillWith(const T& value) {
  return [=](std::span<std::byte> bytes) {
    // the list's own length is the word that says how much follows
    std::uint64_t count = 0;
    const auto read_count = [&] { std::memcpy(&count, bytes.data(), sizeof(count)); };
    for (read_count(); sizeof(count) + count * sizeof(T) != bytes.size(); read_count()) {
      ASSERT_GT(bytes.size(), 2 * sizeof(count));
      bytes = bytes.subspan(sizeof(count));
    }
    for (bytes = bytes.subspan(sizeof(count)); !bytes.empty(); bytes = bytes.subspan(sizeof(T)))
      std::memcpy(bytes.data(), &value, sizeof(T));
  };
}

inline const std::map<std::string, Alteration>& Alterations() {
  static const std::map<std::string, Alteration> alterations{
      // every vertex has come 20 mm too near to every wall of the cavity
      {"tight_cavity", {{"contacts/cavity_contacts/allowed", FillWith(std::array{0.02, 0.02, 0.02})}}},
      {"held_in_tight_cavity",
       {{"contacts/cavity_contacts/allowed", FillWith(std::array{0.02, 0.02, 0.02})},
        {"contacts/cavity_contacts/is_held", FillWith(std::uint8_t{1})}}},
      // the gallbladder has left the body
      {"completed",
       {{"operation/is_completed", SetTo(std::uint8_t{1})}, {"judge/was_completed", SetTo(std::uint8_t{1})}}},
      // the assistant holds as hard as no tissue bears, and it has been said
      {"crushed",
       {{"operation/assistant/grasp/damage_pinch", SetTo(0.0)},
        {"operation/assistant/grasp/is_damaged", SetTo(std::uint8_t{1})}}},
      // scissors that close in clip_and_cut come from beyond its duct
      {"blade_beyond_duct",
       {{"operation/left_hand/blade/a", SetTo(math::Vec3{0.02, 0.02, -0.14})},
        {"operation/left_hand/blade/b", SetTo(math::Vec3{0.02, 0.05, -0.14})}}},
      // what the bed lost in the last tick, that the triangle was seen, and the opening of a dissector that is not in the hand
      {"left_over_values",
       {{"operation/ooze/rate", SetTo(1e-6)},
        {"judge/dissection/facts/is_triangle_in_view", SetTo(std::uint8_t{1})},
        {"operation/right_hand/spread_upper/jaw", SetTo(-1.0)}}},
      // every object goes from the right hand to the left one
      {"handed_over",
       {{"task_monitor/from", SetTo(std::int32_t{1})}, {"task_monitor/to", SetTo(std::int32_t{0})}}}};
  return alterations;
}

/// \param name  of Alterations()
inline simulation::Simulation::AlterField FindAlteration(const std::string& name) {
  const Alteration& alteration = Alterations().at(name);
  return [&alteration](const std::string& field, std::span<std::byte> bytes) {
    if (const auto change = alteration.find(field); change != alteration.end()) change->second(bytes);
  };
}

}  // namespace trocar::agent
