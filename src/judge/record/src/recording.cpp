// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recording.h"

#include <algorithm>
#include <cstring>
#include <random>
#include <utility>

#include "chunk.h"
#include "recording_json.h"
#include "state_coder.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/user_folder.h"
#include "trocar/host/version.h"
#include "trocar/record/input_codec.h"
#include "trocar/scene/task.h"
#include "trocar/simulation/engine_bits.h"

namespace trocar::record {
namespace {

/// Far beyond hours of operating.
constexpr std::size_t kLargestFile = std::size_t{2} << 30;

base::Error Refuse(std::string why) {
  return {base::ErrorCode::kRecordingInvalid, std::move(why)};
}

std::uint32_t WordOf(std::span<const std::byte> bytes) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data(), sizeof word);
  return word;
}

}  // namespace

/// A keyframe as it lies in the file. Those of a group are told apart from its first.
struct Recording::Keyframe {
  std::vector<std::byte> bytes;
  std::size_t base = 0;  // index of the keyframe that it is told apart from, or its own
};

Recording::Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
Recording::~Recording() = default;

base::Result<std::vector<std::byte>> Recording::ReadKeyframe(std::size_t index) const {
  const Keyframe& keyframe = keyframes_[index];
  std::vector<std::byte> state;
  if (keyframe.base != index) {
    const std::vector<std::byte> base = ExpandState(keyframes_[keyframe.base].bytes, nullptr);
    const StatePlanes planes(base);
    state = base.empty() ? base : ExpandState(keyframe.bytes, &planes);
  } else {
    state = ExpandState(keyframe.bytes, nullptr);
  }
  if (state.empty()) return Refuse("a keyframe of the recording cannot be expanded; seek to before it");
  return state;
}

/// Takes up chunk after chunk.
class RecordingReader {
 public:
  explicit RecordingReader(Recording& recording) : recording_(recording) {}

  /// \return why the bytes are not whole, or empty
  std::string Read(std::span<const std::byte> bytes) {
    FileHeader header;
    std::memcpy(&header, bytes.data(), sizeof header);
    file_id_ = header.file_id;
    std::size_t at = sizeof header;
    while (at < bytes.size()) {
      if (recording_.ending) return "there is more behind its end";
      ChunkHeader chunk;
      if (bytes.size() - at < sizeof chunk) return "it ends within a chunk";
      std::memcpy(&chunk, bytes.data() + at, sizeof chunk);
      if (chunk.magic != ChunkHeader{}.magic || chunk.size > kMostContent)
        return "there is no chunk where one begins";
      if (bytes.size() - at - sizeof chunk < chunk.size) return "it ends within a chunk";
      const auto content = bytes.subspan(at + sizeof chunk, chunk.size);
      if (chunk.checksum != CalcChunkChecksum(file_id_, chunk, content)) return "a checksum does not fit";
      if (chunk.number != next_number_) return "a chunk is missing";
      if (std::string why = Take(chunk, content); !why.empty()) return why;
      ++next_number_;
      at += sizeof chunk + chunk.size;
      recording_.whole_bytes = at;
    }
    return {};
  }

 private:
  std::string Take(const ChunkHeader& chunk, std::span<const std::byte> content) {
    if ((chunk.kind == ChunkKind::kDescription) != (chunk.number == 0))
      return "its description is not its first chunk";
    switch (chunk.kind) {
      case ChunkKind::kDescription:
        return ReadDescription(TextOf(content), recording_.description) ? ""
                                                                        : "its description is not understood";
      case ChunkKind::kInputs:
        return TakeInputs(chunk, content);
      case ChunkKind::kHash: {
        if (content.size() != 8 || chunk.tick != recording_.LastTick()) return "a hash is out of place";
        HashMark mark{chunk.tick, 0};
        std::memcpy(&mark.hash, content.data(), 8);
        recording_.hashes.push_back(mark);
        return {};
      }
      case ChunkKind::kKeyframe: {
        if (chunk.tick != recording_.LastTick()) return "a keyframe is out of place";
        auto& frames = recording_.keyframes_;
        const bool has_base = HasBase(content);
        if (!has_base) group_base_ = frames.size();
        if (has_base && group_base_ >= frames.size())
          return "a keyframe lacks the one that it is told apart from";
        frames.push_back({{content.begin(), content.end()}, has_base ? group_base_ : frames.size()});
        recording_.keyframe_ticks_.push_back(chunk.tick);
        return {};
      }
      case ChunkKind::kEvents:
        return ReadEvents(TextOf(content), recording_.events) ? "" : "its events are not understood";
      case ChunkKind::kMark:
        recording_.marks.push_back({chunk.tick, std::string(TextOf(content))});
        return {};
      case ChunkKind::kEnding: {
        Ending ending;
        recording_.is_ending_refused = true;
        if (!ReadEnding(TextOf(content), ending)) return "its ending is not understood";
        if (ending.ticks != recording_.LastTick()) return "its ending is of another tick";
        recording_.is_ending_refused = false;
        recording_.ending = std::move(ending);
        return {};
      }
    }
    return "a chunk is of an unknown kind";
  }

