// SPDX-License-Identifier: Apache-2.0
/// \file dicom_structure.h  The skeleton of a DICOM file, walked before GDCM sees it: GDCM 3.0 crashes on
/// some sequences that never end, and takes pixel data that were cut off for whole.
/// Source: DICOM PS3.5 sections 7.1, 7.5 and A.4, PS3.10 section 7.1.
#pragma once

#include <cstdint>

#include "reader.h"

namespace trocar::images::import {

struct DicomStructure {
  bool has_pixels = false;
  bool is_encapsulated = false;   ///< the pixels are compressed fragments
  std::uint64_t pixel_bytes = 0;  ///< of pixel data that are not
};

/// Checks that every element, item and fragment lies within the file and in what holds it, that whatever is
/// opened is closed, and that nothing is nested deeper than 64 levels. \throw Failure kImageTruncated,
/// kImageUndecodable, or kImageUnsupported for deflated files
DicomStructure CheckStructure(const InputFile& file);

}  // namespace trocar::images::import
