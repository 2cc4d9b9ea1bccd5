// SPDX-License-Identifier: Apache-2.0
#include "dicom_folder.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "series_content.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr std::size_t kMostNamed = 3;

/// What one file turned out to be.
struct Looked {
  std::vector<ImageHeader> frames;
  std::optional<DicomContent> other;
  std::optional<UnreadableDicom> unreadable;
};

/// Errors that are not of the file alone, or that a person must see to before anything else.
bool EndsAll(ErrorCode code) {
  return code == ErrorCode::kImportProgramMissing || code == ErrorCode::kImageChanged ||
         code == ErrorCode::kImagePathUnsafe || code == ErrorCode::kCancelled;
}

base::Result<Looked> LookAt(const fs::path& path, Links links, ImportPool& pool) {
  Looked looked;
  ImageHeader refused;
  const auto set_aside = [&](const Error& error) -> base::Result<Looked> {
    if (EndsAll(error.code)) return error;
    if (refused.content != DicomContent::kPictures)
      looked.other = refused.content;
    else
      looked.unreadable = UnreadableDicom{path.filename().string(), error, refused.series_hash};
    return std::move(looked);
  };
  const auto file = ImportFile::Open(path, links);
  if (!file) return set_aside(file.error());
  const auto reply = pool.Probe(*file, nullptr, &refused);
  if (!reply) return set_aside(reply.error());
  if (reply->header.depth == 1) {
    looked.frames = {reply->header};
    return looked;
  }
  refused = reply->header;
  auto frames = pool.ProbeFrames(*file, reply->header);
  if (!frames) return set_aside(frames.error());
  looked.frames = std::move(*frames);
  return looked;
}

const char* NameContent(DicomContent content) {
  switch (content) {
    case DicomContent::kPictures:
      return host::Mark("images");
    case DicomContent::kSegmentation:
      return host::Mark("segmentations (SEG)");
    case DicomContent::kStructures:
      return host::Mark("sets of structures (RTSTRUCT)");
    case DicomContent::kDose:
      return host::Mark("doses (RTDOSE)");
    case DicomContent::kPlan:
      return host::Mark("plans or records of radiotherapy");
    case DicomContent::kReport:
      return host::Mark("reports (SR)");
    case DicomContent::kKeyObjects:
      return host::Mark("selections of key objects (KO)");
    case DicomContent::kPresentation:
      return host::Mark("presentation states (PR)");
    case DicomContent::kDirectory:
      return host::Mark("lists of contents (DICOMDIR)");
    case DicomContent::kDocument:
      return host::Mark("documents");
    case DicomContent::kRawData:
      return host::Mark("raw data");
    case DicomContent::kRegistration:
      return host::Mark("registrations");
    case DicomContent::kWaveform:
      return host::Mark("waveforms");
    case DicomContent::kParametricMap:
      return host::Mark("parametric maps");
    case DicomContent::kSurface:
      return host::Mark("surfaces");
    case DicomContent::kOther:
      break;
  }
  return host::Mark("others without a picture");
}

/// What lies beside the slices: its name and how many there are.
std::vector<std::pair<const char*, std::size_t>> CountOthers(const FoundDicom& folder) {
  std::vector<std::pair<const char*, std::size_t>> others;
  for (const auto& [content, count] : folder.others) others.push_back({NameContent(content), count});
  if (!folder.placeless.empty())
    others.push_back({host::Mark("pictures that do not say where they lie"), folder.placeless.size()});
  if (folder.copies > 0) others.push_back({host::Mark("copies of other slices"), folder.copies});
  return others;
}

bool IsCopy(const DicomSlice& a, const DicomSlice& b) {
  return a.file != b.file &&
         std::equal(std::begin(a.header.origin), std::end(a.header.origin), b.header.origin) &&
         std::equal(std::begin(a.header.keys), std::end(a.header.keys), b.header.keys) &&
         a.header.instance_number == b.header.instance_number &&
         FindDifference(a.header, b.header) == nullptr;
}

}  // namespace

