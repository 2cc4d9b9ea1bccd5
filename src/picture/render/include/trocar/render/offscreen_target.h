// SPDX-License-Identifier: Apache-2.0
/// \file offscreen_target.h  A framebuffer to draw into where there is no window, and its way back to an
/// Image.
#pragma once

#include <memory>

#include "trocar/base/result.h"
#include "trocar/render/image.h"

namespace trocar::render {

/// Colour and depth buffers of one size. Use it only while the context that made it is current.
class OffscreenTarget {
 public:
  /// \param width, height  1 to 8192 [pixels] (TROCAR_ASSERT)
  /// \return kNoGraphics when the driver has no such framebuffer
  static base::Result<OffscreenTarget> Make(int width, int height);

  OffscreenTarget(OffscreenTarget&&) noexcept;
  OffscreenTarget& operator=(OffscreenTarget&&) noexcept;
  ~OffscreenTarget();

  int Width() const;
  int Height() const;

  /// Makes this the target of everything that is drawn next.
  void Bind();
  /// Waits for the drawing and copies it, first row at the top.
  /// \param[in,out] image  memory is used again when the size is the same
  void Read(Image& image);

 private:
  struct Content;
  explicit OffscreenTarget(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::render
