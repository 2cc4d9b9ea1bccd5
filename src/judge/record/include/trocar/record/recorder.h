// SPDX-License-Identifier: Apache-2.0
/// \file recorder.h  Records an attempt while it runs: the simulation's thread only hands over, a thread of the recorder's own
/// writes, and what it has written survives a killed program and a power cut.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "trocar/base/result.h"
#include "trocar/record/clocks.h"
#include "trocar/record/recording.h"
#include "trocar/record/storage.h"
#include "trocar/simulation/simulation.h"

namespace trocar::record {

struct RecorderSettings {
  double keyframe_seconds =
      36;  ///< between saved states: what seeking without an index computes at most [s]; 0: none
  double hash_seconds = 1;  ///< between hashes of the state [s]
  /// Between states of the index beside the recording, which makes seeking quick and may be deleted [s]; 0: none is written.
  double index_seconds = 0;
  std::uint64_t index_bytes = std::uint64_t{1} << 30;  ///< beyond it the index takes no more
  /// Where no person's time counts: Add waits for a writer that falls behind (else the recording would end there), and inputs are
  /// written in whole chunks of 100 ms of the simulation, however long these take.
  bool waits = false;
  OpenStorage open = MakeFile;
  /// Looked at by the writing thread: a wall clock that jumps is marked in the recording.
  std::function<ClockReading()> clocks = ReadClocks;
};

struct RecorderStatus {
  std::uint64_t added = 0;  ///< ticks handed over
  std::uint64_t kept = 0;   ///< of them on the disk, safe from kill and power cut
  std::uint64_t bytes = 0;  ///< of the file
  double seconds_left =
      std::numeric_limits<double>::infinity();  ///< until the disk is full, at the rate so far [s]
  bool is_space_low = false;                    ///< less than 60 s or 5 % of the disk
  std::filesystem::path
      path;  ///< of the file; another than at the start where the first could not be trusted
  std::optional<base::Error> failure;  ///< why it records no longer; the simulation goes on
};

/// One attempt. Add is called from the simulation's thread, all else from one other thread or the same.
class Recorder {
 public:
  /// Opens the file, and writes its description before it returns.
  /// \param description  tick_seconds, model, first_tick, program, compiler and started are filled in from the simulation
  /// \return kFileUnwritable, also where there is such a file already
  static base::Result<std::unique_ptr<Recorder>> Start(const std::filesystem::path& path,
                                                       Description description,
                                                       const simulation::Simulation& simulation,
                                                       RecorderSettings settings = {});
  /// Without Finish: what was added is written, but no ending, as after a kill.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// After every Step. \param input  with which it was made
  /// \note No lock, no file. A hash costs one Simulation::Hash, a keyframe one Simulation::Save, each at its interval.
  void Add(const scene::Input& input, const simulation::Simulation& simulation) noexcept;
  /// Somebody's remark at the newest tick that was added.
  void Mark(std::string text);
  RecorderStatus Status() const;
  /// Writes the rest and how it ended.
  /// \return why the recording is not whole
  base::Status Finish(const simulation::Simulation& simulation);

 private:
  struct Content;
  explicit Recorder(std::unique_ptr<Content> content);
  std::unique_ptr<Content> content_;
};

}  // namespace trocar::record
