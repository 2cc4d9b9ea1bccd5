// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/file_messages.h"

#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include "trocar/base/assert.h"

namespace trocar::device {

bool SendFiles(int socket, std::string_view bytes, std::span<const int> files) noexcept {
  TROCAR_ASSERT(files.size() <= kMostFilesOfMessage);
  iovec part{const_cast<char*>(bytes.data()), bytes.size()};
  alignas(cmsghdr) char control[CMSG_SPACE(kMostFilesOfMessage * sizeof(int))] = {};
  msghdr header{};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  if (!files.empty()) {
    header.msg_control = control;
    header.msg_controllen = CMSG_SPACE(files.size_bytes());
    cmsghdr* carried = CMSG_FIRSTHDR(&header);
    carried->cmsg_level = SOL_SOCKET;
    carried->cmsg_type = SCM_RIGHTS;
    carried->cmsg_len = CMSG_LEN(files.size_bytes());
    std::memcpy(CMSG_DATA(carried), files.data(), files.size_bytes());
  }
  return ::sendmsg(socket, &header, MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

FileMessage ReceiveFiles(int socket, std::span<char> bytes, int flags) noexcept {
  FileMessage message;
  iovec part{bytes.data(), bytes.size()};
  alignas(cmsghdr) char control[CMSG_SPACE(kMostFilesOfMessage * sizeof(int))];
  msghdr header{};
  header.msg_iov = &part;
  header.msg_iovlen = 1;
  header.msg_control = control;
  header.msg_controllen = sizeof control;
  message.size = ::recvmsg(socket, &header, flags | MSG_CMSG_CLOEXEC);
  if (message.size <= 0) return message;
  const cmsghdr* carried = CMSG_FIRSTHDR(&header);
  if (carried == nullptr || carried->cmsg_level != SOL_SOCKET || carried->cmsg_type != SCM_RIGHTS)
    return message;
  message.file_count = (carried->cmsg_len - CMSG_LEN(0)) / sizeof(int);
  std::memcpy(message.files, CMSG_DATA(carried), message.file_count * sizeof(int));
  return message;
}

void CloseFiles(std::span<const int> files) noexcept {
  for (const int file : files) ::close(file);
}

}  // namespace trocar::device
