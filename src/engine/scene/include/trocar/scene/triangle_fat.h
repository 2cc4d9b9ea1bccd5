// SPDX-License-Identifier: Apache-2.0
/// \file triangle_fat.h  The fat of the hepatocystic triangle.
#pragma once

#include <span>

#include "trocar/math/vector.h"
#include "trocar/scene/tissue_layout.h"
#include "trocar/surgery/fat_lobules.h"

namespace trocar::scene {

/// Lobules about the strands of the triangle; the same for the eye, the picture and the judge.
/// \param strands  all of the scene: their order is that of the intact flags
/// \param rest     (nodes) [m]
surgery::FatLobules MakeTriangleFat(std::span<const StrandInfo> strands, std::span<const math::Vec3> rest);

}  // namespace trocar::scene
