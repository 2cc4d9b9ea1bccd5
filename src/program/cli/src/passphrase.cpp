// SPDX-License-Identifier: Apache-2.0
#include "passphrase.h"

#include "trocar/assessment/signing_key.h"
#include "trocar/host/secret_prompt.h"
#include "trocar/host/translate.h"

namespace trocar::cli {
base::Result<std::string> FindNewPassphrase(const std::filesystem::path& key) {
  if (auto given = assessment::PassphraseOfEnvironment(); !given.empty()) return given;
  const auto first =
      host::AskInSecret(host::TranslateWith("Passphrase for {1}, at least {2} characters (Enter for none)",
                                            {key.string(), std::to_string(assessment::kShortestPassphrase)}));
  if (!first || first->empty()) return std::string();
  const auto second = host::AskInSecret(host::Translate("The same again"));
  if (second == first) return *first;
  return base::Error{base::ErrorCode::kUsage, "the two passphrases differ; no key was made, begin again"};
}

base::Result<std::string> FindPassphrase(const std::filesystem::path& key) {
  const auto is_encrypted = assessment::IsKeyEncrypted(key);
  if (!is_encrypted.ok()) return is_encrypted.error();
  if (!*is_encrypted) return std::string();
  if (auto given = assessment::PassphraseOfEnvironment(); !given.empty()) return given;
  return host::AskInSecret(host::TranslateWith("Passphrase of {1}", {key.string()})).value_or("");
}

}  // namespace trocar::cli
