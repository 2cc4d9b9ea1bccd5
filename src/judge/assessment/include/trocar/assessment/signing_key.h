// SPDX-License-Identifier: Apache-2.0
/// \file signing_key.h  A centre's pair of keys: NAME.key signs certificates and stays secret, NAME.pub is published.
/// docs/exams.md describes the files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "trocar/base/result.h"

namespace trocar::assessment {

inline constexpr std::size_t kShortestPassphrase = 8;  ///< [bytes]

/// A private key's file with what opens it.
struct SigningKey {
  std::filesystem::path file;
  std::string passphrase;  ///< not read where the file is not encrypted
};

/// Makes NAME.key, which only its owner may read, and NAME.pub.
/// \param passphrase  with which NAME.key is encrypted; empty: it is not
/// \return kUsage for a passphrase that is too short; kFileUnwritable, also where one of the files is there already
base::Status MakeKeys(const std::filesystem::path& name, std::string_view passphrase = {});

/// \return kKeyInvalid; the file's error, kKeyUnsafe among them
base::Result<bool> IsKeyEncrypted(const std::filesystem::path& private_key);

/// \return 64 hexadecimal digits; the file's error, or kKeyInvalid
base::Result<std::string> ReadPublicKey(const std::filesystem::path& path);

/// TROCAR_KEY_PASSPHRASE of the environment; empty where it is not set.
std::string PassphraseOfEnvironment();

}  // namespace trocar::assessment
