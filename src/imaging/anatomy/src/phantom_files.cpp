// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>

#include "phantom_files.h"
#include "trocar/anatomy/phantom.h"
#include "trocar/base/assert.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/png_file.h"
#include "trocar/images/slice_names.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;

std::string FormatVector(const std::array<double, 3>& v) {
  char text[128];
  std::snprintf(text, sizeof(text), "(%.17g,%.17g,%.17g)", v[0], v[1], v[2]);
  return text;
}

base::Status WriteContent(const fs::path& folder, const Phantom& phantom, const patient::Patient& patient,
                          const images::Progress& progress) {
  std::error_code failure;
  fs::create_directories(folder / "slices", failure);
  if (failure) {
    return base::Error{
        base::ErrorCode::kFileUnwritable,
        folder.string() + ": " + failure.message() + "; check the folder, its rights and the space left"};
  }
  const contours::ControlPoints points = phantom.MakeControlPoints();
  // some slices at a time, so that progress is told from one thread
  constexpr int kBatch = 8;
  std::array<base::Status, kBatch> written;
  for (int first = 1; first <= phantom.SliceCount(); first += kBatch) {
    const int count = std::min(kBatch, phantom.SliceCount() - first + 1);
    tbb::parallel_for(0, count, [&](int i) {
      written[i] =
          images::WritePng(folder / "slices" / images::FormatImageName(points.image_pattern, first + i),
                           phantom.DrawSlice(first + i));
    });
    for (int i = 0; i < count; ++i) {
      if (!written[i]) return written[i];
    }
    if (progress) progress("slices", 0.9 * (first + count - 1) / phantom.SliceCount());
  }
  if (auto status = WriteLabelVolume(folder / "labels.nrrd", phantom.MakeLabels()); !status) return status;
  if (progress) progress("labels", 0.98);
  if (auto status = contours::WriteControlPoints(folder / "control_points.json", points); !status)
    return status;
  return files::WritePatient(folder / "patient", patient);
}

}  // namespace

base::Status WriteLabelVolume(const fs::path& path, const images::LabelVolume& volume) {
  std::string text = "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: " +
                     std::to_string(volume.size[0]) + " " + std::to_string(volume.size[1]) + " " +
                     std::to_string(volume.size[2]) + "\nspace directions:";
  for (const auto& direction : volume.direction) text += " " + FormatVector(direction);
  text += "\nkinds: domain domain domain\nencoding: raw\nspace origin: " + FormatVector(volume.origin) + "\n";
  for (std::size_t i = 0; i < volume.names.size(); ++i) {
    const std::string segment = "Segment" + std::to_string(i);
    text += segment + "_ID:=" + volume.names[i].first + "\n";
    text += segment + "_LabelValue:=" + std::to_string(volume.names[i].second) + "\n";
    text += segment + "_Layer:=0\n";
    text += segment + "_Name:=" + volume.names[i].first + "\n";
  }
  text += "\n";
  for (const std::int32_t label : volume.labels) {
    TROCAR_ASSERT(label <= 255);
    text += static_cast<char>(label);
  }
  return host::WriteFile(path, text);
}

base::Status WriteNewFolder(const fs::path& folder,
                            const std::function<base::Status(const fs::path&)>& write) {
  fs::path target = folder;
  if (!target.has_filename()) target = target.parent_path();
  std::error_code failure;
  if (fs::exists(target, failure) && !(fs::is_directory(target, failure) && fs::is_empty(target, failure))) {
    return base::Error{base::ErrorCode::kFileUnwritable,
                       target.string() + ": it exists and is no empty folder; name another one"};
  }
  const host::PartialPath part(target);
  const fs::path& partial = part.Path();
  auto status = write(partial);
  if (status) {
    // an empty folder may stand in the way
    fs::remove(target, failure);
    fs::rename(partial, target, failure);
    if (failure)
      status = base::Error{base::ErrorCode::kFileUnwritable,
                           target.string() + ": " + failure.message() + "; check the folder and its rights"};
  }
  return status;
}

base::Status WritePhantom(const fs::path& folder, const patient::Patient& patient,
                          const PhantomOptions& options, const images::Progress& progress) {
  const auto phantom = Phantom::Make(patient, options);
  if (!phantom) return phantom.error();
  return WriteNewFolder(
      folder, [&](const fs::path& partial) { return WriteContent(partial, *phantom, patient, progress); });
}

}  // namespace trocar::anatomy
