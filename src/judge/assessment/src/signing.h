// SPDX-License-Identifier: Apache-2.0
/// \file signing.h  Functions of libsodium that this module uses. No type of it leaves this file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::assessment {

inline constexpr std::size_t kHashBytes = 32, kPublicKeyBytes = 32, kKeySeedBytes = 32, kSignatureBytes = 64;

using PublicKey = std::array<std::uint8_t, kPublicKeyBytes>;
using KeySeed = std::array<std::uint8_t, kKeySeedBytes>;
using Signature = std::array<std::uint8_t, kSignatureBytes>;

/// BLAKE2b-256, 64 lower-case hexadecimal digits. Source: RFC 7693.
std::string HashBytes(std::span<const std::byte> bytes);
std::string HashText(std::string_view text);

/// From the system's generator.
void DrawRandom(std::span<std::uint8_t> bytes);
/// Overwrites what must not stay in memory.
void Wipe(std::span<std::uint8_t> bytes) noexcept;

/// Ed25519. Source: RFC 8032.
PublicKey MakePublicKey(const KeySeed& seed);
Signature Sign(const KeySeed& seed, std::string_view text);
bool IsSignedBy(const PublicKey& key, const Signature& signature, std::string_view text);

/// A seed as it may lie on a disk.
struct EncryptedSeed {
  std::array<std::uint8_t, 16> salt{};                 // of the passphrase
  std::array<std::uint8_t, 24> nonce{};                // of the cipher
  std::array<std::uint8_t, kKeySeedBytes + 16> box{};  // with its authenticator
};
/// Encrypts with XSalsa20-Poly1305, under a key that Argon2id derives from the passphrase with 256 MiB in three passes, so that each
/// guess costs somebody who has the file most of a second. Sources: RFC 9106; Bernstein, "Cryptography in NaCl", 2009.
/// \return kKeyLocked where there is no such memory
base::Result<EncryptedSeed> EncryptSeed(const KeySeed& seed, std::string_view passphrase);
/// \return nothing where the passphrase is another; kKeyLocked as above
base::Result<std::optional<KeySeed>> DecryptSeed(const EncryptedSeed& encrypted, std::string_view passphrase);

/// Lower-case hexadecimal digits.
std::string FormatHex(std::span<const std::uint8_t> bytes);
/// Exactly as FormatHex writes it: no other length, no capitals.
/// \return false where it is not; then `bytes` are undefined
bool ParseHex(std::string_view text, std::span<std::uint8_t> bytes) noexcept;

/// Digits from which the same double is read back.
std::string FormatExact(double value);
/// \return nothing unless FormatExact writes the same text for it
std::optional<double> ParseExact(std::string_view text);

}  // namespace trocar::assessment