  std::string TakeInputs(const ChunkHeader& chunk, std::span<const std::byte> content) {
    if (content.size() < 4 || chunk.tick != recording_.LastTick()) return "a row of inputs is out of place";
    const std::uint32_t head = WordOf(content);
    if ((head & kNewRow) != 0) decoder_.Reset();
    content = content.subspan(4);
    for (std::uint32_t n = head & ~kNewRow; n > 0; --n) {
      scene::Input input;
      if (!decoder_.Decode(content, input)) return "a row of inputs is not understood";
      recording_.inputs.push_back(input);
    }
    return content.empty() ? "" : "a row of inputs is longer than it says";
  }

  Recording& recording_;
  std::uint64_t file_id_ = 0, next_number_ = 0;
  std::size_t group_base_ = 0;
  InputDecoder decoder_;
};

base::Result<Recording> ReadRecording(std::span<const std::byte> bytes, const std::string& name) {
  FileHeader header;
  if (bytes.size() < sizeof header) return Refuse(name + " is no recording: it ends within its header");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != FileHeader{}.magic)
    return Refuse(name + " is no recording of Trocar; --record writes one");
  if (header.format > kFormat) {
    return Refuse(name + " was written in format " + std::to_string(header.format) +
                  ", this program reads up to " + std::to_string(kFormat) +
                  "; use the version that wrote it, or a newer one");
  }
  if (header.checksum != CalcHeaderChecksum(header))
    return Refuse(name + " is damaged in its header; take another copy of it");
  Recording recording;
  recording.file_id = header.file_id;
  recording.file_bytes = bytes.size();
  recording.damage = RecordingReader(recording).Read(bytes);
  if (recording.description.name.empty()) {
    return Refuse(name + " has no whole description" +
                  (recording.damage.empty() ? "" : ": " + recording.damage) + "; take another copy of it");
  }
  return recording;
}

base::Result<Recording> ReadRecording(const std::filesystem::path& path) {
  const auto content = host::ReadFile(path, kLargestFile);
  if (!content.ok()) return content.error();
  return ReadRecording(std::as_bytes(std::span(*content)), path.string());
}

std::filesystem::path FindRecordingFolder() {
  return host::FindUserDataFolder() / "recordings";
}

bool IsOfThisProgram(const Description& d) {
  return d.program == host::VersionText() && d.engine_bits == simulation::kEngineBits;
}

base::Result<scene::Scene> MakeScene(const Description& d) {
  if (d.kind == Description::Kind::kOperation) {
    auto operation = files::FindOperation(d.name, d.patient, d.seed, d.level);
    if (!operation.ok()) return operation.error();
    if (*operation) return std::move(**operation);
    return base::Error{base::ErrorCode::kUnknownName,
                       "the recording is of the operation \"" + d.name + "\", which there is not here"};
  }
  if (d.kind == Description::Kind::kTask) {
    const auto path = files::FindTask(d.name);
    if (!path.ok()) return path.error();
    return files::ReadTask(*path, {d.level, d.seed, d.patient});
  }
  auto read = files::ReadScene(d.name, d.patient);
  if (read.ok()) read->seed = d.seed;
  return read;
}

base::Status RepairRecording(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto content = host::ReadFile(from, kLargestFile);
  if (!content.ok()) return content.error();
  const auto bytes = std::as_bytes(std::span(*content));
  const auto recording = ReadRecording(bytes, from.string());
  if (!recording.ok()) return recording.error();
  if (recording->damage.empty()) {
    return Refuse(from.string() + (recording->ending
                                       ? " is whole; there is nothing to repair"
                                       : " is whole as far as it goes; it can be replayed as it is"));
  }
  if (recording->inputs.empty())
    return Refuse(from.string() + " is damaged before its first input; nothing can be saved of it");
  return host::WriteFile(to, TextOf(bytes.first(recording->whole_bytes)));
}

}  // namespace trocar::record
