// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <string>

#include "dicom_folder.h"
#include "series_content.h"
#include "series_geometry.h"

namespace trocar::images {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

/// Where the samples of each file go: one with several frames is decoded whole.
struct FilePlaces {
  std::vector<const DicomSlice*> files;  // one slice of each
  std::vector<std::uint64_t> begin;      // of the file, in bytes
  std::vector<std::uint64_t> offsets;    // of each slice
  std::uint64_t bytes = 0;
};

FilePlaces PlaceFiles(const std::vector<DicomSlice>& slices, std::span<const std::size_t> order,
                      std::uint64_t picture) {
  FilePlaces places;
  std::map<std::string, std::uint64_t> begins;
  for (const std::size_t i : order) {
    const DicomSlice& slice = slices[i];
    const auto [at, is_new] = begins.emplace(slice.file, places.bytes);
    if (is_new) {
      places.files.push_back(&slice);
      places.begin.push_back(places.bytes);
      places.bytes += picture * slice.frames;
    }
    places.offsets.push_back(at->second + picture * slice.frame);
  }
  return places;
}

}  // namespace

base::Status OpenDicom(const fs::path& folder, std::span<const std::string> names, Links links,
                       const ImageSeriesOptions& options, const Progress& progress,
                       ImageSeries::Content& content) {
  auto found = LookAtDicom(folder, names, links, *content.pool, "looking at slices", progress);
  if (!found) return found.error();
  ImageSeriesInfo& info = content.info;
  if (found->slices.empty()) return ExplainNoSlices(*found);
  const std::vector<DicomVolume> volumes = SplitVolumes(found->slices, found->placeless);
  std::string choice;
  const auto chosen = ChooseVolume(volumes, options.series, choice);
  if (!chosen) return chosen.error();
  const DicomVolume& volume = volumes[*chosen];
  if (auto problem = FindProblem(*found, volumes, volume)) return *problem;
  const DicomOrder& order = *volume.order;
  if (!choice.empty()) info.notes.push_back(std::move(choice));
  if (!order.note.empty()) info.notes.push_back(order.note);
  for (std::string& note : TellPassedOver(*found)) info.notes.push_back(std::move(note));

  info.format = "DICOM";
  info.series = volume.number, info.series_id = volume.id;
  info.file_frame = "LPS";
  info.slice_numbers = order.numbers;
  content.places = order.places;
  for (const std::size_t slice : order.slices) content.headers.push_back(volume.slices[slice].header);
  const ImageHeader& first = content.headers.front();
  SaidGeometry said = GeometryOf(first);
  said.slice_mm = order.slice_mm;
  said.direction[2] = order.direction;
  if (auto status = SetGeometry(said, first, options, info); !status) return status;

  const std::uint64_t picture = PictureBytes(first);
  FilePlaces places = PlaceFiles(volume.slices, order.slices, picture);
  if (places.bytes > content.pool->Limits().most_bytes) {
    return Error{ErrorCode::kImageTooLarge, "its " + std::to_string(places.bytes / picture) +
                                                " slices unpack to " + std::to_string(places.bytes >> 20) +
                                                " MiB, more than the " +
                                                std::to_string(content.pool->Limits().most_bytes >> 20) +
                                                " MiB allowed; open a part of it"};
  }
  info.ignored_files += names.size() - places.files.size();
  auto samples = SampleBuffer::Make(places.bytes);
  if (!samples) return samples.error();
  content.samples = std::move(*samples);
  content.offsets = std::move(places.offsets);
  const auto decoded =
      ForEach(places.files.size(), progress, "reading slices", [&](std::size_t i) -> base::Status {
        const DicomSlice& slice = *places.files[i];
        const auto file = ImportFile::Open(folder / slice.file, links);
        if (!file) return file.error();
        ImageHeader whole = slice.header;
        whole.depth = slice.frames;
        return content.pool->Decode(*file, nullptr, whole, content.samples, places.begin[i]);
      });
  if (!decoded) return decoded;
  SetGreyValues(content, info);
  return {};
}

}  // namespace trocar::images
