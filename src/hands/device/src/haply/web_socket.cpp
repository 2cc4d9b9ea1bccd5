// SPDX-License-Identifier: Apache-2.0
#include "web_socket.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <vector>

namespace trocar::device::web_socket {
namespace {

using Verdict = Parsed::Verdict;
constexpr Parsed kIncomplete{Verdict::kIncomplete, 0};
constexpr Parsed kGarbage{Verdict::kGarbage, 0};

constexpr std::uint8_t kFinal = 0x80, kMaskBit = 0x80;
constexpr std::size_t kShort = 125, kTwoBytes = 126;

std::uint8_t ByteAt(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

/// Source: FIPS 180-4, SHA-1; here a mark of the protocol, not for security.
std::array<std::uint8_t, 20> CalcSha1(std::string_view text) {
  std::vector<std::uint8_t> bytes(text.begin(), text.end());
  const std::uint64_t bits = 8 * text.size();
  bytes.push_back(0x80);
  while (bytes.size() % 64 != 56) bytes.push_back(0);
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> shift));

  std::array<std::uint32_t, 5> h = {0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476, 0xC3D2E1F0};
  for (std::size_t block = 0; block < bytes.size(); block += 64) {
    std::array<std::uint32_t, 80> w{};
    for (std::size_t i = 0; i < 64; ++i) w[i / 4] = w[i / 4] << 8 | bytes[block + i];
    for (std::size_t i = 16; i < 80; ++i) w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
    auto [a, b, c, d, e] = h;
    for (std::size_t i = 0; i < 80; ++i) {
      const std::uint32_t f = i < 20   ? ((b & c) | (~b & d)) + 0x5A827999
                              : i < 40 ? (b ^ c ^ d) + 0x6ED9EBA1
                              : i < 60 ? ((b & c) | (b & d) | (c & d)) + 0x8F1BBCDC
                                       : (b ^ c ^ d) + 0xCA62C1D6;
      const std::uint32_t next = std::rotl(a, 5) + f + e + w[i];
      e = d, d = c, c = std::rotl(b, 30), b = a, a = next;
    }
    h = {h[0] + a, h[1] + b, h[2] + c, h[3] + d, h[4] + e};
  }
  std::array<std::uint8_t, 20> digest{};
  for (std::size_t i = 0; i < 20; ++i) digest[i] = static_cast<std::uint8_t>(h[i / 4] >> (24 - 8 * (i % 4)));
  return digest;
}

std::string ToBase64(const std::array<std::uint8_t, 20>& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (i + j < bytes.size() ? bytes[i + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j)
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63];
  }
  return text;
}

}  // namespace

Parsed ParseFrame(std::string_view bytes, bool is_masked, Frame& frame) {
  if (bytes.empty()) return kIncomplete;
  const std::uint8_t first = ByteAt(bytes, 0);
  frame.opcode = static_cast<Opcode>(first & 0x0f);
  const bool is_known = frame.opcode == Opcode::kText || frame.opcode == Opcode::kClose ||
                        frame.opcode == Opcode::kPing || frame.opcode == Opcode::kPong;
  if ((first & 0xf0) != kFinal || !is_known) return kGarbage;
  if (bytes.size() < 2) return kIncomplete;
  if (((ByteAt(bytes, 1) & kMaskBit) != 0) != is_masked) return kGarbage;
  std::size_t size = ByteAt(bytes, 1) & 0x7f;
  std::size_t at = 2;
  // 64-bit lengths are beyond what is taken; control frames are short
  if (size > kTwoBytes || (size > kShort && frame.opcode != Opcode::kText)) return kGarbage;
  if (size == kTwoBytes) {
    if (bytes.size() < 4) return kIncomplete;
    size = static_cast<std::size_t>(ByteAt(bytes, 2)) << 8 | ByteAt(bytes, 3);
    at = 4;
  }
  const std::size_t mask_at = at;
  if (is_masked) at += 4;
  if (bytes.size() < at + size) return kIncomplete;
  frame.payload = bytes.substr(at, size);
  for (std::size_t i = 0; is_masked && i < size; ++i)
    frame.payload[i] = static_cast<char>(ByteAt(frame.payload, i) ^ ByteAt(bytes, mask_at + i % 4));
  return {Verdict::kRecord, at + size};
}

std::string FormatFrame(Opcode opcode, std::string_view payload, std::uint32_t mask) {
  payload = payload.substr(0, kMaxPayload - 1);
  const int mask_bit = mask != 0 ? kMaskBit : 0;
  std::string bytes = {static_cast<char>(kFinal | static_cast<std::uint8_t>(opcode))};
  if (payload.size() <= kShort) {
    bytes += static_cast<char>(mask_bit | static_cast<int>(payload.size()));
  } else {
    bytes += static_cast<char>(mask_bit | static_cast<int>(kTwoBytes));
    bytes += static_cast<char>(payload.size() >> 8);
    bytes += static_cast<char>(payload.size() & 0xff);
  }
  if (mask == 0) return bytes.append(payload);
  std::array<char, 4> key{};
  for (std::size_t i = 0; i < 4; ++i) key[i] = static_cast<char>(mask >> (24 - 8 * i));
  bytes.append(key.data(), key.size());
  for (std::size_t i = 0; i < payload.size(); ++i) bytes += static_cast<char>(payload[i] ^ key[i % 4]);
  return bytes;
}

std::string CalcAccept(std::string_view key) {
  return ToBase64(CalcSha1(std::string(key) + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
}

std::string FormatRequest(std::string_view host, std::string_view key) {
  return "GET / HTTP/1.1\r\nHost: " + std::string(host) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: " +
         std::string(key) + "\r\n\r\n";
}

std::string_view FindHeader(std::string_view head, std::string_view name) {
  const auto is_same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  while (!head.empty()) {
    const std::size_t end = std::min(head.find("\r\n"), head.size());
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(std::min(end + 2, head.size()));
    if (line.size() <= name.size() || line[name.size()] != ':' ||
        !std::equal(name.begin(), name.end(), line.begin(), is_same))
      continue;
    std::string_view value = line.substr(name.size() + 1);
    while (value.starts_with(' ')) value.remove_prefix(1);
    while (value.ends_with(' ')) value.remove_suffix(1);
    return value;
  }
  return {};
}

}  // namespace trocar::device::web_socket
