// SPDX-License-Identifier: Apache-2.0
/// \file import_socket.h  Whole messages with descriptors over a SOCK_SEQPACKET socket; used by both sides.
#pragma once

#include <cstddef>
#include <span>

namespace trocar::images {

/// Owns a descriptor.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(other.Release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor();
  int Get() const { return fd_; }
  int Release() {
    const int fd = fd_;
    fd_ = -1;
    return fd;
  }

 private:
  int fd_ = -1;
};

/// \return whether the whole message went out
bool SendMessage(int socket, const void* message, std::size_t bytes, std::span<const int> descriptors);

/// Waits for one message of exactly `bytes`.
/// \param[out] descriptors  those that came with it; every surplus one is closed
/// \return whether one came; false when the other side is gone or sent something else
bool ReceiveMessage(int socket, void* message, std::size_t bytes, std::span<Descriptor> descriptors);

}  // namespace trocar::images
