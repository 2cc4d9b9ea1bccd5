// SPDX-License-Identifier: Apache-2.0
/// \file demo.h  Plays a scene's script without a window and keeps it as a video and pictures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/input_source.h"
#include "trocar/simulation/operation_result.h"
#include "trocar/simulation/simulation.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::view {

struct DemoOptions {
  double duration = 0;                  ///< [s], <= 3600; 0 plays the whole script
  int width = 1280, height = 720;       ///< [pixels], 16 to 4096
  int frames_per_second = 30;           ///< 1 to 240
  std::filesystem::path output_folder;  ///< made when it is missing
  std::vector<double> picture_times;    ///< [s]; none: six, evenly spread
  int threads = 1;                      ///< of the solver
  bool has_video = true;
  ViewOptions view;
  simulation::InputSource* source = nullptr;  ///< nullptr: the scene's script
  /// The source's end is the end; `duration` is then the longest, and pictures come after 1, 2, 4, ... s.
  bool is_until_end = false;
  std::vector<std::byte> start;  ///< a saved state from which it goes on; empty: the first tick
  std::function<base::Status(const simulation::Simulation&)>
      on_start;  ///< before the first tick; may be empty
  /// after every tick, with its input, before on_tick; may be empty
  std::function<void(simulation::Simulation&, const scene::Input&)> after_step;
  std::function<void(const simulation::Snapshot&)> on_tick;  ///< after every tick; may be empty
  std::function<void(double)> on_progress;  ///< share done, 0 to 1, once a frame; may be empty
};

struct DemoPicture {
  double time = 0;             ///< [s]
  std::filesystem::path path;  ///< PNG
};

struct DemoReport {
  std::uint64_t ticks = 0;
  std::uint64_t frames = 0;           ///< drawn, one after the other
  std::filesystem::path video;        ///< demo.webm; empty without video
  std::vector<DemoPicture> pictures;  ///< in time order
  double draw_median = 0;             ///< wall time to update, draw and read a frame [s]
  double draw_p99 = 0;                ///< [s]
  std::uint64_t state_hash = 0;       ///< of the simulation at the end
  std::string graphics;               ///< what drew it, for example "llvmpipe (LLVM 15.0.6, 256 bits)"
  std::optional<simulation::OperationResult> operation;  ///< of a scene that is one
};

/// Steps the simulation with the script's hands, draws it off-screen, writes demo.webm and picture_NNN.png.
///
/// \return kNoGraphics, kGraphicsTooOld, kShaderFailed, kVideoFailed, kFileUnwritable, kUsage (an option out
/// of range),
///         kScriptInvalid (no script and no duration) or the simulation's error; a video that failed leaves
///         no file
/// \note Takes an OpenGL context of its own on the calling thread and gives it up at the end.
base::Result<DemoReport> PlayDemonstration(std::shared_ptr<const scene::Scene> scene,
                                           const DemoOptions& options);

}  // namespace trocar::view
