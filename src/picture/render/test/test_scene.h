// SPDX-License-Identifier: Apache-2.0
/// \file test_scene.h  A context, a renderer and a small target for tests that draw.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/render/renderer.h"

namespace trocar::render {

/// 320 x 180 pixels.
class DrawingTest : public testing::Test {
 protected:
  static constexpr int kWidth = 320, kHeight = 180;

  void SetUp() override {
    auto context = OffscreenContext::Make();
    ASSERT_TRUE(context.ok()) << context.error().Text();
    context_.emplace(std::move(*context));
    auto target = OffscreenTarget::Make(kWidth, kHeight);
    ASSERT_TRUE(target.ok()) << target.error().Text();
    target_.emplace(std::move(*target));
    const auto looks = ReadLooks(std::filesystem::path(TROCAR_SOURCE_DIR) / kLooksFile);
    ASSERT_TRUE(looks.ok()) << looks.error().Text();
    auto renderer = Renderer::Make(*looks);
    ASSERT_TRUE(renderer.ok()) << renderer.error().Text();
    renderer_.emplace(std::move(*renderer));
  }

  Image Draw(const Frame& frame) {
    target_->Bind();
    renderer_->Draw(frame, kWidth, kHeight);
    Image image;
    target_->Read(image);
    return image;
  }

  /// Without mask and smoothing, on black: every lit pixel belongs to a surface.
  static Frame PlainFrame() {
    Frame frame;
    frame.has_mask = false;
    frame.has_smooth_edges = false;
    frame.clear_colour = {0, 0, 0};
    return frame;
  }

  static int Brightness(const Image& image, int x, int y) {
    const auto [r, g, b] = image.At(x, y);
    return r + g + b;
  }

  std::optional<OffscreenContext> context_;
  std::optional<OffscreenTarget> target_;
  std::optional<Renderer> renderer_;
};

}  // namespace trocar::render
