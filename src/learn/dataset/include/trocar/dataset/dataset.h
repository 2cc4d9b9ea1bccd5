// SPDX-License-Identifier: Apache-2.0
/// \file dataset.h  Labelled data sets from scripted or recorded attempts, in layouts that others' loaders read. docs/datasets.md says
/// what each holds.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trocar/base/result.h"

namespace trocar::dataset {

enum class Layout : std::uint8_t {
  kCholecSeg8k,  ///< a picture and three masks a frame, 13 classes
  kCholec80,     ///< phase of every frame, tools of every second
  kCholecT50,    ///< triplets of instrument, verb and target, with boxes
  kEndoscapes,   ///< COCO boxes and masks, the critical view's criteria
  kTrocar        ///< everything, HDF5
};
inline constexpr std::array kLayouts = {Layout::kCholecSeg8k, Layout::kCholec80, Layout::kCholecT50,
                                        Layout::kEndoscapes, Layout::kTrocar};
/// "cholecseg8k", "cholec80", "cholect50", "endoscapes", "trocar"
std::string_view NameOf(Layout layout) noexcept;
/// Nothing for another word.
std::optional<Layout> FindLayout(std::string_view name) noexcept;

/// Plan of a data set. The same plan, program and graphics driver give the same bytes.
struct Plan {
  Layout layout = Layout::kCholecSeg8k;
  std::string task = "cholecystectomy";  ///< key of a task or an operation, or a file of either
  std::string level = "normal";          ///< of a task
  std::string surgeon = "expert";
  /// Patients in place of the scene's own, by turns: video i shows patient i modulo their number.
  std::vector<std::filesystem::path> patients;
  std::uint64_t first_seed = 1, last_seed = 1;  ///< a video each, both included
  /// In place of task, level, surgeon, patients and seeds: a video of each, numbered from 1.
  std::vector<std::filesystem::path> recordings;
  int width = 854, height = 480;  ///< [pixels], 16 to 4096
  double every = 1;               ///< between two frames of a video [s], 0.04 to 60
  double most_seconds = 1800;     ///< of a video, > 0
  bool has_variation = true;      ///< light, lens, colour and smoke differ by seed
  bool has_pictures = true;       ///< without: states, actions, forces and positions alone, of layout kTrocar
  int jobs = 1;                   ///< videos at a time; not part of what is made
};

struct Summary {
  std::size_t videos = 0, frames = 0, files = 0;
  double seconds = 0;  ///< of work
  std::string hash;    ///< SHA-256 of SHA256SUMS
};

/// Writes DIR.part... and renames it when it is whole.
/// \param output  a folder that is not there, or empty
/// \param on_progress  share of the videos, 0 to 1; what is done; called from one thread at a time
/// \return kUsage, kUnknownName, kFileUnwritable (rights, a full disk, a folder that holds something), or the errors of scene,
///         simulation and graphics
base::Result<Summary> WriteDataset(
    const Plan& plan, const std::filesystem::path& output,
    const std::function<void(double share, std::string_view doing)>& on_progress);

}  // namespace trocar::dataset
