// SPDX-License-Identifier: Apache-2.0
/// \file reader.h  The parts of the image reader (trocar-import), a process of its own that opens strangers'
/// files. Readers throw Failure, or whatever their library throws; main.cpp turns that into a reply.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "import_protocol.h"
#include "trocar/base/error_codes.h"

namespace trocar::images::import {

/// Why a file is not read. `why` goes to the person: it holds numbers and names of fields, types and units of the header
/// (Shown of header_text.h), and nothing else from the file.
struct Failure {
  base::ErrorCode code;
  std::string why;
};

/// An open file, as large as it was when it was opened.
struct InputFile {
  int fd = -1;
  std::uint64_t bytes = 0;
  /// A name under which libraries can open it again.
  std::string Path() const { return "/proc/self/fd/" + std::to_string(fd); }
};

/// One request.
struct Job {
  InputFile file;
  std::optional<InputFile> data_file;
  ImportRequest request;
  std::byte* samples =
      nullptr;  ///< where to put them; null: read the header only. Of kProbeFrames, the headers
};

/// \throw Failure kImageTooLarge when the product of the numbers exceeds 2^64
std::uint64_t CheckedProduct(std::initializer_list<std::uint64_t> factors);

/// Sides, number of samples and their bytes against the request. Call before anything is allocated.
/// \throw Failure kImageTooLarge or kImageUndecodable
void CheckSize(const ImageHeader& header, const ImportRequest& request);

/// \throw Failure kImageGeometryInvalid unless all are finite and, where said, lengths are 0.001 to 200 mm
void CheckGeometry(const ImageHeader& header);

void ReadPicture(const Job& job, FileKind kind, ImportReply& reply);
void ReadDicom(const Job& job, ImportReply& reply);
void ReadNifti(const Job& job, ImportReply& reply);
/// Whether a file begins like ANALYZE 7.5, from which NIfTI comes: the same header without its mark.
bool IsAnalyze(std::string_view begin);
void ReadNrrd(const Job& job, ImportReply& reply);
void ReadMetaImage(const Job& job, ImportReply& reply);

/// Limits memory to `memory_bytes` of address space, forbids core files, new programs, network and writing.
void EnterSandbox(std::uint64_t memory_bytes);

}  // namespace trocar::images::import
