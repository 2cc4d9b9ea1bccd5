// SPDX-License-Identifier: Apache-2.0
/// \file dissection_monitor.h  How far the dissection has come: what the critical view of safety is computed from.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/cholecystectomy/critical_view.h"
#include "trocar/cholecystectomy/triangle_sight.h"
#include "trocar/cholecystectomy/triangle_window.h"
#include "trocar/instrument/camera.h"
#include "trocar/surgery/organ_attachment.h"
#include "trocar/surgery/organ_surface.h"
#include "trocar/tissue/rest_frame.h"

namespace trocar::cholecystectomy {

/// Which strands and nodes of the tissue a dissection is judged by.
struct DissectedAnatomy {
  /// A fibre between gallbladder and liver.
  struct BedFibre {
    std::uint32_t strand = 0;
    double along = 0;  ///< 0 at the infundibulum to 1 at the fundus, at rest [-]
  };
  TriangleWindow triangle;
  TriangleSight sight;
  std::vector<BedFibre> bed;
  std::vector<surgery::EnteringTube> entering;
  std::vector<double> exposable;           ///< (entering) DissectionFacts::exposable [m]
  geometry::Rows fibres;                   ///< (nodes) strands of fat, peritoneum and adhesions at each
  std::vector<std::uint32_t> cystic_duct;  ///< from the hepatic duct on; empty where there is none
  std::vector<std::uint32_t> neck;         ///< nodes of the gallbladder near its infundibulum
};

class DissectionMonitor {
 public:
  DissectionMonitor() = default;
  /// \param rest  (nodes) [m]
  DissectionMonitor(DissectedAnatomy anatomy, std::span<const math::Vec3> rest);

  /// \note Real-time safe.
  void Update(const tissue::TissueState& tissue, const surgery::Vessels& vessels,
              std::span<const surgery::OrganSurface> organs, const instrument::Camera& camera) noexcept;

  const DissectionFacts& Facts() const { return facts_; }
  std::span<const DissectedAnatomy::BedFibre> Bed() const { return anatomy_.bed; }
  /// Tubes that entered the gallbladder at the start.
  std::size_t EnteringAtStart() const { return anatomy_.entering.size(); }
  void VisitState(base::StateArchive& archive);

 private:
  static constexpr std::size_t kBins = 30;

  void Look(const tissue::TissueState& tissue, std::span<const surgery::OrganSurface> organs,
            const instrument::Camera& camera) noexcept;
  double CalcAzimuth(const tissue::TissueState& tissue, const math::Vec3& eye) noexcept;

  DissectedAnatomy anatomy_;
  std::vector<std::uint8_t> bed_bins_;   // (bed) by place along it
  std::vector<math::Vec3> neck_rest_;    // (neck) [m]
  std::array<math::Vec3, 2> duct_rest_;  // ends of the cystic duct: at the hepatic duct, at the neck [m]
  math::Quaternion neck_turn_;           // since the rest shape
  double first_azimuth_ = 0;             // of the first look [rad]
  bool has_looked_ = false;
  DissectionFacts facts_;
};

}  // namespace trocar::cholecystectomy
