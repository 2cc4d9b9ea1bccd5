// SPDX-License-Identifier: Apache-2.0
/// \file place.h  A place in the operating field as a value, to be found in a snapshot when it is needed.
///
/// Nothing here refers to a snapshot, so that a plan can be saved in the middle of an operation.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/base/state_archive.h"
#include "trocar/instrument/hand.h"
#include "trocar/math/vector.h"

namespace trocar::agent {

struct Place {
  enum class Kind : std::uint8_t {
    kNone,
    kPoint,        ///< `p`
    kNode,         ///< of the tissue; `back` from there towards the hand's trocar
    kAboveNode,    ///< `back` from there towards the middle between both trocars
    kTube,         ///< at a share of a tube's length
    kAim,          ///< `back` before it, as seen from the right hand's trocar
    kBetweenJaws,  ///< of the tip, when the tube lies between jaws of length `back`; `share` is the arc [m]
    kStrands,      ///< the middle of the gallbladder's ends of strands
    kGallbladder,  ///< its middle
    kBesideHold,   ///< in the gallbladder's wall, beside what the left hand holds
    kInLiver,      ///< under its surface, `back` along it
    kRightTip,     ///< of the tool that is seen
    kBehindTip,    ///< `back` along the shaft of `hand`
    kFromTip,      ///< of `hand`, by `p`
    kOverField,    ///< over what the picture is about, in the picture
    kPool          ///< where liquid gathers, `back` towards the trocar
  } kind = Kind::kNone;
  std::int32_t hand = instrument::kRight;
  bool is_for_hook = false;  ///< where the tip stands when the middle of the hook's toe is there
  std::uint32_t node = 0;
  std::size_t tube = 0;
  double share = 0;  ///< [-]
  double back = 0;   ///< [m]
  math::Vec3 p;      ///< [m]
  std::vector<std::uint32_t> strands;

  static Place At(const math::Vec3& p);
  static Place AtNode(std::uint32_t node);
  static Place OnTube(std::size_t tube, double share);
  static Place Aim(std::size_t tube, double share, double back);
  static Place BetweenJaws(std::size_t tube, double arc, double jaw_length);
  static Place MiddleOf(std::vector<std::uint32_t> strands);
  static Place BehindTip(int hand, double back);
  static Place Of(Kind kind);
  Place ForHook() const;
  void VisitState(base::StateArchive& archive);
};

}  // namespace trocar::agent
