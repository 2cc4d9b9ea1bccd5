// SPDX-License-Identifier: Apache-2.0
/// \file picture_series.h  Twenty-two pictures of the operation and of the training tasks: what is to be looked at after each
/// change of the picture.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/simulation/snapshot.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::view {

/// One picture of a scripted attempt.
struct SeriesShot {
  const char* name;   ///< of its file, without ending
  const char* about;  ///< one line for people
  /// The moment: from the first tick for which this holds ...
  bool (*has_come)(const simulation::Snapshot& now);
  double delay = 0;  ///< ... so much later [s]
};

/// Shots of one attempt, in the order in which they come.
struct SeriesSitting {
  const char* task;     ///< of files::FindOperation or files::FindTask
  const char* surgeon;  ///< of agent::MakeSurgeon
  std::vector<SeriesShot> shots;
};

/// Each phase of the operation, an accident, each tool and each training task.
std::vector<SeriesSitting> ListPictureSeries();

struct SeriesOptions {
  std::filesystem::path output;  ///< folder of the pictures
  /// Folder that keeps the state at each moment, as `trocar play --save` does: a later run draws from there, and plays only
  /// what is missing. Empty: none.
  std::filesystem::path moments;
  std::string only;  ///< name of the one picture to draw; empty for all
  int width = 1280, height = 720;
  int threads = 1;
  int draws = 1;  ///< of each picture, for timing
  ViewOptions view;
  /// \param share  of the pictures that are done, 0 to 1; \param doing  for a person
  std::function<void(double share, std::string_view doing)> on_progress;
};

struct SeriesPicture {
  std::string name, about;
  double time = 0;         ///< of the attempt [s]
  double draw_median = 0;  ///< Update, Draw and reading back [s]
  bool has_come = true;    ///< false: the moment never came; `about` says so, and there is no file
};

/// Plays what it must, and writes NAME.png for every shot.
/// \return kUsage (a size, or a name that no shot has), or the errors of
///         scene, simulation, graphics and files
/// \note Takes an OpenGL context of its own on the calling thread.
base::Result<std::vector<SeriesPicture>> MakePictureSeries(const SeriesOptions& options);

}  // namespace trocar::view
