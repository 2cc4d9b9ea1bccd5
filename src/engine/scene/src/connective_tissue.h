// SPDX-License-Identifier: Apache-2.0
/// \file connective_tissue.h  Fat and fibres that fill the hepatocystic triangle, and the peritoneum over them: what is
/// dissected before anything is clipped.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"

namespace trocar::scene {

/// End of a fibre: a lobule of fat, or a vertex of an organ, or a point of a tube.
struct FibreEnd {
  enum class Of : std::uint8_t { kLobule, kOrgan, kTube } of = Of::kLobule;
  std::uint32_t which = 0;  ///< lobule, organ or tube
  std::uint32_t index = 0;  ///< vertex or point
};

struct Fibre {
  FibreEnd a, b;
  double length = 0;  ///< at rest [m]
  bool is_peritoneum = false;
};

/// Lobules on a shaken lattice between cystic duct, hepatic duct and liver, joined to their neighbours and to all
/// that they lie on.
struct ConnectiveTissue {
  std::vector<math::Vec3> lobules;  ///< [m]
  std::vector<Fibre> fibres;
};

/// \param spacing  of the lobules [m], 0.001 to 0.01
/// \return nothing where the patient has no cystic duct or no hepatic duct to fill the triangle between
ConnectiveTissue MakeConnectiveTissue(const patient::Patient& patient, double spacing, std::uint64_t seed);

}  // namespace trocar::scene
