// SPDX-License-Identifier: Apache-2.0
/// \file film_maker.h  Draws one simulation, or several beside each other, off-screen into a video and pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/simulation/simulation.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::view {

struct FilmSettings {
  int width = 1280, height = 720;  ///< of the whole picture [pixels], 16 to 4096
  int frames_per_second = 30;      ///< 1 to 240
  std::filesystem::path video;     ///< WebM; its folder is made where it is missing
  ViewOptions view;
};

class FilmMaker {
 public:
  /// \param simulations  side by side from the left, at least one; each scene outlives this
  /// \return kUsage (a size out of range), kNoGraphics, kGraphicsTooOld, kShaderFailed or kVideoFailed
  /// \note Takes an OpenGL context of its own on the calling thread.
  static base::Result<FilmMaker> Make(const FilmSettings& settings,
                                      std::span<const simulation::Simulation* const> simulations);

  FilmMaker(FilmMaker&&) noexcept;
  FilmMaker& operator=(FilmMaker&&) noexcept;
  ~FilmMaker();

  struct Side {
    const simulation::Snapshot* snapshot = nullptr;
    Overlay overlay;
  };
  /// \param sides  as many as there are simulations (TROCAR_ASSERT)
  /// \return kVideoFailed
  base::Status AddFrame(std::span<const Side> sides);
  std::uint64_t FrameCount() const;
  /// The last frame. \return kFileUnwritable
  base::Status SavePicture(const std::filesystem::path& path) const;
  /// Ends the video. \return kVideoFailed
  base::Status Finish();

 private:
  struct Content;
  explicit FilmMaker(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::view
