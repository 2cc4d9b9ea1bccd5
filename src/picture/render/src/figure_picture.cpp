// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/figure_picture.h"

#include <algorithm>

#include "trocar/base/assert.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"

namespace trocar::render {

base::Result<std::vector<Image>> DrawPictures(std::span<const FigureSurface> surfaces,
                                              const FigureMarks& marks, std::span<const OrbitCamera> cameras,
                                              const FigureOptions& options, int width, int height) {
  const auto context = OffscreenContext::Make();
  if (!context) return context.error();
  auto target = OffscreenTarget::Make(width, height);
  if (!target) return target.error();
  auto renderer = FigureRenderer::Make();
  if (!renderer) return renderer.error();
  renderer->SetSurfaces(surfaces);
  std::vector<Image> pictures(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    target->Bind();
    renderer->Draw(cameras[i], marks, options, width, height);
    target->Read(pictures[i]);
  }
  return pictures;
}

Image TilePictures(std::span<const Image> pictures, int columns) {
  TROCAR_ASSERT(!pictures.empty() && columns >= 1);
  const int width = pictures.front().width, height = pictures.front().height;
  const int count = static_cast<int>(pictures.size());
  const int rows = (count + columns - 1) / columns;
  Image tiled{width * std::min(columns, count), height * rows, {}};
  tiled.pixels.assign(3 * static_cast<std::size_t>(tiled.width) * tiled.height, 0);
  for (int i = 0; i < count; ++i) {
    TROCAR_ASSERT(pictures[i].width == width && pictures[i].height == height);
    for (int y = 0; y < height; ++y) {
      const auto from = pictures[i].pixels.begin() + 3 * static_cast<std::ptrdiff_t>(y) * width;
      const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(i / columns) * height + y;
      std::copy(
          from, from + 3 * static_cast<std::ptrdiff_t>(width),
          tiled.pixels.begin() + 3 * (row * tiled.width + static_cast<std::ptrdiff_t>(i % columns) * width));
    }
  }
  return tiled;
}

}  // namespace trocar::render
