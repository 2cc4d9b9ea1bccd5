// SPDX-License-Identifier: Apache-2.0
/// \file film_job.h  A recording, or a part of it, becomes a WebM video beside the window.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>

#include "trocar/base/result.h"
#include "trocar/gui/background_job.h"

namespace trocar::presenter {

struct FilmRequest {
  std::filesystem::path
      recording;                ///< finished, or one that is still being made: what lies on the disk counts
  std::filesystem::path video;  ///< WebM
  double from = 0, until = std::numeric_limits<double>::infinity();  ///< [s]
  double last_seconds = 0;         ///< more than 0: only so much before `until`, in place of `from` [s]
  int width = 1280, height = 720;  ///< [pixels]
  int threads = 1;                 ///< of the solver that computes the attempt again
};

/// Part of a recording that a finished video shows.
struct Film {
  double from = 0, until = 0;  ///< of the recording [s]
  std::uint64_t frames = 0;
};

/// How long a clip of what has just happened is [s].
inline constexpr double kClipSeconds = 60;

/// Computes the attempt again and draws it at 30 pictures a second. Works in the thread that calls.
/// \param progress      told "Seeking", "Drawing" and how far
/// \param is_cancelled  true: gives up as soon as possible
/// \return kCancelled, the recording's error, kUsage where nothing lies between from and until, kNoGraphics, kVideoFailed; the
/// file is there only where all went well
base::Result<Film> MakeFilm(const FilmRequest& request, gui::JobProgress& progress,
                            const std::atomic<bool>& is_cancelled);

/// Draws one moment of a recording; where an index lies beside it, it goes on from the state before that moment.
/// \param time     of the simulation [s]; clamped to what was recorded
/// \param picture  PNG that is written
/// \return the recording's or the picture's error, kCancelled
/// \note Takes an OpenGL context of its own on the calling thread.
base::Status DrawMoment(const std::filesystem::path& recording, double time,
                        const std::filesystem::path& picture, int threads,
                        const std::function<bool()>& goes_on);

/// Where pictures and clips go that nobody named a file for: the user's folder for pictures, "Trocar" in it.
/// \param pictures  of the desktop; empty: host::FindUserDataFolder()/pictures
std::filesystem::path PictureFolder(const std::filesystem::path& pictures);
/// "trocar-2026-11-25-142233.png", with "-2" before the dot where that is there already, and so on.
std::filesystem::path NamePicture(const std::filesystem::path& folder,
                                  std::chrono::system_clock::time_point now, const std::string& ending);

}  // namespace trocar::presenter
