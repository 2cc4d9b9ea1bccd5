// SPDX-License-Identifier: Apache-2.0
/// \file figure_picture.h  Pictures of a figure where there is no window.
#pragma once

#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/render/figure_renderer.h"
#include "trocar/render/image.h"

namespace trocar::render {

/// One picture for each camera.
/// \param width, height  1 to 8192 [pixels] (TROCAR_ASSERT)
/// \return kNoGraphics, kGraphicsTooOld or kShaderFailed
/// \note Takes an OpenGL context of its own on the calling thread and gives it up at the end.
base::Result<std::vector<Image>> DrawPictures(std::span<const FigureSurface> surfaces,
                                              const FigureMarks& marks, std::span<const OrbitCamera> cameras,
                                              const FigureOptions& options, int width, int height);

/// Pictures of one size side by side, row after row.
/// \pre at least one picture, equal sizes, columns >= 1 (TROCAR_ASSERT)
Image TilePictures(std::span<const Image> pictures, int columns);

}  // namespace trocar::render
