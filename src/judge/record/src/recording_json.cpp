// SPDX-License-Identifier: Apache-2.0
#include "recording_json.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "trocar/base/state_hash.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"

namespace trocar::record {
namespace {

using nlohmann::ordered_json;

constexpr std::array<const char*, 3> kKinds = {"scene", "task", "operation"};

constexpr std::uint64_t kMostEngineBits = 1'000'000;

/// It holds the outcome as a text, with an escape for each of its quotes.
constexpr host::JsonLimits kEndingLimits{4u << 20, 4, 100, 100, 2u << 20};

/// \return null where the text is no JSON, or more than belongs here; neither is any part of a recording
ordered_json Parse(std::string_view text, const host::JsonLimits& limits) {
  auto json = host::ParseJson<ordered_json>(text, "", limits);
  return json.ok() ? std::move(*json) : ordered_json();
}

bool ReadHex(const ordered_json& json, const char* key, std::uint64_t& value) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return false;
  const auto& text = found->get_ref<const std::string&>();
  if (text.size() != 16 || text.find_first_not_of("0123456789abcdef") != std::string::npos) return false;
  value = std::stoull(text, nullptr, 16);
  return true;
}

bool ReadText(const ordered_json& json, const char* key, std::string& value) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) return false;
  value = found->get<std::string>();
  return true;
}

bool ReadCount(const ordered_json& json, const char* key, std::uint64_t& value) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number_unsigned()) return false;
  value = found->get_ref<const ordered_json::number_unsigned_t&>();
  return true;
}

std::string Dump(const ordered_json& json) {
  return host::FormatJson(json);
}

}  // namespace

std::string WriteDescription(const Description& d) {
  ordered_json json = {{"kind", kKinds[static_cast<std::size_t>(d.kind)]},
                       {"name", d.name},
                       {"level", d.level},
                       {"patient", d.patient},
                       {"seed", d.seed},
                       {"tick_seconds", d.tick_seconds},
                       {"model", base::HashText(d.model)},
                       {"first_tick", d.first_tick},
                       {"player", d.player},
                       {"program", d.program},
                       {"model_kind", static_cast<int>(d.model_kind)},
                       {"engine_bits", d.engine_bits},
                       {"compiler", d.compiler},
                       {"started", d.started}};
  if (!d.branched_from.empty()) {
    json["branched"] = {
        {"from", d.branched_from}, {"id", base::HashText(d.branched_id)}, {"tick", d.branched_tick}};
  }
  return Dump(json);
}

bool ReadDescription(std::string_view text, Description& d) {
  const ordered_json json = Parse(text, host::kSmallJson);
  if (!json.is_object()) return false;
  std::string kind;
  if (!ReadText(json, "kind", kind)) return false;
  std::size_t k = 0;
  while (k < kKinds.size() && kind != kKinds[k]) ++k;
  if (k == kKinds.size()) return false;
  d.kind = static_cast<Description::Kind>(k);
  const auto tick_seconds = json.find("tick_seconds");
  if (tick_seconds == json.end() || !tick_seconds->is_number()) return false;
  d.tick_seconds = tick_seconds->get<double>();
  if (const auto branched = json.find("branched"); branched != json.end()) {
    if (!branched->is_object() || !ReadText(*branched, "from", d.branched_from) ||
        !ReadHex(*branched, "id", d.branched_id) || !ReadCount(*branched, "tick", d.branched_tick))
      return false;
  }
  // older files do not say
  if (std::uint64_t model_kind = 1; json.contains("model_kind")) {
    if (!ReadCount(json, "model_kind", model_kind) || model_kind < 1 || model_kind > 2) return false;
    d.model_kind = static_cast<simulation::ModelFingerprintKind>(model_kind);
  }
  if (std::uint64_t bits = 1; json.contains("engine_bits")) {
    if (!ReadCount(json, "engine_bits", bits) || bits > kMostEngineBits) return false;
    d.engine_bits = static_cast<int>(bits);
  }
  return d.tick_seconds > 0 && std::isfinite(d.tick_seconds) && ReadText(json, "name", d.name) &&
         ReadText(json, "level", d.level) && ReadText(json, "patient", d.patient) &&
         ReadCount(json, "seed", d.seed) && ReadHex(json, "model", d.model) &&
         ReadCount(json, "first_tick", d.first_tick) && ReadText(json, "player", d.player) &&
         ReadText(json, "program", d.program) && ReadText(json, "compiler", d.compiler) &&
         ReadText(json, "started", d.started);
}

std::string WriteEnding(const Ending& ending) {
  return Dump({{"ticks", ending.ticks}, {"hash", base::HashText(ending.hash)}, {"outcome", ending.outcome}});
}

bool ReadEnding(std::string_view text, Ending& ending) {
  const ordered_json json = Parse(text, kEndingLimits);
  return json.is_object() && ReadCount(json, "ticks", ending.ticks) && ReadHex(json, "hash", ending.hash) &&
         ReadText(json, "outcome", ending.outcome);
}

ordered_json EventJson(const scene::Event& event, const scene::Procedure* procedure) {
  const bool is_verdict = event.kind == surgery::FactKind::kVerdict;
  if (const surgery::ErrorRow* error = is_verdict ? scene::FindError(procedure, event.error) : nullptr) {
    return {{"tick", event.tick},
            {"kind", error->name},
            {"about", error->explanation},
            {"hand", event.hand},
            {"error", true}};
  }
  return {{"tick", event.tick}, {"kind", surgery::FactName(event.kind)}, {"hand", event.hand}};
}

ordered_json TaskErrorJson(const scene::Task& task, std::uint64_t tick, const scene::TaskError& error) {
  const scene::ErrorRule& rule = task.errors[static_cast<std::size_t>(error.rule)];
  return {{"tick", tick}, {"kind", rule.name}, {"about", rule.about}, {"hand", error.hand}, {"error", true}};
}

ordered_json PhaseJson(std::uint64_t tick, std::string_view phase) {
  return {{"tick", tick}, {"kind", kPhaseKind}, {"about", phase}, {"hand", -1}};
}

bool ReadEvents(std::string_view text, std::vector<EventMark>& events) {
  const ordered_json json = Parse(text, {});
  if (!json.is_array()) return false;
  for (const ordered_json& entry : json) {
    EventMark event;
    if (!entry.is_object() || !ReadCount(entry, "tick", event.tick) || !ReadText(entry, "kind", event.kind))
      return false;
    ReadText(entry, "about", event.about);
    if (const auto hand = entry.find("hand"); hand != entry.end() && hand->is_number_integer())
      event.hand = static_cast<int>(hand->get_ref<const ordered_json::number_integer_t&>());
    event.is_error = entry.contains("error") && entry.at("error") == true;
    events.push_back(std::move(event));
  }
  return true;
}

}  // namespace trocar::record
