// SPDX-License-Identifier: Apache-2.0
/// \file local_port.h  Lines to another program of this machine, by the path of a socket: spacenavd, and emulated devices that
/// have no serial line.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "trocar/device/ports.h"

namespace trocar::device {

enum class LocalLine {
  kStream,  ///< bytes without borders
  kPackets  ///< each Write() is one Read() at the far end, as HID reports are
};

/// \return kDeviceLost, with what the system says
base::Result<std::unique_ptr<Transport>> ConnectLocal(const std::string& path, LocalLine line);

/// True if a socket lies at `path`; whether somebody listens, only ConnectLocal() says.
bool IsLocalSocket(const std::string& path) noexcept;

/// Waits for callers; the path is gone with it.
class LocalListener {
 public:
  /// \return kDeviceBusy where the path is taken or cannot be a socket's
  static base::Result<std::unique_ptr<LocalListener>> Make(const std::string& path, LocalLine line);
  ~LocalListener();
  LocalListener(const LocalListener&) = delete;
  LocalListener& operator=(const LocalListener&) = delete;

  /// The next caller, or null where nobody calls just now.
  std::unique_ptr<Transport> Accept() noexcept;
  const std::string& Path() const noexcept { return path_; }

 private:
  LocalListener(int file, std::string path) : file_(file), path_(std::move(path)) {}
  int file_;
  std::string path_;
};

}  // namespace trocar::device
