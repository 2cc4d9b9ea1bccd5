// SPDX-License-Identifier: Apache-2.0
/// \file video_writer.h  WebM files (VP8) of a row of pictures.
#pragma once

#include <filesystem>
#include <memory>

#include "trocar/base/result.h"
#include "trocar/render/image.h"

namespace trocar::render {

struct VideoSettings {
  int width = 1280, height = 720;   ///< [pixels], 16 to 4096
  int frames_per_second = 30;       ///< 1 to 240
  int bits_per_second = 6'000'000;  ///< aimed at
};

/// Encodes frames as they come. The file appears under its name only when Finish() succeeded; a writer that
/// is destroyed before leaves nothing.
class VideoWriter {
 public:
  /// Makes the parent folders.
  /// \return kVideoFailed (a plug-in or the folder is missing, a setting is out of
  /// range)
  static base::Result<VideoWriter> Make(const std::filesystem::path& path, const VideoSettings& settings);

  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  ~VideoWriter();

  /// Appends one frame, shown for 1 / frames_per_second. Waits while the encoder is busy.
  /// \return kVideoFailed when the size differs or the encoder or the disk fails
  base::Status AddFrame(const Image& image);
  /// Ends the file and gives it its name.
  /// \return kVideoFailed, also without any frame
  base::Status Finish();

 private:
  struct Content;
  explicit VideoWriter(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::render
