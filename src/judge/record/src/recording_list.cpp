// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recording_list.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "chunk.h"
#include "recording_json.h"
#include "trocar/host/json.h"

namespace trocar::record {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

class FileView {
 public:
  explicit FileView(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)) {
    struct stat info {};
    if (descriptor_ >= 0 && ::fstat(descriptor_, &info) == 0 && S_ISREG(info.st_mode))
      size_ = static_cast<std::uint64_t>(info.st_size);
  }
  ~FileView() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FileView(const FileView&) = delete;
  FileView& operator=(const FileView&) = delete;

  bool IsOpen() const { return descriptor_ >= 0; }
  std::uint64_t Size() const { return size_; }
  bool Read(std::uint64_t offset, void* data, std::size_t size) const {
    if (offset + size > size_) return false;
    return ::pread(descriptor_, data, size, static_cast<off_t>(offset)) == static_cast<ssize_t>(size);
  }

 private:
  int descriptor_;
  std::uint64_t size_ = 0;
};

/// Takes a chunk whose content is read. \return false where it is not what it says
bool Take(const ChunkHeader& chunk, std::span<const std::byte> content, std::vector<EventMark>& events,
          RecordingSummary& summary) {
  const auto text = TextOf(content);
  if (chunk.kind == ChunkKind::kDescription) return ReadDescription(text, summary.description);
  if (chunk.kind == ChunkKind::kEvents) return ReadEvents(text, events);
  Ending ending;
  if (!ReadEnding(text, ending)) return false;
  summary.is_finished = true;
  summary.outcome = std::move(ending.outcome);
  return true;
}

/// Walks from chunk to chunk. \return false where one is not whole
bool ReadChunks(const FileView& file, std::uint64_t file_id, RecordingSummary& summary) {
  std::vector<EventMark> events;
  std::vector<std::byte> content;
  std::uint64_t at = sizeof(FileHeader), number = 0, last_tick = 0;
  bool is_whole = true;
  for (ChunkHeader chunk; at < file.Size(); at += sizeof chunk + chunk.size, ++number) {
    is_whole = file.Read(at, &chunk, sizeof chunk) && chunk.magic == ChunkHeader{}.magic &&
               chunk.number == number && chunk.size <= kMostContent &&
               at + sizeof chunk + chunk.size <= file.Size() &&
               (chunk.kind == ChunkKind::kDescription) == (number == 0);
    if (!is_whole) break;
    if (chunk.kind == ChunkKind::kInputs) {
      std::uint32_t count = 0;
      is_whole = chunk.size >= sizeof count && file.Read(at + sizeof chunk, &count, sizeof count);
      if (!is_whole) break;
      last_tick = chunk.tick + (count & ~kNewRow);
    } else if (chunk.kind == ChunkKind::kDescription || chunk.kind == ChunkKind::kEvents ||
               chunk.kind == ChunkKind::kEnding) {
      content.resize(chunk.size);
      is_whole = file.Read(at + sizeof chunk, content.data(), content.size()) &&
                 chunk.checksum == CalcChunkChecksum(file_id, chunk, content) &&
                 Take(chunk, content, events, summary);
      if (!is_whole) break;
    }
  }
  const Description& d = summary.description;
  if (last_tick > d.first_tick)
    summary.seconds = static_cast<double>(last_tick - d.first_tick) * d.tick_seconds;
  summary.errors = static_cast<std::size_t>(
      std::count_if(events.begin(), events.end(), [](const EventMark& event) { return event.is_error; }));
  return is_whole;
}

double NumberOf(const ordered_json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_number() ? found->get<double>() : 0;
}

bool IsTrue(const ordered_json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && *found == true;
}

std::string NumberText(double value, const char* form) {
  char text[32];
  std::snprintf(text, sizeof text, form, value);
  return text;
}

}  // namespace

base::Result<RecordingSummary> ReadSummary(const fs::path& path) {
  const FileView file(path);
  if (!file.IsOpen())
    return base::Error{base::ErrorCode::kFileMissing,
                       path.string() + " cannot be opened; check its name and rights"};
  FileHeader header;
  RecordingSummary summary;
  summary.path = path;
  summary.bytes = file.Size();
  const auto refuse = [&](const std::string& why) {
    return base::Error{base::ErrorCode::kRecordingInvalid, path.string() + why};
  };
  if (!file.Read(0, &header, sizeof header) || header.magic != FileHeader{}.magic)
    return refuse(" is no recording of Trocar; --record writes one");
  if (header.format > kFormat) {
    return refuse(" was written in format " + std::to_string(header.format) + ", this program reads up to " +
                  std::to_string(kFormat) + "; use the version that wrote it, or a newer one");
  }
  if (header.checksum != CalcHeaderChecksum(header))
    return refuse(" is damaged in its header; take another copy of it");
  summary.is_whole = ReadChunks(file, header.file_id, summary);
  if (summary.description.name.empty()) return refuse(" has no whole description; take another copy of it");
  return summary;
}

std::vector<RecordingSummary> ListRecordings(const fs::path& folder) {
  std::vector<std::pair<fs::file_time_type, RecordingSummary>> found;
  std::error_code failure;
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end; at.increment(failure)) {
    if (at->path().extension() != ".trocar") continue;
    auto summary = ReadSummary(at->path());
    std::error_code ignored;
    if (summary.ok()) found.emplace_back(at->last_write_time(ignored), std::move(*summary));
  }
  // the clock of a file has no time zone; names only part those of one instant
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second.path > b.second.path;
  });
  std::vector<RecordingSummary> list;
  for (auto& entry : found) list.push_back(std::move(entry.second));
  return list;
}

std::string DescribeOutcome(const std::string& outcome) {
  const auto parsed = host::ParseJson<ordered_json>(outcome, "the outcome", host::kSmallJson);
  if (!parsed.ok() || !parsed->is_object()) return {};
  const ordered_json& json = *parsed;
  if (const auto task = json.find("task"); task != json.end() && task->is_object()) {
    const auto phase = task->find("phase");
    std::string text = phase != task->end() && phase->is_string() ? phase->get<std::string>() : "";
    std::replace(text.begin(), text.end(), '_', ' ');
    // only the task knows the unit of its score, and what was not completed has none
    if (text == "completed") text += ", score " + NumberText(NumberOf(*task, "score"), "%.1f");
    return text;
  }
  if (const auto operation = json.find("operation"); operation != json.end() && operation->is_object()) {
    std::string text = IsTrue(*operation, "completed") ? "completed" : "not completed";
    if (IsTrue(*operation, "critical_view")) text += ", critical view";
    return text + ", " + NumberText(NumberOf(*operation, "blood_ml"), "%.0f") + " mL of blood";
  }
  return {};
}

}  // namespace trocar::record
