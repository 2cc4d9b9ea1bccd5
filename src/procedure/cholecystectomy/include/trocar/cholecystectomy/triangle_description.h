// SPDX-License-Identifier: Apache-2.0
/// \file triangle_description.h  The hepatocystic triangle as a surgeon knows it before the operation; constant.
#pragma once

#include <cstdint>
#include <vector>

#include "trocar/cholecystectomy/triangle_sight.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/model_description.h"

namespace trocar::cholecystectomy {

struct TriangleDescription {
  std::vector<std::uint32_t> window_strands;  ///< of fat and peritoneum over the triangle's window
  TriangleSight sight;
  /// (tubes) What may be asked to lie bare of each that enters the gallbladder, from there on, along it at rest [m]; 0 for the
  /// others.
  std::vector<double> exposable;
};

/// \param model  of the scene
/// \return empty where the scene is no operation
/// \note Not real-time safe: allocates.
TriangleDescription DescribeTriangle(const scene::Scene& scene, const simulation::ModelDescription& model);

}  // namespace trocar::cholecystectomy
