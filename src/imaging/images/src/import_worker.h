// SPDX-License-Identifier: Apache-2.0
/// \file import_worker.h  Image readers as processes of their own (docs/decisions/0009): started with limits
/// on memory and time, asked one thing at a time, and replaced when a file has killed them.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "import_file.h"
#include "import_protocol.h"
#include "import_socket.h"
#include "trocar/base/result.h"

namespace trocar::images {

/// Limits of an import: sizes, memory and time.
struct ImportLimits {
  std::uint32_t most_side = 16384;                      ///< of a picture [pixels]
  std::uint64_t most_bytes = std::uint64_t{2} << 30;    ///< of the samples of one file
  std::uint64_t reader_bytes = std::uint64_t{5} << 30;  ///< address space of a reader process
  double seconds = 20;            ///< for a header or a picture; volumes get a second more for every 16 MiB
  bool is_size_believed = false;  ///< headers are not compared with the bytes present: for negative controls
  std::filesystem::path program;  ///< the reader; empty: FindImportProgram()
};

/// trocar-import beside this program, or in ../libexec/trocar of an installation.
std::filesystem::path FindImportProgram();

/// Memory that a reader writes samples into and this program reads. It cannot shrink under us.
class SampleBuffer {
 public:
  /// \return kImportOutOfMemory
  static base::Result<SampleBuffer> Make(std::uint64_t bytes);
  SampleBuffer() = default;
  SampleBuffer(SampleBuffer&& other) noexcept;
  SampleBuffer& operator=(SampleBuffer&& other) noexcept;
  ~SampleBuffer();

  int Get() const { return descriptor_.Get(); }
  std::uint64_t Bytes() const { return bytes_; }
  const std::byte* Data() const { return data_; }

 private:
  Descriptor descriptor_;
  std::byte* data_ = nullptr;
  std::uint64_t bytes_ = 0;
};

/// One reader process.
class ImportWorker {
 public:
  /// Safe in a program with threads (posix_spawn, no fork). The reader inherits no descriptor, no variable of
  /// the environment but LD_LIBRARY_PATH, and no output.
  /// \return kImportProgramMissing
  static base::Result<std::unique_ptr<ImportWorker>> Start(const ImportLimits& limits);
  ~ImportWorker();
  ImportWorker(const ImportWorker&) = delete;
  ImportWorker& operator=(const ImportWorker&) = delete;

  /// Sends one request and waits for its reply, which has been checked.
  /// \return the reader's own refusal; or, and then this worker is dead, kImportCrashed, kImportTimedOut or
  ///         kImportOutOfMemory. Messages do not name the file.
  base::Result<ImportReply> Ask(const ImportRequest& request, std::span<const int> descriptors,
                                double seconds);
  bool IsAlive() const { return process_ > 0; }
  /// Whether it has not hung up since it was last asked.
  bool IsReady() const;

 private:
  ImportWorker(int process, Descriptor socket) : process_(process), socket_(std::move(socket)) {}
  base::Error FindCause();
  int End();

  int process_;
  Descriptor socket_;
};

/// Some workers, started when needed, shared by threads.
class ImportPool {
 public:
  /// \param most_workers  > 0
  ImportPool(ImportLimits limits, std::size_t most_workers);

  const ImportLimits& Limits() const { return limits_; }

  /// Reads the header of `file`, with the name of its data file that is still to be opened, or the names of its
  /// labels.
  /// \param[out] refused  of a file that is refused: what its reader had found out by then; only `content` and `series_hash` count
  base::Result<ImportReply> Probe(const ImportFile& file, const ImportFile* data_file = nullptr,
                                  ImageHeader* refused = nullptr);
  /// A header of each frame of a DICOM file, as if each were a file; `header` is what Probe said.
  base::Result<std::vector<ImageHeader>> ProbeFrames(const ImportFile& file, const ImageHeader& header);
  /// Writes the samples to `offset` of the buffer; `header` is what Probe said.
  base::Status Decode(const ImportFile& file, const ImportFile* data_file, const ImageHeader& header,
                      const SampleBuffer& buffer, std::uint64_t offset);

 private:
  base::Result<ImportReply> Ask(const ImportRequest& request, std::span<const int> descriptors,
                                double seconds);
  static base::Status CheckAnswer(const ImportFile& file, const base::Result<ImportReply>& answer);

  ImportLimits limits_;
  std::size_t most_workers_;
  std::mutex mutex_;
  std::condition_variable returned_;
  std::size_t busy_ = 0;
  std::vector<std::unique_ptr<ImportWorker>> idle_;
};

/// "FILE: WHY; REMEDY" from an error that does not name the file.
base::Error NameFile(const std::filesystem::path& path, const base::Error& error);

}  // namespace trocar::images
