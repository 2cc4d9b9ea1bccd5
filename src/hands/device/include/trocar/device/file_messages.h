// SPDX-License-Identifier: Apache-2.0
/// \file file_messages.h  Messages between our own processes that carry open files.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>
#include <string_view>

namespace trocar::device {

inline constexpr std::size_t kMostFilesOfMessage = 4;

/// Sends bytes and copies of files over a socket that keeps the bounds of messages.
///
/// \param files  at most kMostFilesOfMessage, which stay the caller's
/// \return false where not all of it went; errno says why
bool SendFiles(int socket, std::string_view bytes, std::span<const int> files) noexcept;

struct FileMessage {
  ssize_t size = -1;  ///< of its bytes; 0: the other end has closed; -1: nothing came, errno says why
  std::size_t file_count = 0;  ///< files[0] to files[file_count - 1] are the caller's from now on
  int files[kMostFilesOfMessage] = {-1, -1, -1, -1};
};

/// Receives a message.
///
/// \param[out] bytes  what does not fit is lost
/// \param flags       of recvmsg
/// \note Real-time safe with MSG_DONTWAIT.
FileMessage ReceiveFiles(int socket, std::span<char> bytes, int flags) noexcept;

/// Closes them.
void CloseFiles(std::span<const int> files) noexcept;

}  // namespace trocar::device
