// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "import_worker.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr double kBytesPerSecond = 16.0 * (1 << 20);  // slowest decoding that is waited for
constexpr std::uint32_t kGraceSeconds = 5;            // after which a reader without a parent ends itself

bool IsTerminated(const char* text, std::size_t size) {
  return std::memchr(text, '\0', size) != nullptr;
}

bool IsFinite(std::span<const double> numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double number) { return std::isfinite(number); });
}

/// Whether a header says nothing that could hurt us: the reader may have been taken over by the file.
bool IsSane(const ImageHeader& header, const ImportLimits& limits) {
  const bool is_enumerated = header.kind >= FileKind::kJpeg && header.kind <= FileKind::kMetaImage &&
                             header.samples <= kLastSampleKind && header.frame <= FileFrame::kRas;
  const bool is_layered = header.is_layered == 1 && header.kind == FileKind::kNrrd;
  const bool has_channels = is_layered
                                ? header.channels >= 1 && header.channels <= kMostLayers
                                : header.is_layered == 0 && (header.channels == 1 || header.channels == 3);
  const bool is_sized = header.width >= 1 && header.width <= limits.most_side && header.height >= 1 &&
                        header.height <= limits.most_side && header.depth >= 1 &&
                        header.depth <= limits.most_side && has_channels && header.bits >= 1 &&
                        header.bits <= 64;
  if (!is_enumerated || !is_sized) return false;
  // four sides of 14 bits at most, so this cannot overflow with the default limits; with any, it is checked
  std::uint64_t bytes = SampleBytes(header.samples);
  for (const std::uint64_t factor : {header.width, header.height, header.depth, header.channels}) {
    if (__builtin_mul_overflow(bytes, factor, &bytes)) return false;
  }
  bool is_finite =
      IsFinite(header.spacing) && IsFinite(header.origin) &&
      IsFinite(std::array{header.slope, header.intercept, header.window_centre, header.window_width});
  for (const auto& axis : header.direction) is_finite = is_finite && IsFinite(axis);
  const std::string_view data_file(header.data_file, ::strnlen(header.data_file, sizeof(header.data_file)));
  const bool is_below = data_file.empty() || IsPathBelow(data_file);
  return bytes <= limits.most_bytes && is_finite && is_below && header.is_data_beside <= 1 &&
         header.segments <= kMostSegments && IsTerminated(header.data_file, sizeof(header.data_file)) &&
         IsTerminated(header.description, sizeof(header.description)) &&
         std::all_of(std::begin(header.spacing), std::end(header.spacing),
                     [](double spacing) { return spacing >= 0 && spacing <= 200; });
}

bool IsSane(const ImportReply& reply, const ImportLimits& limits) {
  if (reply.version != kImportVersion || !IsTerminated(reply.why, sizeof(reply.why))) return false;
  if (reply.header.content > kLastDicomContent) return false;
  for (const SegmentName& name : reply.names) {
    if (!IsTerminated(name.name, sizeof(name.name)) || !IsTerminated(name.code, sizeof(name.code)) ||
        name.label < 0 || name.layer >= kMostLayers)
      return false;
  }
  if (reply.code == 0) return IsSane(reply.header, limits);
  return reply.code >= static_cast<int>(ErrorCode::kImageFolderMissing) &&
         reply.code <= static_cast<int>(ErrorCode::kImportOutOfMemory);
}

/// A message's pattern, for translators: file, what was wrong, and what mends it.
const char* FindRemedy(ErrorCode code) {
  switch (code) {
    case ErrorCode::kImageSliceMissing:
      return host::Mark("{1}: {2}; name the folder of the slices");
    case ErrorCode::kImageTooLarge:
      return host::Mark("{1}: {2}; crop or resample it, or allow more memory");
    case ErrorCode::kImageUnsupported:
      return host::Mark("{1}: {2}; convert it, for instance with 3D Slicer, to DICOM, NIfTI or NRRD");
    case ErrorCode::kImageGeometryInvalid:
      return host::Mark("{1}: {2}; correct the header, or export it again");
    case ErrorCode::kImagePathUnsafe:
      return host::Mark("{1}: {2}; put header and data into one folder");
    case ErrorCode::kImportOutOfMemory:
      return host::Mark("{1}: {2}; it is damaged, or too large for this computer");
    case ErrorCode::kImportCrashed:
    case ErrorCode::kImportTimedOut:
      return host::Mark("{1}: {2}; the file is damaged or made to do harm; get it again");
    default:
      return host::Mark("{1}: {2}; get the file again");
  }
}

}  // namespace

ImportPool::ImportPool(ImportLimits limits, std::size_t most_workers)
    : limits_(std::move(limits)), most_workers_(most_workers) {
  TROCAR_ASSERT(most_workers_ > 0);
}

