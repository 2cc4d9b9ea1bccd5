// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triplet.h"

namespace trocar::cholecystectomy {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(InstrumentKind::kCount)> kInstruments = {
    "grasper", "bipolar", "hook", "scissors", "clipper", "irrigator", "specimen_bag"};
constexpr std::array<std::string_view, static_cast<std::size_t>(Verb::kCount)> kVerbs = {
    "grasp", "retract", "dissect", "coagulate", "clip", "cut", "aspirate", "irrigate", "pack", "null_verb"};
constexpr std::array<std::string_view, static_cast<std::size_t>(Target::kCount)> kTargets = {
    "gallbladder", "cystic_plate",          "cystic_duct", "cystic_artery", "cystic_pedicle", "blood_vessel",
    "fluid",       "abdominal_wall_cavity", "liver",       "adhesion",      "omentum",        "peritoneum",
    "gut",         "specimen_bag",          "null_target"};
constexpr std::array<std::string_view, kPhaseCount> kPhases = {
    "Preparation",          "CalotTriangleDissection", "ClippingCutting",      "GallbladderDissection",
    "GallbladderPackaging", "CleaningCoagulation",     "GallbladderRetraction"};

}  // namespace

std::string_view NameOf(InstrumentKind instrument) noexcept {
  return kInstruments[static_cast<std::size_t>(instrument)];
}
std::string_view NameOf(Verb verb) noexcept {
  return kVerbs[static_cast<std::size_t>(verb)];
}
std::string_view NameOf(Target target) noexcept {
  return kTargets[static_cast<std::size_t>(target)];
}
std::string_view NameOf(Phase phase) noexcept {
  return kPhases[static_cast<std::size_t>(phase)];
}

std::string NameOf(const Triplet& triplet) {
  std::string name(NameOf(triplet.instrument));
  for (const std::string_view part : {NameOf(triplet.verb), NameOf(triplet.target)}) {
    name += ',';
    name += part;
  }
  return name;
}

}  // namespace trocar::cholecystectomy
