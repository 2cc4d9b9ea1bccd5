// SPDX-License-Identifier: Apache-2.0
#include "trocar/assessment/signing_key.h"

#include <cstdlib>
#include <optional>
#include <span>
#include <system_error>
#include <variant>

#include "owner_file.h"
#include "private_key.h"
#include "trocar/host/safe_file.h"

namespace trocar::assessment {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr std::string_view kPlainHead = "trocar-private-key-1 ", kEncryptedHead = "trocar-private-key-2 ",
                           kPublicHead = "trocar-public-key-1 ";
constexpr std::size_t kLargestPublicKey = 4096;  // of the file [bytes]
constexpr std::size_t kCheckDigits = 16;  // of the hash of a line: tells damage from a wrong passphrase

/// What stands in a private key's file.
using StoredSeed = std::variant<KeySeed, EncryptedSeed>;

/// Text that is overwritten when it is no longer needed.
class SecretText {
 public:
  explicit SecretText(std::string text) : text_(std::move(text)) {}
  ~SecretText() { Wipe({reinterpret_cast<std::uint8_t*>(text_.data()), text_.size()}); }
  SecretText(const SecretText&) = delete;
  SecretText& operator=(const SecretText&) = delete;
  std::string_view View() const { return text_; }

 private:
  std::string text_;
};

std::string FormatEncrypted(const EncryptedSeed& seed) {
  const std::string line = std::string(kEncryptedHead) + FormatHex(seed.salt) + " " + FormatHex(seed.nonce) +
                           " " + FormatHex(seed.box) + " ";
  return line + HashText(line).substr(0, kCheckDigits) + "\n";
}

/// Takes so many hexadecimal digits and the character behind them off the text.
bool TakeHex(std::string_view& text, std::span<std::uint8_t> bytes, char behind) {
  const std::size_t digits = 2 * bytes.size();
  if (text.size() <= digits || text[digits] != behind || !ParseHex(text.substr(0, digits), bytes))
    return false;
  text.remove_prefix(digits + 1);
  return true;
}

std::optional<StoredSeed> ParsePrivateKey(std::string_view text) {
  std::string_view rest = text;
  if (text.starts_with(kPlainHead)) {
    rest.remove_prefix(kPlainHead.size());
    KeySeed seed{};
    const bool is_key = TakeHex(rest, seed, '\n') && rest.empty();
    return is_key ? std::optional<StoredSeed>(seed) : std::nullopt;
  }
  if (!text.starts_with(kEncryptedHead)) return std::nullopt;
  rest.remove_prefix(kEncryptedHead.size());
  EncryptedSeed seed;
  const bool is_key = TakeHex(rest, seed.salt, ' ') && TakeHex(rest, seed.nonce, ' ') &&
                      TakeHex(rest, seed.box, ' ') && FormatEncrypted(seed) == text;
  return is_key ? std::optional<StoredSeed>(seed) : std::nullopt;
}

base::Result<StoredSeed> ReadStored(const fs::path& path) {
  auto text = ReadOwnerFile(path);
  if (!text.ok()) return text.error();
  const SecretText secret(std::move(*text));
  if (const auto stored = ParsePrivateKey(secret.View())) return *stored;
  return Error{ErrorCode::kKeyInvalid,
               path.string() +
                   " holds no private key, or was damaged; take the copy of it, or make another with "
                   "trocar certificate keygen"};
}

}  // namespace

base::Status MakeKeys(const fs::path& name, std::string_view passphrase) {
  const fs::path private_path = name.string() + ".key", public_path = name.string() + ".pub";
  if (!passphrase.empty() && passphrase.size() < kShortestPassphrase) {
    return Error{ErrorCode::kUsage, "a passphrase has at least " + std::to_string(kShortestPassphrase) +
                                        " characters; several words are easy to keep"};
  }
  std::error_code ignored;
  if (fs::exists(public_path, ignored)) {
    return Error{ErrorCode::kFileUnwritable,
                 public_path.string() + " is there already, and keys are not replaced; choose another name"};
  }
  KeySeed seed{};
  DrawRandom(seed);
  const std::string public_text = std::string(kPublicHead) + FormatHex(MakePublicKey(seed)) + "\n";
  base::Status written;
  if (passphrase.empty()) {
    written =
        WriteOwnerFile(private_path, SecretText(std::string(kPlainHead) + FormatHex(seed) + "\n").View());
  } else if (const auto encrypted = EncryptSeed(seed, passphrase); encrypted.ok()) {
    written = WriteOwnerFile(private_path, FormatEncrypted(*encrypted));
  } else {
    written = encrypted.error();
  }
  Wipe(seed);
  if (!written.ok()) return written;
  if (const auto published = host::WriteFile(public_path, public_text); !published.ok()) {
    // half a pair is of no use, and would be in the way of the next try
    fs::remove(private_path, ignored);
    return published;
  }
  return {};
}

base::Result<bool> IsKeyEncrypted(const fs::path& private_key) {
  auto stored = ReadStored(private_key);
  if (!stored.ok()) return stored.error();
  if (auto* plain = std::get_if<KeySeed>(&*stored)) Wipe(*plain);
  return std::holds_alternative<EncryptedSeed>(*stored);
}

base::Result<KeySeed> ReadPrivateKey(const SigningKey& key) {
  const auto stored = ReadStored(key.file);
  if (!stored.ok()) return stored.error();
  if (const auto* plain = std::get_if<KeySeed>(&*stored)) return *plain;
  const auto locked = [&key](const std::string& why) {
    return Error{ErrorCode::kKeyLocked, key.file.string() + why};
  };
  if (key.passphrase.empty()) {
    return locked(
        " is encrypted; give its passphrase: in the window beside Issue, at a terminal, or in "
        "TROCAR_KEY_PASSPHRASE");
  }
  const auto seed = DecryptSeed(std::get<EncryptedSeed>(*stored), key.passphrase);
  if (!seed.ok()) return seed.error();
  if (!*seed) return locked(": that is not its passphrase; try again, nothing was signed");
  return **seed;
}

base::Result<std::string> ReadPublicKey(const fs::path& path) {
  const auto text = host::ReadFile(path, kLargestPublicKey);
  if (!text.ok()) return text.error();
  std::string_view rest = *text;
  PublicKey key{};
  if (rest.starts_with(kPublicHead)) {
    rest.remove_prefix(kPublicHead.size());
    if (TakeHex(rest, key, '\n') && rest.empty()) return FormatHex(key);
  }
  return Error{ErrorCode::kKeyInvalid,
               path.string() + " holds no public key; take the file NAME.pub of trocar certificate keygen"};
}

std::string PassphraseOfEnvironment() {
  const char* text = std::getenv("TROCAR_KEY_PASSPHRASE");
  return text != nullptr ? text : "";
}

}  // namespace trocar::assessment
