// SPDX-License-Identifier: Apache-2.0
/// \file geometry_picture.h  Depth, normal, label and motion at each pixel of a picture. For learning and for measuring,
/// not for people.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "trocar/render/material.h"

namespace trocar::render {

/// Labels of what is drawn by material alone: fibres, blobs and puddles. 0 leaves them out.
using MaterialLabels = std::array<std::uint16_t, static_cast<std::size_t>(Material::kCount)>;

/// Rows from the top. Nothing lies at a pixel of label 0, nor outside of the round picture where the frame has a mask.
struct GeometryPicture {
  int width = 0, height = 0;   ///< [pixels]
  std::vector<float> depth;    ///< (height * width) along the line of sight from the lens [m]; 0: nothing
  std::vector<float> normals;  ///< (height * width * 3) unit, camera frame: +x right, +y up, +z to the eye
  std::vector<std::uint16_t> labels;  ///< (height * width) SurfaceDraw::label, or of the material
  /// (height * width * 2) optical flow, where it was asked for, else empty: the pixel less that of the same surface point in
  /// the flow picture before, +x right, +y down [pixels]. NaN where nothing lies, and where nothing is known: in the first
  /// picture, of fibres, blobs and puddles, of what is new, and of what was behind the lens.
  std::vector<float> flow;
};

}  // namespace trocar::render
