// SPDX-License-Identifier: Apache-2.0
/// \file recording.h  One attempt in a file: what it was of, every input, the state's hash now and then, saved states
/// (keyframes), events, marks and the outcome. Everything else is computed again. docs/recording.md describes the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/scene/input.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/engine_bits.h"

namespace trocar::record {

/// Identity of a recording: the scene it is made from and who played it.
struct Description {
  /// How `name` is read: a scene's file, a task or an operation.
  enum class Kind : std::uint8_t { kScene, kTask, kOperation };
  Kind kind = Kind::kScene;
  std::string name;         ///< key or path
  std::string level;        ///< of a task; of an operation empty at scene::kNormalLevel
  std::string patient;      ///< folder in place of the scene's own, or empty
  std::uint64_t seed = 0;   ///< of the scene
  double tick_seconds = 0;  ///< [s]
  std::uint64_t model = 0;  ///< fingerprint: simulation::Simulation::ModelFingerprint
  /// Fields that `model` covers; kFirst where a file does not say.
  simulation::ModelFingerprintKind model_kind = simulation::ModelFingerprintKind::kFirst;
  std::uint64_t first_tick =
      0;               ///< at which it begins; not 0 where it goes on from a saved state or another recording
  std::string player;  ///< "expert, seed 3", "mouse and keyboard", ...
  std::string program;   ///< version that wrote it
  int engine_bits = 1;   ///< its simulation::kEngineBits; 1 where a file does not say
  std::string compiler;  ///< that built it
  std::string started;   ///< wall clock with its offset: "2026-11-24T22:50:20+00:00"
  /// Where it goes on from another recording ("take over here", "what if"): its file's name and id, and the tick; else empty
  /// and 0.
  std::string branched_from;
  std::uint64_t branched_id = 0, branched_tick = 0;
};

/// Whether a program of this version and engine wrote it: then it replays to the bit, or was changed since.
bool IsOfThisProgram(const Description& description);

/// Makes the scene that a recording is of.
/// \return the file's errors; of another seed or patient is found out only by the model's fingerprint
base::Result<scene::Scene> MakeScene(const Description& description);

/// The state's fingerprint after a tick.
struct HashMark {
  std::uint64_t tick = 0;  ///< ticks done since the simulation's start
  std::uint64_t hash = 0;
};

/// Kind of the event that says which phase of an operation begins.
inline constexpr const char* kPhaseKind = "phase";

/// Something that happened, for lists and for jumping to it; replay computes it again.
struct EventMark {
  std::uint64_t tick = 0;
  std::string kind;   ///< surgery::FactName, the name of a task's or an operation's error, or kPhaseKind
  std::string about;  ///< for a person; may be empty; of a phase its name
  int hand = -1;      ///< scene::Hand, or -1
  bool is_error = false;
};

/// A remark that somebody made while it was recorded, or the recorder's own of a wall clock that jumped.
struct TextMark {
  std::uint64_t tick = 0;
  std::string text;
};

/// How it ended.
struct Ending {
  std::uint64_t ticks = 0;  ///< last tick of the simulation
  std::uint64_t hash = 0;   ///< of the state after it
  std::string outcome;      ///< JSON: outcome.h
};

/// Content of a recording's file. A file that ends early, or is damaged, is read up to there.
class Recording {
 public:
  struct Keyframe;

  Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;
  ~Recording();

  Description description;
  std::uint64_t file_id = 0;  ///< random: tells files apart that are of the same
  std::vector<scene::Input>
      inputs;  ///< input i belongs to the tick that makes description.first_tick + i + 1 ticks
  std::vector<HashMark> hashes;
  std::vector<EventMark> events;
  std::vector<TextMark> marks;
  std::optional<Ending> ending;  ///< nothing where the program was killed, or the file is cut
  /// Its file has an ending, whole by its checksum, that contradicts what stands before it or is not understood: it counts as none,
  /// and no cut makes one.
  bool is_ending_refused = false;
  std::string damage;             ///< why reading stopped before the end of the file; empty where it did not
  std::uint64_t whole_bytes = 0;  ///< of the file, up to the end or the damage
  std::uint64_t file_bytes = 0;

  std::uint64_t FirstTick() const { return description.first_tick; }
  std::uint64_t LastTick() const { return description.first_tick + inputs.size(); }
  double Seconds() const { return static_cast<double>(inputs.size()) * description.tick_seconds; }

  /// Ticks of the keyframes, ascending.
  const std::vector<std::uint64_t>& KeyframeTicks() const { return keyframe_ticks_; }
  /// The saved state of a keyframe, for Simulation::Restore.
  /// \param index  of KeyframeTicks
  base::Result<std::vector<std::byte>> ReadKeyframe(std::size_t index) const;

 private:
  friend class RecordingReader;
  std::vector<std::uint64_t> keyframe_ticks_;
  std::vector<Keyframe> keyframes_;  // compressed
};

/// Between the states of an index [s]: the ticks from one to the next take less than a second of processor time.
inline constexpr double kIndexSeconds = 2;
/// The state index beside a recording: attempt.trocar.index. It is made again where it is missing.
std::filesystem::path IndexPathOf(const std::filesystem::path& recording);
/// Deletes state indexes of a folder, the oldest first, until all of them together have no more than so many bytes.
/// The recordings stay.
void TrimIndexes(const std::filesystem::path& folder, std::uint64_t most_bytes);

/// Where attempts are kept that nobody named a file for: TROCAR_DATA_HOME, else XDG_DATA_HOME/trocar, else
/// HOME/.local/share/trocar; there "recordings".
std::filesystem::path FindRecordingFolder();

/// Reads a recording. What lies behind damage is not read: Recording::damage tells.
/// \return kFileMissing, kFileUnreadable, kFileTooLarge; kRecordingInvalid where not even the description is whole, or of
/// another format
base::Result<Recording> ReadRecording(const std::filesystem::path& path);
/// As above, from bytes in memory. \param name  for messages
base::Result<Recording> ReadRecording(std::span<const std::byte> bytes, const std::string& name);

/// Writes what is whole of a damaged or unfinished recording to a new file, and ends it.
/// \return kRecordingInvalid where there is nothing to repair, kFileUnwritable
base::Status RepairRecording(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace trocar::record
