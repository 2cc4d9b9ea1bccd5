// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/local_port.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "file_transport.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

int MakeSocket(LocalLine line) noexcept {
  const int type = line == LocalLine::kPackets ? SOCK_SEQPACKET : SOCK_STREAM;
  return ::socket(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

/// \return false where the path is too long for a socket's
bool FillAddress(const std::string& path, sockaddr_un& address) noexcept {
  address = {};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return true;
}

base::Error Fail(ErrorCode code, const std::string& path, const char* what, const char* remedy) {
  return {code, path + " " + what + ": " + std::strerror(errno) + "; " + remedy};
}

}  // namespace

base::Result<std::unique_ptr<Transport>> ConnectLocal(const std::string& path, LocalLine line) {
  sockaddr_un address;
  errno = ENAMETOOLONG;
  const bool is_good = FillAddress(path, address);
  const int file = is_good ? MakeSocket(line) : -1;
  if (file >= 0) {
    auto transport = std::make_unique<FileTransport>(file);
    if (::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
      return std::unique_ptr<Transport>(std::move(transport));
  }
  return Fail(ErrorCode::kDeviceLost, path, "does not answer", "is its program running, and the path right?");
}

bool IsLocalSocket(const std::string& path) noexcept {
  struct stat found {};
  return ::stat(path.c_str(), &found) == 0 && S_ISSOCK(found.st_mode);
}

base::Result<std::unique_ptr<LocalListener>> LocalListener::Make(const std::string& path, LocalLine line) {
  constexpr const char* kRemedy = "choose another path";
  sockaddr_un address;
  errno = ENAMETOOLONG;
  if (!FillAddress(path, address)) return Fail(ErrorCode::kDeviceBusy, path, "can be no socket", kRemedy);
  const int file = MakeSocket(line);
  if (file < 0 || ::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const base::Error error = Fail(ErrorCode::kDeviceBusy, path, "cannot be listened on", kRemedy);
    if (file >= 0) ::close(file);
    return error;
  }
  std::unique_ptr<LocalListener> listener(new LocalListener(file, path));
  if (::listen(file, 8) != 0) return Fail(ErrorCode::kDeviceBusy, path, "cannot be listened on", kRemedy);
  return listener;
}

LocalListener::~LocalListener() {
  ::close(file_);
  ::unlink(path_.c_str());
}

std::unique_ptr<Transport> LocalListener::Accept() noexcept {
  const int file = ::accept4(file_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  return file < 0 ? nullptr : std::make_unique<FileTransport>(file);
}

}  // namespace trocar::device
