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
base::Result<std::unique_ptr<Transport>> ConnectTcp(const std::string& host, int port, double timeout = 1.0);

/// How many bytes the other side has acknowledged or announces room for, from an arbitrary start. It stands still while the
/// program there reads nothing, whatever the systems between buffer; a buffer that the other system lets grow moves it a little.
/// \return 0 where the line is no TCP or the system does not tell (Linux before 5.4)
/// \note Real-time safe: a system call that does not wait.
std::uint64_t GetTcpReach(const Transport& line) noexcept;

/// Waits for callers.
class TcpListener {
 public:
  /// \param port          0 lets the system choose
  /// \param is_local_only true: only this machine can connect
  /// \param send_buffer   memory for a caller that does not read, about [bytes]; 0: as the system likes (megabytes)
  /// \return kDeviceBusy where the port is taken
  static base::Result<std::unique_ptr<TcpListener>> Make(int port, bool is_local_only = true,
                                                         int send_buffer = 0);
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
