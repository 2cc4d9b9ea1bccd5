// SPDX-License-Identifier: Apache-2.0
/// \file companion.h  A small program of our own that runs beside this one: a socket and a page of memory are shared with it.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>

#include "trocar/base/result.h"

namespace trocar::device {

/// Owns the process and our ends. The program sees our socket close when this process ends, however it ends.
class Companion {
 public:
  /// Descriptors that the program finds.
  static constexpr int kSocket = 3, kPage = 4;
  /// For its own end after the socket has closed; then it is killed [s].
  static constexpr double kPatience = 2.0;

  /// A program beside this one, or in ../libexec/trocar.
  static std::filesystem::path Find(const char* name);

  /// Starts the program with one option, in a session of its own: Ctrl-C and Ctrl-Z of our terminal do not reach it.
  ///
  /// \param bytes  of the page, all zero
  /// \param code   of an error; its message says what failed and ends with `remedy`
  static base::Result<Companion> Start(const std::filesystem::path& program, const char* option,
                                       std::size_t bytes, base::ErrorCode code, const std::string& remedy);
  Companion(Companion&& other) noexcept;
  Companion& operator=(Companion&& other) noexcept;
  /// Closes the socket and waits for the program's end.
  ~Companion();

  /// Ends the program at once, whatever it does; the system closes what it has open.
  /// \note Real-time safe.
  void Kill() noexcept;
  /// Messages keep their bounds (SOCK_SEQPACKET).
  int Socket() const noexcept { return socket_; }
  void* Page() const noexcept { return page_; }
  pid_t Process() const noexcept { return process_; }
  /// For others that watch the program with us: the file behind Page(), and a descriptor of the process that no other process
  /// can come to stand for.
  int PageFile() const noexcept { return page_file_; }
  int Handle() const noexcept { return handle_; }

 private:
  Companion() = default;
  void End() noexcept;

  pid_t process_ = -1;
  int socket_ = -1, page_file_ = -1, handle_ = -1;
  void* page_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace trocar::device
