// SPDX-License-Identifier: Apache-2.0
#include "signing.h"

#include <sodium.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <tuple>

#include "trocar/base/assert.h"

namespace trocar::assessment {
namespace {

static_assert(kPublicKeyBytes == crypto_sign_PUBLICKEYBYTES && kKeySeedBytes == crypto_sign_SEEDBYTES &&
              kSignatureBytes == crypto_sign_BYTES);
static_assert(std::tuple_size_v<decltype(EncryptedSeed::salt)> == crypto_pwhash_argon2id_SALTBYTES &&
              std::tuple_size_v<decltype(EncryptedSeed::nonce)> == crypto_secretbox_NONCEBYTES &&
              std::tuple_size_v<decltype(EncryptedSeed::box)> == kKeySeedBytes + crypto_secretbox_MACBYTES);
// they belong to the file's format: others would give another key
constexpr unsigned long long kPasses = 3;
constexpr std::size_t kMemory = std::size_t{256} << 20;  // [bytes]

using BoxKey = std::array<std::uint8_t, crypto_secretbox_KEYBYTES>;

/// Once; the library wants it before its first use.
void Begin() {
  static const bool is_ready = sodium_init() >= 0;
  TROCAR_ASSERT(is_ready);
  if (!is_ready) std::abort();
}

const unsigned char* Raw(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

base::Result<BoxKey> DeriveKey(std::string_view passphrase, const EncryptedSeed& encrypted) {
  BoxKey key{};
  if (crypto_pwhash_argon2id(key.data(), key.size(), passphrase.data(), passphrase.size(),
                             encrypted.salt.data(), kPasses, kMemory,
                             crypto_pwhash_argon2id_ALG_ARGON2ID13) == 0)
    return key;
  return base::Error{base::ErrorCode::kKeyLocked,
                     "a private key's passphrase needs 256 MiB of free memory; close other programs"};
}

}  // namespace

std::string HashBytes(std::span<const std::byte> bytes) {
  return HashText({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string HashText(std::string_view text) {
  Begin();
  std::array<std::uint8_t, kHashBytes> hash{};
  crypto_generichash(hash.data(), hash.size(), Raw(text), text.size(), nullptr, 0);
  return FormatHex(hash);
}

void DrawRandom(std::span<std::uint8_t> bytes) {
  Begin();
  randombytes_buf(bytes.data(), bytes.size());
}

void Wipe(std::span<std::uint8_t> bytes) noexcept {
  sodium_memzero(bytes.data(), bytes.size());
}

PublicKey MakePublicKey(const KeySeed& seed) {
  Begin();
  PublicKey key{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret{};
  crypto_sign_seed_keypair(key.data(), secret.data(), seed.data());
  Wipe(secret);
  return key;
}

Signature Sign(const KeySeed& seed, std::string_view text) {
  Begin();
  PublicKey key{};
  std::array<std::uint8_t, crypto_sign_SECRETKEYBYTES> secret{};
  crypto_sign_seed_keypair(key.data(), secret.data(), seed.data());
  Signature signature{};
  crypto_sign_detached(signature.data(), nullptr, Raw(text), text.size(), secret.data());
  Wipe(secret);
  return signature;
}

bool IsSignedBy(const PublicKey& key, const Signature& signature, std::string_view text) {
  Begin();
  return crypto_sign_verify_detached(signature.data(), Raw(text), text.size(), key.data()) == 0;
}

base::Result<EncryptedSeed> EncryptSeed(const KeySeed& seed, std::string_view passphrase) {
  Begin();
  EncryptedSeed encrypted;
  DrawRandom(encrypted.salt);
  DrawRandom(encrypted.nonce);
  auto key = DeriveKey(passphrase, encrypted);
  if (!key.ok()) return key.error();
  crypto_secretbox_easy(encrypted.box.data(), seed.data(), seed.size(), encrypted.nonce.data(), key->data());
  Wipe(*key);
  return encrypted;
}

base::Result<std::optional<KeySeed>> DecryptSeed(const EncryptedSeed& encrypted,
                                                 std::string_view passphrase) {
  Begin();
  auto key = DeriveKey(passphrase, encrypted);
  if (!key.ok()) return key.error();
  KeySeed seed{};
  const bool is_open = crypto_secretbox_open_easy(seed.data(), encrypted.box.data(), encrypted.box.size(),
                                                  encrypted.nonce.data(), key->data()) == 0;
  Wipe(*key);
  return is_open ? std::optional(seed) : std::nullopt;
}

std::string FormatHex(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

bool ParseHex(std::string_view text, std::span<std::uint8_t> bytes) noexcept {
  if (text.size() != 2 * bytes.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const int digit = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    if (digit < 0) return false;
    std::uint8_t& byte = bytes[i / 2];
    byte = static_cast<std::uint8_t>(i % 2 == 0 ? digit << 4 : byte | digit);
  }
  return true;
}

std::string FormatExact(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::optional<double> ParseExact(std::string_view text) {
  const std::string copy(text);
  const double value = std::strtod(copy.c_str(), nullptr);
  if (!std::isfinite(value) || FormatExact(value) != copy) return std::nullopt;
  return value;
}

}  // namespace trocar::assessment
