// SPDX-License-Identifier: Apache-2.0
/// \file bed_ooze.h  Blood that seeps out of the liver where the gallbladder was torn or cut off it without heat.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "operation/electrosurgery.h"
#include "trocar/core/state_archive.h"
#include "trocar/simulation/operation_snapshot.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::simulation {

/// Each fibre of bed and adhesions leaves, where it held on the liver, a place that bleeds a little: less and less as it
/// clots, and no more once heat has blanched it. What heat parts does not bleed.
///
/// No source gives the rate; tunables: a whole bed torn off loses 15 mL, half of that in the first minute.
class BedOoze {
 public:
  BedOoze() = default;
  /// \param strands  of the whole tissue
  /// \param on_liver  (strands) its node on the liver, or kNoNode
  /// \param bleeding  factor of the patient's disease [-], >= 0
  BedOoze(std::span<const StrandInfo> strands, std::span<const std::uint32_t> on_liver, double bleeding);
  static constexpr std::uint32_t kNoNode = 0xffffffff;

  /// One tick.
  /// \return what ran out [m^3]
  /// \note Real-time safe.
  double Update(const tissue::TissueState& tissue, const Electrosurgery& heat, std::size_t node_count,
                double seconds) noexcept;

  double Rate() const noexcept { return rate_; }  ///< of the last tick [m^3/s]
  double Lost() const noexcept { return lost_; }  ///< since the start [m^3]
  void Publish(std::span<const math::Vec3> position, OperationSnapshot& snapshot) const noexcept;
  void VisitState(core::StateArchive& archive);

 private:
  struct Place {
    std::uint32_t strand = 0, node = 0;
    bool was_intact = true;
    double left = 0;  // that will still run out [m^3]
  };
  std::vector<Place> places_;
  double volume_ = 0;  // of one place [m^3]
  double rate_ = 0, lost_ = 0;
};

}  // namespace trocar::simulation
