// SPDX-License-Identifier: Apache-2.0
/// \file dicom_structure.h  The skeleton of a DICOM file, walked before GDCM sees it: GDCM 3.0 crashes on
/// some sequences that never end, and takes pixel data that were cut off for whole.
/// Source: DICOM PS3.5 sections 7.1, 7.5 and A.4, PS3.10 section 7.1.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "reader.h"

namespace trocar::images::import {

struct DicomStructure {
  bool has_pixels = false, has_rows = false;
  bool is_encapsulated = false;           ///< the pixels are compressed fragments
  std::uint64_t pixel_bytes = 0;          ///< of pixel data that are not
  std::uint64_t end = ~std::uint64_t{0};  ///< of the elements: only filling follows
  // texts of the file, as far as they were reached before something was wrong
  std::string transfer_syntax, sop_class, modality, series;
};

/// A file's bytes in memory, unpacked where the whole data set is deflated, and with the right transfer syntax where the file names
/// another one of the two plain ones than it is written in.
class DicomBytes {
 public:
  /// \param most_bytes  that a deflated file may unpack to
  /// \throw Failure kImageTruncated, kImageUndecodable or kImageTooLarge for deflated data that are
  DicomBytes(const InputFile& file, std::uint64_t most_bytes);
  ~DicomBytes();
  DicomBytes(const DicomBytes&) = delete;
  DicomBytes& operator=(const DicomBytes&) = delete;

  std::string_view Get() const { return rewritten_ ? std::string_view(*rewritten_) : mapped_; }
  /// Whether these are other bytes than the file's.
  bool IsRewritten() const { return rewritten_.has_value(); }

 private:
  std::string_view mapped_;
  std::optional<std::string> rewritten_;
};

/// Checks that every element, item and fragment lies within the file and in what holds it, that whatever is
/// opened is closed, and that nothing is nested deeper than 64 levels.
/// \param[in,out] structure  holds what was read, also where it throws
/// \throw Failure kImageTruncated, kImageUndecodable, or kImageUnsupported for pixels packed in a way that is not read
void CheckStructure(std::string_view bytes, DicomStructure& structure);

}  // namespace trocar::images::import
