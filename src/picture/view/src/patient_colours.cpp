// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/patient_colours.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/host/json.h"
#include "trocar/patient/patient.h"
#include "trocar/roles/roles.h"

namespace trocar::view {

using render::SrgbColour;
using roles::OrganRole;
using roles::RegionRole;
using roles::TubeRole;
namespace {

void ReadColour(const host::JsonView& view, std::string_view key, SrgbColour& colour) {
  const std::vector<double> shares = view.Numbers(key, 3);
  if (!std::all_of(shares.begin(), shares.end(), [](double share) { return share >= 0.0 && share <= 1.0; }))
    view.Complain(std::string(key) + " must have numbers from 0 to 1");
  std::copy_n(shares.begin(), std::min(shares.size(), colour.size()), colour.begin());
}

}  // namespace

const SrgbColour& PatientColours::Of(OrganRole organ) const noexcept {
  if (organ == OrganRole::kLiver) return liver;
  return organ == OrganRole::kGallbladder ? gallbladder : other_organ;
}

const SrgbColour& PatientColours::Of(RegionRole region) const noexcept {
  switch (region) {
    case RegionRole::kDiaphragmaticFace:
      return diaphragmatic_face;
    case RegionRole::kFalciform:
      return falciform;
    case RegionRole::kCoronary:
      return coronary;
    case RegionRole::kGallbladderBed:
      return gallbladder_bed;
    case RegionRole::kHeld:
    case RegionRole::kOther:
      break;
  }
  return other_region;
}

const SrgbColour& PatientColours::Of(const patient::Tube& tube) const noexcept {
  if (tube.kind == patient::TubeKind::kArtery) return artery;
  return tube.role == TubeRole::kCysticDuct ? cystic_duct : other_duct;
}

base::Result<PatientColours> ReadPatientColours(const std::filesystem::path& path) {
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const host::JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "organs_srgb", "regions_srgb", "tubes_srgb", "marks_srgb"});
  if (root.Text("format") != "trocar-patient-colours")
    root.Complain("format must be \"trocar-patient-colours\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  PatientColours colours;
  using roles::NameOf;
  const host::JsonView organs = root.Object("organs_srgb");
  constexpr const char* kLiver = NameOf(OrganRole::kLiver);
  constexpr const char* kGallbladder = NameOf(OrganRole::kGallbladder);
  organs.AllowOnly({kLiver, kGallbladder, "other"});
  ReadColour(organs, kLiver, colours.liver);
  ReadColour(organs, kGallbladder, colours.gallbladder);
  ReadColour(organs, "other", colours.other_organ);
  const host::JsonView regions = root.Object("regions_srgb");
  constexpr const char* kDiaphragmatic = NameOf(RegionRole::kDiaphragmaticFace);
  constexpr const char* kFalciform = NameOf(RegionRole::kFalciform);
  constexpr const char* kCoronary = NameOf(RegionRole::kCoronary);
  constexpr const char* kBed = NameOf(RegionRole::kGallbladderBed);
  regions.AllowOnly({kDiaphragmatic, kFalciform, kCoronary, kBed, "other"});
  ReadColour(regions, kDiaphragmatic, colours.diaphragmatic_face);
  ReadColour(regions, kFalciform, colours.falciform);
  ReadColour(regions, kCoronary, colours.coronary);
  ReadColour(regions, kBed, colours.gallbladder_bed);
  ReadColour(regions, "other", colours.other_region);
  const host::JsonView tubes = root.Object("tubes_srgb");
  constexpr const char* kArtery = NameOf(roles::TissueRole::kArtery);
  constexpr const char* kCysticDuct = NameOf(TubeRole::kCysticDuct);
  tubes.AllowOnly({kArtery, kCysticDuct, "other_duct"});
  ReadColour(tubes, kArtery, colours.artery);
  ReadColour(tubes, kCysticDuct, colours.cystic_duct);
  ReadColour(tubes, "other_duct", colours.other_duct);
  const host::JsonView marks = root.Object("marks_srgb");
  marks.AllowOnly({"attachment", "landmark"});
  ReadColour(marks, "attachment", colours.attachment);
  ReadColour(marks, "landmark", colours.landmark);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return colours;
}

}  // namespace trocar::view
