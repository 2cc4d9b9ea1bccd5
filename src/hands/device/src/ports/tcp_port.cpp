// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/tcp_port.h"

#include <fcntl.h>
#include <linux/tcp.h>  // the C library's own lacks the newer fields
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include "file_transport.h"

namespace trocar::device {
namespace {

using base::ErrorCode;

base::Error Unreachable(const std::string& host, int port, const std::string& why) {
  return {ErrorCode::kDeviceLost, host + ":" + std::to_string(port) + " does not answer: " + why +
                                      "; is its program running, and the address right?"};
}

/// Small messages must not wait for others.
void SendAtOnce(int file) noexcept {
  const int yes = 1;
  ::setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
}

/// Finishes a connect that does not block. \return 0 or the error number
int AwaitConnection(int file, double timeout) noexcept {
  pollfd wait{file, POLLOUT, 0};
  const int ready = ::poll(&wait, 1, static_cast<int>(1e3 * timeout));
  if (ready <= 0) return ready == 0 ? ETIMEDOUT : errno;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(file, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

}  // namespace

base::Result<std::unique_ptr<Transport>> ConnectTcp(const std::string& host, int port, double timeout) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int failure = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
      failure != 0)
    return Unreachable(host, port, ::gai_strerror(failure));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, ::freeaddrinfo);
  int why = ENOENT;
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    const int file = ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (file < 0) continue;
    auto transport = std::make_unique<FileTransport>(file);
    why = ::connect(file, address->ai_addr, address->ai_addrlen) == 0 ? 0 : errno;
    if (why == EINPROGRESS) why = AwaitConnection(file, timeout);
    if (why != 0) continue;
    SendAtOnce(file);
    return std::unique_ptr<Transport>(std::move(transport));
  }
  return Unreachable(host, port, std::strerror(why));
}

std::uint64_t GetTcpReach(const Transport& line) noexcept {
  tcp_info info{};
  socklen_t size = sizeof info;
  constexpr socklen_t kNeeded = offsetof(tcp_info, tcpi_snd_wnd) + sizeof info.tcpi_snd_wnd;
  if (::getsockopt(line.GetFile(), IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || size < kNeeded) return 0;
  return info.tcpi_bytes_acked + info.tcpi_snd_wnd;
}

base::Result<std::unique_ptr<TcpListener>> TcpListener::Make(int port, bool is_local_only, int send_buffer) {
  const int file = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  std::unique_ptr<TcpListener> listener(new TcpListener(file, port));
  const int yes = 1;
  ::setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  // those who call inherit it
  if (send_buffer > 0) ::setsockopt(file, SOL_SOCKET, SO_SNDBUF, &send_buffer, sizeof send_buffer);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(is_local_only ? INADDR_LOOPBACK : INADDR_ANY);
  if (file < 0 || ::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(file, 8) != 0) {
    return base::Error{ErrorCode::kDeviceBusy, "port " + std::to_string(port) + " cannot be listened on: " +
                                                   std::strerror(errno) + "; choose another"};
  }
  socklen_t size = sizeof address;
  ::getsockname(file, reinterpret_cast<sockaddr*>(&address), &size);
  listener->port_ = ntohs(address.sin_port);
  return listener;
}

TcpListener::~TcpListener() {
  if (file_ >= 0) ::close(file_);
}

std::unique_ptr<Transport> TcpListener::Accept() noexcept {
  const int file = ::accept4(file_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (file < 0) return nullptr;
  SendAtOnce(file);
  return std::make_unique<FileTransport>(file);
}

}  // namespace trocar::device
