// SPDX-License-Identifier: Apache-2.0
/// \file dissection_monitor.h  How far the dissection has come: what the critical view of safety is computed from.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "operation/camera.h"
#include "operation/vessel_work.h"
#include "trocar/core/state_archive.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/rest_frame.h"
#include "trocar/training/critical_view.h"

namespace trocar::simulation {

using scene::StrandInfo;

class DissectionMonitor {
 public:
  DissectionMonitor() = default;
  /// \param surfaces     organs, then tubes
  /// \param strands      (strands)
  DissectionMonitor(const anatomy::Patient& patient, std::span<const SurfaceInfo> surfaces,
                    std::span<const StrandInfo> strands, std::span<const Vec3> rest);

  /// \note Real-time safe.
  void Update(const tissue::TissueState& tissue, const VesselWork& vessels,
              std::span<const surgery::OrganSurface> organs, const Camera& camera) noexcept;

  const training::DissectionFacts& Facts() const { return facts_; }
  void VisitState(core::StateArchive& archive);

 private:
  struct Entering {
    std::uint32_t tube = 0;
    std::vector<std::uint32_t> nodes;        // from the gallbladder on
    std::vector<std::uint32_t> end_strands;  // that tie it to the gallbladder
  };
  static constexpr std::size_t kBins = 30;

  void Look(const tissue::TissueState& tissue, std::span<const surgery::OrganSurface> organs,
            const Camera& camera) noexcept;
  double CalcAzimuth(const tissue::TissueState& tissue, const Vec3& eye) noexcept;

  std::vector<std::uint32_t> triangle_;  // strands of fat and peritoneum
  std::vector<std::uint32_t> bed_;       // strands
  std::vector<std::uint8_t> bed_bin_;    // (bed)
  std::vector<Entering> entering_;
  std::vector<std::uint32_t> fibre_starts_, fibres_;     // by node
  std::vector<std::uint32_t> duct_nodes_, plate_nodes_;  // of cystic and hepatic duct, from their meeting on
  std::vector<std::uint32_t> neck_nodes_;                // of the gallbladder
  std::vector<Vec3> neck_rest_;                          // (neck_nodes_) [m]
  std::array<Vec3, 2> duct_rest_;  // ends of the cystic duct: at the hepatic duct, at the neck [m]
  math::Quaternion neck_turn_;     // since the rest shape
  double first_azimuth_ = 0;       // of the first look [rad]
  bool has_looked_ = false;
  training::DissectionFacts facts_;
};

}  // namespace trocar::simulation
