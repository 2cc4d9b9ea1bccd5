// SPDX-License-Identifier: Apache-2.0
/// \file file_transport.h  A Transport over a file descriptor that does not block.
#pragma once

#include "trocar/device/ports.h"

namespace trocar::device {

/// Owns a non-blocking descriptor of a terminal or a stream socket.
class FileTransport : public Transport {
 public:
  explicit FileTransport(int file) noexcept : file_(file) {}
  ~FileTransport() override;
  FileTransport(const FileTransport&) = delete;
  FileTransport& operator=(const FileTransport&) = delete;

  IoResult Read(std::span<char> buffer) noexcept override;
  IoResult Write(std::string_view bytes) noexcept override;
  int GetFile() const noexcept override { return file_; }

 private:
  int file_;
};

}  // namespace trocar::device
