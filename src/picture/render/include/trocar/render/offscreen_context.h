// SPDX-License-Identifier: Apache-2.0
/// \file offscreen_context.h  OpenGL without a window or a display: EGL with no surface.
#pragma once

#include <memory>
#include <string>

#include "trocar/base/result.h"

namespace trocar::render {

/// An OpenGL 3.3 core context of its own, current on the thread that made it.
///
/// Drivers have threads and locks that are not there, or not free, in a child of fork(): once a process has made a context, its
/// forks can neither use that one nor make one. They are refused, and destroying a context does nothing there.
class OffscreenContext {
 public:
  /// Tries Mesa's surfaceless platform, then every EGL device.
  /// \return kNoGraphics with the packages to install, kGraphicsTooOld with the version that was found, or kEnvironmentState in
  ///     a fork
  static base::Result<OffscreenContext> Make();

  OffscreenContext(OffscreenContext&&) noexcept;
  OffscreenContext& operator=(OffscreenContext&&) noexcept;
  ~OffscreenContext();

  /// Makes it current on the calling thread.
  /// \return kNoGraphics when it is current on another one; kEnvironmentState in a fork
  base::Status MakeCurrent();
  /// Leaves the calling thread without a context, so that another one may take it.
  void Release();

  /// "4.5 (Core Profile) Mesa 22.3.6"
  const std::string& VersionText() const;
  /// "llvmpipe (LLVM 15.0.6, 256 bits)"
  const std::string& RendererText() const;

 private:
  struct Content;
  explicit OffscreenContext(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::render