base::Result<ImportReply> ImportPool::Ask(const ImportRequest& request, std::span<const int> descriptors,
                                          double seconds) {
  std::unique_ptr<ImportWorker> worker;
  {
    std::unique_lock lock(mutex_);
    returned_.wait(lock, [&] { return busy_ < most_workers_; });
    ++busy_;
    // one that ended while nobody asked it anything says nothing about this file
    std::erase_if(idle_, [](const auto& other) { return !other->IsReady(); });
    if (!idle_.empty()) {
      worker = std::move(idle_.back());
      idle_.pop_back();
    }
  }
  base::Result<ImportReply> answer = Error{};
  if (!worker) {
    auto started = ImportWorker::Start(limits_);
    if (started)
      worker = std::move(*started);
    else
      answer = started.error();
  }
  if (worker) {
    answer = worker->Ask(request, descriptors, seconds);
    if (answer && !IsSane(*answer, limits_)) {
      answer = Error{ErrorCode::kImportCrashed, "its reader answered nonsense"};
      worker.reset();
    }
  }
  {
    const std::scoped_lock lock(mutex_);
    --busy_;
    if (worker && worker->IsAlive()) idle_.push_back(std::move(worker));
  }
  returned_.notify_one();
  return answer;
}

base::Result<ImportReply> ImportPool::Probe(const ImportFile& file, const ImportFile* data_file,
                                            ImageHeader* refused) {
  ImportRequest request;
  request.has_data_file = data_file != nullptr;
  request.most_side = limits_.most_side;
  request.most_bytes = limits_.most_bytes;
  request.is_size_believed = limits_.is_size_believed;
  request.seconds = base::TruncateTo<std::uint32_t>(limits_.seconds) + kGraceSeconds;
  const int descriptors[] = {file.Get(), data_file != nullptr ? data_file->Get() : -1};
  auto answer = Ask(request, {descriptors, data_file != nullptr ? 2u : 1u}, limits_.seconds);
  if (answer && answer->code != 0 && refused != nullptr) *refused = answer->header;
  if (auto status = CheckAnswer(file, answer); !status) return status.error();
  return answer;
}

base::Result<std::vector<ImageHeader>> ImportPool::ProbeFrames(const ImportFile& file,
                                                               const ImageHeader& header) {
  const std::uint64_t bytes = header.depth * sizeof(ImageHeader);
  const auto buffer = SampleBuffer::Make(bytes);
  if (!buffer) return buffer.error();
  ImportRequest request;
  request.operation = ImportOperation::kProbeFrames;
  request.most_side = limits_.most_side;
  request.most_bytes = limits_.most_bytes;
  request.is_size_believed = limits_.is_size_believed;
  request.seconds = base::TruncateTo<std::uint32_t>(limits_.seconds) + kGraceSeconds;
  request.capacity = bytes;
  const int descriptors[] = {file.Get(), buffer->Get()};
  const auto answer = Ask(request, descriptors, limits_.seconds);
  if (auto status = CheckAnswer(file, answer); !status) return status.error();
  // copied first: the reader could write on
  std::vector<ImageHeader> frames(header.depth);
  std::memcpy(frames.data(), buffer->Data(), bytes);
  for (const ImageHeader& frame : frames) {
    const bool is_alike = frame.width == header.width && frame.height == header.height && frame.depth == 1 &&
                          frame.channels == header.channels && frame.samples == header.samples;
    if (!is_alike || !IsSane(frame, limits_) || frame.content > kLastDicomContent)
      return NameFile(file.Path(), {ErrorCode::kImportCrashed, "its reader answered nonsense"});
  }
  return frames;
}

base::Status ImportPool::CheckAnswer(const ImportFile& file, const base::Result<ImportReply>& answer) {
  if (!answer) return NameFile(file.Path(), answer.error());
  if (answer->code != 0) {
    return NameFile(file.Path(), {static_cast<ErrorCode>(answer->code),
                                  host::Printable(answer->why, sizeof(answer->why))});
  }
  return file.CheckUnchanged();
}

base::Status ImportPool::Decode(const ImportFile& file, const ImportFile* data_file,
                                const ImageHeader& header, const SampleBuffer& buffer, std::uint64_t offset) {
  const std::uint64_t bytes = header.SampleCount() * SampleBytes(header.samples);
  TROCAR_ASSERT(offset <= buffer.Bytes() && bytes <= buffer.Bytes() - offset);
  const double seconds = limits_.seconds + static_cast<double>(bytes) / kBytesPerSecond;
  ImportRequest request;
  request.operation = ImportOperation::kDecode;
  request.has_data_file = data_file != nullptr;
  request.most_side = limits_.most_side;
  request.most_bytes = limits_.most_bytes;
  request.is_size_believed = limits_.is_size_believed;
  request.seconds = base::TruncateTo<std::uint32_t>(seconds) + kGraceSeconds;
  request.offset = offset;
  request.capacity = bytes;
  std::vector<int> descriptors = {file.Get()};
  if (data_file != nullptr) descriptors.push_back(data_file->Get());
  descriptors.push_back(buffer.Get());
  const auto answer = Ask(request, descriptors, seconds);
  if (auto status = CheckAnswer(file, answer); !status) return status;
  const ImageHeader& said = answer->header;
  if (said.width != header.width || said.height != header.height || said.depth != header.depth ||
      said.channels != header.channels || said.samples != header.samples) {
    return Error{ErrorCode::kImageChanged,
                 host::Printable(file.Path().string()) + " changed while it was read; open it again"};
  }
  return data_file != nullptr ? data_file->CheckUnchanged() : base::Status{};
}

Error NameFile(const fs::path& path, const Error& error) {
  if (error.code == ErrorCode::kImportProgramMissing) return error;
  const std::string_view remedy =
      std::string_view(FindRemedy(error.code)).substr(std::string_view("{1}: {2}; ").size());
  return {error.code, host::Printable(path.string()) + ": " + error.message + "; " + std::string(remedy)};
}

}  // namespace trocar::images
