// SPDX-License-Identifier: Apache-2.0
#include "file_transport.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

namespace trocar::device {
namespace {

bool IsPassingErrno(int error) noexcept {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

FileTransport::~FileTransport() {
  ::close(file_);
}

IoResult FileTransport::Read(std::span<char> buffer) noexcept {
  const ssize_t got = ::read(file_, buffer.data(), buffer.size());
  if (got > 0) return {static_cast<std::size_t>(got), false};
  // a hung-up terminal says 0 or EIO, a pulled USB plug ENODEV or ENXIO: all the same to us
  return {0, got == 0 || !IsPassingErrno(errno)};
}

IoResult FileTransport::Write(std::string_view bytes) noexcept {
  // a socket whose far end is closed must not raise SIGPIPE; a terminal never does
  ssize_t sent = ::send(file_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && errno == ENOTSOCK) sent = ::write(file_, bytes.data(), bytes.size());
  if (sent >= 0) return {static_cast<std::size_t>(sent), false};
  return {0, !IsPassingErrno(errno)};
}

}  // namespace trocar::device
