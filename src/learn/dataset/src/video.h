// SPDX-License-Identifier: Apache-2.0
/// \file video.h  One attempt of a scripted surgeon, or a recorded one, as a row of labelled frames.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acts.h"
#include "trocar/dataset/dataset.h"
#include "trocar/render/geometry_picture.h"
#include "trocar/render/image.h"
#include "trocar/simulation/simulation.h"
#include "variation.h"

namespace trocar::dataset {

/// Of the public data sets' videos: their frame numbers count at this rate.
inline constexpr double kFramesPerSecond = 25;

struct Frame {
  std::size_t index = 0;     ///< in the video, from 0
  std::uint64_t number = 0;  ///< at 25 frames a second
  render::Image colour;      ///< this and geometry are empty where the plan has no pictures
  render::GeometryPicture geometry;
  double focal_length = 0;  ///< [pixels]
  std::vector<Act> acts;    ///< of tools that are in the picture
};

/// Writer of a video in one layout. It lives on the thread of its video.
class VideoWriter {
 public:
  virtual ~VideoWriter() = default;
  /// \return the error of a file
  virtual base::Status Add(const Frame& frame, const simulation::Simulation& simulation) = 0;
  /// Each tick of the simulation, before the frame that it may be.
  /// \param input  what that tick was given
  virtual void Look(const simulation::Simulation& /*simulation*/, const scene::Input& /*input*/) {}
  virtual base::Status Finish() = 0;
};

struct VideoResult {
  std::uint64_t seed = 0;  ///< of recordings the number, from 1
  std::string patient;     ///< folder's name, or empty for the scene's own
  std::string recording;   ///< SHA-256 of its file, or empty
  Variation variation;
  std::size_t frames = 0;
  double seconds = 0;      ///< of simulated time
  std::uint64_t hash = 0;  ///< of the simulation's last state
  std::string outcome;     ///< "completed", "time over", ...
};

/// Where one video goes.
struct VideoTask {
  const Plan* plan = nullptr;
  std::size_t index = 0;         ///< of the video, from 0
  std::filesystem::path folder;  ///< of the data set
};

/// \return the scene's, simulation's, graphics' or a file's error
base::Result<VideoResult> MakeVideo(
    const VideoTask& task,
    const std::function<std::unique_ptr<VideoWriter>(const simulation::Simulation& simulation)>& make_writer);

}  // namespace trocar::dataset