base::Result<FoundDicom> LookAtDicom(const fs::path& folder, std::span<const std::string> names, Links links,
                                     ImportPool& pool, const char* doing, const Progress& progress,
                                     const std::stop_token& stop) {
  std::vector<Looked> looked(names.size());
  const auto status = ForEach(names.size(), progress, doing, [&](std::size_t i) -> base::Status {
    if (stop.stop_requested()) return Error{ErrorCode::kCancelled, "the search for images was given up"};
    auto one = LookAt(folder / names[i], links, pool);
    if (!one) return one.error();
    looked[i] = std::move(*one);
    return {};
  });
  if (!status) return status.error();
  FoundDicom found;
  std::map<std::tuple<std::uint64_t, std::uint64_t, std::uint32_t>, std::size_t> instances;
  for (std::size_t i = 0; i < names.size(); ++i) {
    Looked& one = looked[i];
    if (one.other) ++found.others[*one.other];
    if (one.unreadable) found.unreadable.push_back(std::move(*one.unreadable));
    bool is_copy = false;
    for (std::uint32_t frame = 0; frame < one.frames.size(); ++frame) {
      DicomSlice slice{names[i], one.frames[frame], frame, static_cast<std::uint32_t>(one.frames.size())};
      if (slice.header.has_position == 0 || slice.header.spacing[0] == 0) {
        found.placeless.push_back(std::move(slice));
        continue;
      }
      if (slice.header.instance_hash != 0) {
        const auto [same, is_new] = instances.emplace(
            std::tuple(slice.header.series_hash, slice.header.instance_hash, frame), found.slices.size());
        if (!is_new && IsCopy(found.slices[same->second], slice)) {
          is_copy = true;
          continue;
        }
      }
      found.slices.push_back(std::move(slice));
    }
    found.copies += is_copy;
  }
  return found;
}

std::optional<Error> FindProblem(const FoundDicom& folder, std::span<const DicomVolume> volumes,
                                 const DicomVolume& volume) {
  const std::uint64_t series = volume.slices[0].header.series_hash;
  for (const UnreadableDicom& one : folder.unreadable) {
    if (one.series_hash == series && series != 0) return one.error;
  }
  for (const DicomSlice& one : folder.placeless) {
    if (one.header.series_hash == series && volume.is_volume) return OrderDicomSlices({&one, 1}).error();
  }
  if (volume.order.ok()) return std::nullopt;
  const Error& error = volume.order.error();
  if (error.code != ErrorCode::kImageSeriesGap) return error;
  // one that lies in the gap says more than the gap
  for (const DicomVolume& other : volumes) {
    if (&other == &volume) continue;
    if (auto stray = FindStrayInGap(volume.slices, other.slices)) return stray;
  }
  if (folder.unreadable.empty()) return error;
  return Error{error.code, error.message + "; among the files beside it that cannot be read is " +
                               host::Printable(folder.unreadable[0].file, 80)};
}

Error ExplainNoSlices(const FoundDicom& folder) {
  if (!folder.unreadable.empty()) return folder.unreadable[0].error;
  if (!folder.placeless.empty()) return OrderDicomSlices({folder.placeless.data(), 1}).error();
  std::string others;
  for (const auto& [name, count] : CountOthers(folder))
    others += (others.empty() ? "" : " and ") + std::string(name);
  return Error{ErrorCode::kImageSliceMissing,
               "its DICOM files hold no slices, but " + others + "; name the folder of the slices"};
}

std::vector<std::string> TellPassedOver(const FoundDicom& folder) {
  std::vector<std::string> notes;
  for (const auto& [name, count] : CountOthers(folder))
    notes.push_back(Note("passed over: " + std::string(name) + " (" + std::to_string(count) + ")"));
  for (std::size_t i = 0; i < folder.unreadable.size() && i < kMostNamed; ++i)
    notes.push_back(Note("left out, because it cannot be read: " + folder.unreadable[i].error.message));
  if (folder.unreadable.size() > kMostNamed) {
    notes.push_back(Note("left out, because they cannot be read: " +
                         std::to_string(folder.unreadable.size() - kMostNamed) + " more DICOM files"));
  }
  return notes;
}

}  // namespace trocar::images
