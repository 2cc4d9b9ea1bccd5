// SPDX-License-Identifier: Apache-2.0
/// \file dicom_folder.h  DICOM files of a folder: slices with a place, and everything that lies beside them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "dicom_volumes.h"
#include "import_worker.h"
#include "trocar/base/result.h"
#include "trocar/images/image_stack.h"

namespace trocar::images {

/// A file that looks like DICOM and cannot be read.
struct UnreadableDicom {
  std::string file;
  base::Error error;
  std::uint64_t series_hash = 0;  ///< 0: it broke before it said of which series it is
};

struct FoundDicom {
  std::vector<DicomSlice> slices;  ///< in the order of their files, frames ascending
  std::vector<DicomSlice>
      placeless;  ///< pictures that do not say where they lie: secondary captures, dose reports
  std::map<DicomContent, std::size_t> others;
  std::vector<UnreadableDicom> unreadable;
  std::size_t copies = 0;  ///< files that hold the same instance as another
};

/// Looks at the header of each file.
/// \param links  whether the files may be symbolic links
/// \return kImagePathUnsafe, kImageChanged, kImportProgramMissing, kCancelled; no error of a single file but these
base::Result<FoundDicom> LookAtDicom(const std::filesystem::path& folder, std::span<const std::string> names,
                                     Links links, ImportPool& pool, const char* doing,
                                     const Progress& progress, const std::stop_token& stop = {});

/// Why a volume of the folder cannot be opened; nothing where it can. Slices of its series that cannot be read count as much as those
/// that are missing.
std::optional<base::Error> FindProblem(const FoundDicom& folder, std::span<const DicomVolume> volumes,
                                       const DicomVolume& volume);

/// Why the folder has no slices at all.
base::Error ExplainNoSlices(const FoundDicom& folder);

/// Remarks for a person: files beside the slices that were passed over, and files that cannot be read.
std::vector<std::string> TellPassedOver(const FoundDicom& folder);

}  // namespace trocar::images
