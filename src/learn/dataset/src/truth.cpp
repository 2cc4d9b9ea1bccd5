// SPDX-License-Identifier: Apache-2.0
#include "truth.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <span>

#include "trocar/host/safe_file.h"
#include "trocar/roles/roles.h"
#include "trocar/scene/procedure.h"

namespace trocar::dataset {
namespace {

constexpr const char* kHands[] = {"left", "right"};
static_assert(std::size(kHands) == instrument::kHandCount);

constexpr std::string_view kHead =
    "frame,number,time_s,phase,own_phase,doing,triangle_cleared,plate_detached,structures_entering,"
    "criterion_structures,criterion_triangle,criterion_plate,clips,left_tool,left_holds,left_force_N,left_"
    "act,"
    "right_tool,right_holds,right_force_N,right_act,facts\n";

/// The fewest digits that are read back as the same number.
std::string Shortest(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// A field that may hold anything.
std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string NameAct(const cholecystectomy::Triplet& act) {
  std::string name(NameOf(act.instrument));
  name += ':';
  name += NameOf(act.verb);
  name += ':';
  name += NameOf(act.target);
  return name;
}

}  // namespace

TruthTable::TruthTable(const simulation::Simulation& simulation) : text_(kHead) {
  for (const scene::SurfaceInfo& surface : simulation.Surfaces())
    surfaces_.emplace_back(surface.radii.empty() ? roles::NameOf(surface.organ)
                                                 : roles::NameOf(surface.tube));
  for (const scene::StrandInfo& strand : simulation.Strands())
    strands_.emplace_back(roles::NameOf(strand.kind));
}

void TruthTable::Look(const simulation::Snapshot& now) {
  for (const surgery::Fact& fact : std::span(now.facts).first(now.fact_count)) {
    if (fact.hand < 0) continue;
    std::string name = kHands[fact.hand];
    name += ':';
    name += surgery::FactName(fact.kind);
    name += ':';
    if (fact.strand >= 0) {
      name += strands_[static_cast<std::size_t>(fact.strand)];
    } else if (fact.surface >= 0) {
      name += surfaces_[static_cast<std::size_t>(fact.surface)];
    }
    name += fact.is_coagulating ? ":coagulate" : ":";
    ++facts_[name];
  }
}

std::string TruthTable::NameHeld(const simulation::Snapshot& now, std::size_t hand) const {
  const simulation::InstrumentSnapshot& tool = now.instruments[hand];
  return tool.is_grasping && tool.organ >= 0 ? surfaces_[static_cast<std::size_t>(tool.organ)]
                                             : std::string();
}

void TruthTable::Add(std::size_t index, std::uint64_t number, const Player& player,
                     const std::vector<Act>& acts) {
  const simulation::Snapshot& now = player.GetSimulation().GetSnapshot();
  const simulation::OperationSnapshot& operation = now.operation;
  const auto own = player.OwnPhase();
  const scene::Procedure* const procedure = scene::ProcedureOf(player.GetSimulation().GetScene());
  const scene::ViewScore& view = operation.procedure.view;
  const auto measure = [&](std::string_view name) {
    return scene::MeasureOf(procedure, operation.procedure, name);
  };
  const auto add = [&](std::string_view field) {
    text_ += field;
    text_ += ',';
  };
  add(std::to_string(index));
  add(std::to_string(number));
  add(Shortest(now.time));
  add(scene::PhaseName(procedure, operation.procedure.phase));
  add(own ? scene::PhaseName(procedure, *own) : std::string_view());
  add(Quote(player.Doing()));
  add(Shortest(measure("cleared_share")));
  add(Shortest(measure("detached_share")));
  add(Shortest(measure("structures_entering")));
  add(std::to_string(view.Points(2)));
  add(std::to_string(view.Points(0)));
  add(std::to_string(view.Points(1)));
  add(std::to_string(operation.clip_count));
  for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand) {
    add(Quote(ToolOf(player.GetSimulation().GetScene(), now, hand).name));
    add(NameHeld(now, hand));
    add(Shortest(math::Norm(now.instruments[hand].force)));
    const auto act = std::find_if(acts.begin(), acts.end(), [&](const Act& one) { return one.hand == hand; });
    add(act == acts.end() ? std::string() : NameAct(act->triplet));
  }
  bool is_first = true;
  for (const auto& [name, count] : facts_) {
    if (!is_first) text_ += ';';
    is_first = false;
    text_ += name + ":" + std::to_string(count);
  }
  text_ += '\n';
  facts_.clear();
}

base::Status TruthTable::Write(const std::filesystem::path& path) const {
  return host::WriteFile(path, text_);
}

}  // namespace trocar::dataset
