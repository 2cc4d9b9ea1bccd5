// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/fact.h"

#include <array>

namespace trocar::surgery {
namespace {

constexpr std::array<std::string_view, kFactKindCount> kNames = {"grasp",
                                                                 "release",
                                                                 "slip",
                                                                 "grasp_missed",
                                                                 "state_restored",
                                                                 "organ_frozen",
                                                                 "tear",
                                                                 "pinch_damage",
                                                                 "tools_touch",
                                                                 "exchange_refused",
                                                                 "clip_closed",
                                                                 "tube_cut",
                                                                 "no_clips_left",
                                                                 "used_outside",
                                                                 "clip_slipped",
                                                                 "stone_spilled",
                                                                 "stone_taken",
                                                                 "stone_retrieved",
                                                                 "operation_error",
                                                                 "strand_cut",
                                                                 "strand_spread",
                                                                 "organ_cut",
                                                                 "organ_opened",
                                                                 "organ_burnt",
                                                                 "tube_burnt",
                                                                 "tube_torn_off",
                                                                 "clip_lost",
                                                                 "current_on",
                                                                 "current_into",
                                                                 "rinse",
                                                                 "aspirate",
                                                                 "bag_open",
                                                                 "tool_exchanged"};
static_assert(kNames.back() == "tool_exchanged");

}  // namespace

std::string_view FactName(FactKind kind) noexcept {
  return kNames[static_cast<std::size_t>(kind)];
}

}  // namespace trocar::surgery
