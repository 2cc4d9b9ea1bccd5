// SPDX-License-Identifier: Apache-2.0
#include "trocar/patient/patient.h"

#include <algorithm>
#include <iterator>

namespace trocar::patient {
namespace {

constexpr const char* kUses[] = {"laparoscope", "left_hand", "right_hand", "assistant"};
static_assert(std::size(kUses) == kPortUseCount);

}  // namespace

const char* NameOf(PortUse use) noexcept {
  return kUses[static_cast<std::size_t>(use)];
}

std::optional<PortUse> FindPortUse(std::string_view name) noexcept {
  const auto found = std::find(std::begin(kUses), std::end(kUses), name);
  if (found == std::end(kUses)) return std::nullopt;
  return static_cast<PortUse>(found - std::begin(kUses));
}

bool IsPlainName(std::string_view name) noexcept {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

const Region* Organ::RegionOf(roles::RegionRole wanted) const {
  const auto found = std::find_if(regions.begin(), regions.end(),
                                  [&](const Region& region) { return region.role == wanted; });
  return found == regions.end() ? nullptr : &*found;
}

int Patient::OrganOf(roles::OrganRole role) const {
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (organs[i].role == role) return static_cast<int>(i);
  }
  return -1;
}

std::vector<PatientBed> Patient::ListBeds() const {
  std::vector<PatientBed> beds;
  for (const roles::OrganBed& known : roles::kOrganBeds) {
    const PatientBed bed{OrganOf(known.organ), OrganOf(known.host)};
    if (bed.organ >= 0 || bed.host >= 0) beds.push_back(bed);
  }
  for (const Attachment& attachment : attachments) {
    const PatientBed bed{static_cast<int>(attachment.organ_a), static_cast<int>(attachment.organ_b)};
    const bool is_known = std::any_of(beds.begin(), beds.end(), [&](const PatientBed& other) {
      return other == bed || (other.organ == bed.host && other.host == bed.organ);
    });
    if (!is_known) beds.push_back(bed);
  }
  return beds;
}

int Patient::HollowOrgan() const {
  const auto found = std::find_if(organs.begin(), organs.end(),
                                  [](const Organ& organ) { return roles::IsHollow(organ.role); });
  return found == organs.end() ? -1 : static_cast<int>(found - organs.begin());
}

int Patient::TubeOf(roles::TubeRole role) const {
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    if (tubes[i].role == role) return static_cast<int>(i);
  }
  return -1;
}

roles::OrganRole Patient::RoleOfOrgan(int organ) const {
  const auto index = static_cast<std::size_t>(organ);
  return organ >= 0 && index < organs.size() ? organs[index].role : roles::OrganRole::kOther;
}

const Landmark* Patient::LandmarkOf(roles::LandmarkRole role) const {
  for (const Landmark& landmark : landmarks) {
    if (landmark.role == role) return &landmark;
  }
  return nullptr;
}

int Patient::FindOrgan(std::string_view organ_name) const {
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (organs[i].name == organ_name) return static_cast<int>(i);
  }
  return -1;
}

int Patient::FindTube(std::string_view tube_name) const {
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    if (tubes[i].name == tube_name) return static_cast<int>(i);
  }
  return -1;
}

int Patient::FindPart(std::string_view part_name) const {
  const int organ = FindOrgan(part_name), tube = FindTube(part_name);
  if (organ >= 0) return organ;
  return tube < 0 ? -1 : static_cast<int>(organs.size()) + tube;
}

const Landmark* Patient::FindLandmark(std::string_view landmark_name) const {
  for (const Landmark& landmark : landmarks) {
    if (landmark.name == landmark_name) return &landmark;
  }
  const roles::LandmarkRole role = roles::ConventionalRole<roles::LandmarkRole>(landmark_name);
  return role == roles::LandmarkRole::kOther ? nullptr : LandmarkOf(role);
}

const Parameter* Patient::FindParameter(std::string_view parameter_name) const {
  for (const Parameter& parameter : parameters) {
    if (parameter.name == parameter_name) return &parameter;
  }
  return nullptr;
}

const Neighbour* Patient::NeighbourOf(roles::NeighbourRole role) const {
  for (const Neighbour& neighbour : neighbours) {
    if (neighbour.role == role) return &neighbour;
  }
  return nullptr;
}

const Port* Patient::PortOf(PortUse use) const {
  for (const Port& port : ports) {
    if (port.use == use) return &port;
  }
  return nullptr;
}

}  // namespace trocar::patient
