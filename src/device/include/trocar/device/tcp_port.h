// SPDX-License-Identifier: Apache-2.0
/// \file tcp_port.h  Lines over TCP.
#pragma once

#include <memory>
#include <string>

#include "trocar/device/ports.h"

namespace trocar::device {

/// Connects within `timeout` [s].
/// \param host  name or address
/// \return kDeviceLost, with what the system says
/// \note Not real-time safe: waits.
core::Result<std::unique_ptr<Transport>> ConnectTcp(const std::string& host, int port, double timeout = 1.0);

/// Waits for callers.
class TcpListener {
 public:
  /// \param port          0 lets the system choose
  /// \param is_local_only true: only this machine can connect
  /// \return kDeviceBusy where the port is taken
  static core::Result<std::unique_ptr<TcpListener>> Make(int port, bool is_local_only = true);
  ~TcpListener();
  TcpListener(const TcpListener&) = delete;
  TcpListener& operator=(const TcpListener&) = delete;

  /// The next caller, or null where nobody calls just now.
  std::unique_ptr<Transport> Accept() noexcept;
  int Port() const noexcept { return port_; }

 private:
  TcpListener(int file, int port) : file_(file), port_(port) {}
  int file_, port_;
};

}  // namespace trocar::device
