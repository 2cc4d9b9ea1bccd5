// SPDX-License-Identifier: Apache-2.0
/// \file bed_ooze.h  Blood that seeps out of a bed where the organ in it was torn or cut off without heat.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/surgery/electrosurgery.h"
#include "trocar/surgery/surgery_settings.h"
#include "trocar/surgery/surgery_snapshot.h"
#include "trocar/tissue/tissue_model.h"

namespace trocar::surgery {

/// A fibre between an organ and the one in whose bed it lies, or that has grown to it.
struct BedFibre {
  std::uint32_t strand = 0;
  std::uint32_t node = 0;  ///< on the host of the bed
  bool is_bed = true;      ///< else an adhesion
};

/// Each fibre of bed and adhesions leaves, where it held on the host, a place that bleeds a little: less and less as it
/// clots, and no more once heat has blanched it. What heat parts does not bleed.
class BedOoze {
 public:
  BedOoze() = default;
  /// \param bleeding  factor of the patient's disease [-], >= 0
  BedOoze(std::span<const BedFibre> fibres, double bleeding, const BedOozeSettings& settings = {});

  /// One tick.
  /// \return the blood that ran out [m^3]
  /// \note Real-time safe.
  double Update(const tissue::TissueState& tissue, const Electrosurgery& heat, std::size_t node_count,
                double seconds) noexcept;

  double Rate() const noexcept { return rate_; }  ///< of the last tick [m^3/s]
  double Lost() const noexcept { return lost_; }  ///< since the start [m^3]
  /// The places that bleed most, most first, as many as fit.
  /// \return how many
  std::size_t Publish(std::span<const math::Vec3> position, std::span<OozeSnapshot> oozes) const noexcept;
  void VisitState(base::StateArchive& archive);

 private:
  struct Place {
    std::uint32_t strand = 0, node = 0;
    bool was_intact = true;
    double left = 0;  // that will still run out [m^3]
  };
  BedOozeSettings settings_;
  std::vector<Place> places_;
  double volume_ = 0;  // of one place [m^3]
  double rate_ = 0, lost_ = 0;
};

}  // namespace trocar::surgery
