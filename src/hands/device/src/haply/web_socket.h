// SPDX-License-Identifier: Apache-2.0
/// \file web_socket.h  As much of WebSocket as a line on this machine needs: the opening, text frames, ping, close.
/// Source: RFC 6455.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "trocar/device/framer.h"

namespace trocar::device::web_socket {

enum class Opcode : std::uint8_t { kText = 1, kClose = 8, kPing = 9, kPong = 10 };

/// Larger messages are refused [bytes].
inline constexpr std::size_t kMaxPayload = 65536;

struct Frame {
  Opcode opcode = Opcode::kText;
  std::string payload;  ///< unmasked
};

/// One whole frame from the front of `bytes`; garbage where it is not one of the four kinds, in parts, too long, or masked
/// where it must not be, and the other way round.
///
/// \param is_masked  true for frames of a client, which are masked, false for those of a server, which are not
Parsed ParseFrame(std::string_view bytes, bool is_masked, Frame& frame);

/// \param mask  0: not masked, as servers send
std::string FormatFrame(Opcode opcode, std::string_view payload, std::uint32_t mask);

/// A server's answer to a client's key.
std::string CalcAccept(std::string_view key);
/// A client's request, with its key of 24 characters.
std::string FormatRequest(std::string_view host, std::string_view key);
/// A header's value, or nothing; names in any capitals.
std::string_view FindHeader(std::string_view head, std::string_view name);

}  // namespace trocar::device::web_socket
