// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/read_outs.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>

#include "trocar/host/translate.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/procedure.h"

namespace trocar::presenter {
namespace {

std::string WithSpaces(std::string_view name) {
  std::string label(name);
  std::replace(label.begin(), label.end(), '_', ' ');
  return label;
}

std::string Capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

template <typename... Values>
std::string Print(const char* format, Values... values) {
  char text[96];
  std::snprintf(text, sizeof text, format, values...);
  return host::LocalNumber(text);
}

}  // namespace

ForceThresholds FindForceThresholds(roles::OrganRole organ) noexcept {
  return roles::IsHollow(organ) ? ForceThresholds{8.0, 12.0} : ForceThresholds{3.0, 6.0};
}

ForceLevel JudgeForce(double force, const ForceThresholds& thresholds) noexcept {
  if (force < thresholds.warning) return ForceLevel::kCalm;
  return force < thresholds.danger ? ForceLevel::kWarning : ForceLevel::kDanger;
}

std::string FormatForce(double force) {
  return std::isfinite(force) ? Print("%.1f N", force) : "— N";
}

std::string FormatMilliseconds(double seconds) {
  return std::isfinite(seconds) ? Print("%.2f ms", 1e3 * seconds) : "— ms";
}

std::string FormatTime(double seconds) {
  if (!(seconds >= 0.0) || !std::isfinite(seconds)) return "—";
  const auto tenths = static_cast<long long>(seconds * 10.0 + 0.5);
  return Print("%lld:%02lld.%lld", tenths / 600, tenths / 10 % 60, tenths % 10);
}

TaskReadOut DescribeTask(const scene::Task& task, const scene::TaskSnapshot& now) {
  using scene::TaskPhase;
  TaskReadOut text;
  text.time = FormatTime(now.time);
  if (std::isfinite(task.time_limit)) text.time += " / " + FormatTime(task.time_limit);
  const auto done =
      std::count_if(now.goals.begin(), now.goals.end(), [](const auto& goal) { return goal.is_done; });
  text.progress =
      host::TranslateWith("{1} of {2}", {std::to_string(done), std::to_string(task.goals.size())});
  text.score = now.IsOver() ? Print("%.1f", scene::CalcShownScore(task, now)) : "—";
  switch (now.phase) {
    case TaskPhase::kCompleted:
      text.next = host::Translate("Completed. Reset to try again.");
      break;
    case TaskPhase::kTimeOver:
      text.next = host::Translate("The time is over. Reset to try again.");
      break;
    case TaskPhase::kEnded:
      text.next = host::Translate("Ended by an error. Reset to try again.");
      break;
    default:
      for (std::size_t g = 0; g < task.goals.size() && text.next.empty(); ++g) {
        if (now.phase == TaskPhase::kReady || now.goals[g].is_open)
          text.next = host::TranslateWith("Next: {1}", {host::TranslateComposed(task.goals[g].name)});
      }
  }
  for (std::size_t e = 0; e < task.errors.size(); ++e) {
    if (now.errors[e] == 0) continue;
    text.errors += (text.errors.empty() ? "" : "\n") + std::to_string(now.errors[e]) + " × " +
                   host::TranslateComposed(task.errors[e].about);
  }
  return text;
}

std::string FormatCount(std::uint64_t count) {
  return host::LocalCount(count);
}

std::string FormatResidual(double residual) {
  return std::isfinite(residual) ? Print("%.1e", residual) : "—";
}

std::string OrganLabel(const patient::Patient& patient, std::int32_t organ) {
  // organs first, then tubes, as in Simulation::Surfaces()
  if (organ < 0) return host::Translate("tissue");
  auto index = static_cast<std::size_t>(organ);
  if (index < patient.organs.size()) return host::TranslateComposed(WithSpaces(patient.organs[index].name));
  index -= patient.organs.size();
  return index < patient.tubes.size() ? host::TranslateComposed(WithSpaces(patient.tubes[index].name))
                                      : host::Translate("tissue");
}

std::string ObjectLabel(const scene::Scene& scene, std::int32_t object) {
  return host::TranslateComposed(WithSpaces(scene.objects.at(static_cast<std::size_t>(object)).name));
}

std::string HandLabel(const scene::Scene& scene, std::int32_t hand) {
  if (hand < 0 || hand >= instrument::kHandCount) return host::Translate("instrument");
  const scene::InstrumentSetup& setup = scene.instruments[static_cast<std::size_t>(hand)];
  // where tools are exchanged, the one at the start may not be the one that is meant
  const bool is_left = hand == instrument::kLeft;
  if (setup.tray.size() > 1) return is_left ? host::Translate("left hand") : host::Translate("right hand");
  return host::TranslateWith(is_left ? host::Mark("left {1}") : host::Mark("right {1}"),
                             {ToolName(setup.tool)});
}

std::string ToolName(const instrument::Tool& tool) {
  return host::Translate(WithSpaces(tool.name));
}

std::string ToolLabel(const scene::Scene& scene, const simulation::Snapshot& snapshot,
                      instrument::Hand hand) {
  const scene::InstrumentSetup& setup = scene.instruments[hand];
  const std::size_t place = snapshot.operation.tools[hand];
  const instrument::Tool& tool = place < setup.tray.size() ? setup.tray[place] : setup.tool;
  std::string label = ToolName(tool);
  if (tool.clips > 0)
    label += ", " + host::TranslateCount("{1} clip", "{1} clips",
                                         static_cast<std::size_t>(snapshot.operation.clips_left[hand]));
  return label;
}

std::string FormatMillilitres(double volume) {
  return std::isfinite(volume) ? Print("%.1f mL", 1e6 * volume) : "— mL";
}

std::string DescribeFluid(const surgery::FluidLedger& fluids, surgery::Fluid fluid) {
  const surgery::FluidLedger::Account& account = fluids.fluids[static_cast<std::size_t>(fluid)];
  return host::TranslateWith("{1}, {2} in the abdomen",
                             {FormatMillilitres(account.left), FormatMillilitres(account.pooled)});
}

std::string DescribeStones(std::span<const surgery::StoneSnapshot> stones) {
  using surgery::StonePlace;
  const auto is_out = [](const surgery::StoneSnapshot& stone) {
    return stone.place == StonePlace::kSpilled || stone.place == StonePlace::kHeld;
  };
  const auto out = std::count_if(stones.begin(), stones.end(), is_out);
  const auto inside = std::count_if(stones.begin(), stones.end(), [](const surgery::StoneSnapshot& stone) {
    return stone.place == StonePlace::kInside;
  });
  const auto retrieved = static_cast<std::ptrdiff_t>(stones.size()) - out - inside;
  if (out + retrieved == 0) return host::Translate("none spilled");
  return host::TranslateWith("{1} in the abdomen, {2} retrieved",
                             {std::to_string(out), std::to_string(retrieved)});
}

std::string DescribeAssistant(scene::AssistantCommand command, bool is_holding) {
  switch (command) {
    case scene::AssistantCommand::kRetract:
      return is_holding ? host::Translate("retracts the fundus") : host::Translate("reaches for the fundus");
    case scene::AssistantCommand::kRelax:
      return is_holding ? host::Translate("holds the fundus") : host::Translate("reaches for the fundus");
    case scene::AssistantCommand::kRelease:
      return host::Translate("lets go and withdraws");
    default:
      return host::Translate("waits");
  }
}

std::string DescribeContact(const simulation::InstrumentSnapshot& instrument,
                            const patient::Patient& patient) {
  if (instrument.is_grasping)
    return host::TranslateWith("holds the {1}", {OrganLabel(patient, instrument.organ)});
  if (instrument.is_touching)
    return host::TranslateWith("touches the {1}", {OrganLabel(patient, instrument.organ)});
  return host::Translate("free");
}

std::string DescribeEvent(const scene::Event& event, const scene::Scene& scene) {
  const std::string hand = Capitalised(HandLabel(scene, event.hand));
  const std::string organ = OrganLabel(scene.patient, event.organ);
  // a grasp begins with no force yet: "0.0 N" would say nothing
  const std::string force = event.force < 0.05 ? "" : ", " + FormatForce(event.force);
  switch (event.kind) {
    case surgery::FactKind::kGrasp:
      if (event.object >= 0)
        return host::TranslateWith("{1}: grasped {2}", {hand, ObjectLabel(scene, event.object)}) + force;
      return host::TranslateWith("{1}: grasped the {2}", {hand, organ}) + force;
    case surgery::FactKind::kRelease:
      if (event.object >= 0)
        return host::TranslateWith("{1}: let {2} go", {hand, ObjectLabel(scene, event.object)});
      return host::TranslateWith("{1}: let the {2} go", {hand, organ});
    case surgery::FactKind::kSlip:
      return host::TranslateWith("{1}: the {2} slipped", {hand, organ}) + force;
    case surgery::FactKind::kGraspMissed:
      return host::TranslateWith("{1}: closed on nothing; open the jaws and go deeper", {hand});
    case surgery::FactKind::kStateRestored:
      return host::TranslateWith("{1}: was not finite, last good state restored (E-SIM-001)",
                                 {Capitalised(organ)});
    case surgery::FactKind::kOrganFrozen:
      return host::TranslateWith("{1}: held still, press R to reset (E-SIM-002)", {Capitalised(organ)});
    case surgery::FactKind::kTear:
      if (event.organ < 0) return host::Translate("Fibres of connective tissue tore");
      return static_cast<std::size_t>(event.organ) < scene.patient.organs.size()
                 ? host::TranslateWith("{1}: an attachment tore", {Capitalised(organ)})
                 : host::Translate("A duct or vessel was torn off");
    case surgery::FactKind::kPinchDamage:
      return host::TranslateWith("{1}: pinched the {2} too hard", {hand, organ}) + force;
    case surgery::FactKind::kToolsTouch:
      return host::Translate("The instruments met");
    case surgery::FactKind::kExchangeRefused:
      return host::TranslateWith("{1}: open the jaws and let go before the tool is exchanged", {hand});
    case surgery::FactKind::kClipClosed:
      return host::TranslateWith("{1}: closed a clip on the {2}", {hand, organ});
    case surgery::FactKind::kTubeCut:
      return host::TranslateWith("{1}: cut the {2}", {hand, organ});
    case surgery::FactKind::kNoClipsLeft:
      return host::TranslateWith("{1}: there is no clip left; exchange the tool for a full one", {hand});
    case surgery::FactKind::kUsedOutside:
      return host::TranslateWith("{1}: the tool is out of its trocar; push it in before it is used", {hand});
    case surgery::FactKind::kClipSlipped:
      return host::TranslateWith("A clip slipped off the {1}", {organ});
    case surgery::FactKind::kStoneSpilled:
      return host::Translate("A stone spilled out of the gallbladder");
    case surgery::FactKind::kStoneTaken:
      return host::TranslateWith("{1}: took a stone", {hand});
    case surgery::FactKind::kStoneRetrieved:
      return host::TranslateWith("{1}: retrieved a stone", {hand});
    case surgery::FactKind::kVerdict:
      if (const surgery::ErrorRow* error = scene::FindError(scene::ProcedureOf(scene), event.error))
        return host::Translate(error->explanation);
      break;
    default:
      break;  // what goes on tick by tick is no event
  }
  return "";
}

bool IsWarning(const scene::Event& event) noexcept {
  const surgery::FactKind kind = event.kind;
  // blunt dissection tears fibres: that is no fault
  if (kind == surgery::FactKind::kTear) return event.organ >= 0;
  return kind == surgery::FactKind::kSlip || kind == surgery::FactKind::kStateRestored ||
         kind == surgery::FactKind::kOrganFrozen || kind == surgery::FactKind::kPinchDamage ||
         kind == surgery::FactKind::kClipSlipped || kind == surgery::FactKind::kStoneSpilled ||
         kind == surgery::FactKind::kVerdict;
}

std::string StageLabel(simulation::Stage stage) {
  return Capitalised(host::Translate(WithSpaces(simulation::StageName(stage))));
}

void StageMeter::Add(const simulation::Snapshot& snapshot) noexcept {
  if (has_any_ && snapshot.tick == last_tick_) return;
  constexpr double kWeight = 1.0 / 60;
  for (std::size_t stage = 0; stage < seconds_.size(); ++stage) {
    const double seconds = snapshot.stage_seconds[stage];
    seconds_[stage] = has_any_ ? seconds_[stage] + kWeight * (seconds - seconds_[stage]) : seconds;
  }
  last_tick_ = snapshot.tick;
  has_any_ = true;
}

void FrameMeter::Add(double time) noexcept {
  times_[count_++ % kCapacity] = time;
}

double FrameMeter::Rate(double now) const noexcept {
  const std::uint64_t kept = std::min<std::uint64_t>(count_, kCapacity);
  double first = now, last = now;
  std::uint64_t frames = 0;
  for (std::uint64_t i = 0; i < kept; ++i) {
    const double time = times_[(count_ - 1 - i) % kCapacity];
    if (now - time > 1.0) break;
    if (frames == 0) last = time;
    first = time;
    ++frames;
  }
  return frames < 2 || !(last > first) ? 0.0 : static_cast<double>(frames - 1) / (last - first);
}

}  // namespace trocar::presenter
