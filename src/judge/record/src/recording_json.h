// SPDX-License-Identifier: Apache-2.0
// The parts of a recording that are text.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "trocar/record/recording.h"
#include "trocar/scene/event.h"
#include "trocar/scene/procedure.h"
#include "trocar/scene/task.h"

namespace trocar::record {

/// In the word before a chunk's inputs, with their count: they can be decoded without those before.
inline constexpr std::uint32_t kNewRow = 1u << 31;

std::string WriteDescription(const Description& description);
/// \return false where the text is no description
bool ReadDescription(std::string_view text, Description& description);

std::string WriteEnding(const Ending& ending);
bool ReadEnding(std::string_view text, Ending& ending);

/// \param procedure  whose verdicts there are; null where there are none
nlohmann::ordered_json EventJson(const scene::Event& event, const scene::Procedure* procedure);
nlohmann::ordered_json TaskErrorJson(const scene::Task& task, std::uint64_t tick,
                                     const scene::TaskError& error);
/// A phase of an operation that begins.
nlohmann::ordered_json PhaseJson(std::uint64_t tick, std::string_view phase);
/// Appends a list of them.
bool ReadEvents(std::string_view text, std::vector<EventMark>& events);

}  // namespace trocar::record
