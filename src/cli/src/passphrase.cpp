// SPDX-License-Identifier: Apache-2.0
#include "passphrase.h"

#include "trocar/assessment/signing_key.h"
#include "trocar/core/secret_prompt.h"
#include "trocar/core/translate.h"

namespace trocar::cli {
core::Result<std::string> FindNewPassphrase(const std::filesystem::path& key) {
  if (auto given = assessment::PassphraseOfEnvironment(); !given.empty()) return given;
  const auto first =
      core::AskInSecret(core::TranslateWith("Passphrase for {1}, at least {2} characters (Enter for none)",
                                            {key.string(), std::to_string(assessment::kShortestPassphrase)}));
  if (!first || first->empty()) return std::string();
  const auto second = core::AskInSecret(core::Translate("The same again"));
  if (second == first) return *first;
  return core::Error{core::ErrorCode::kUsage, "the two passphrases differ; no key was made, begin again"};
}

core::Result<std::string> FindPassphrase(const std::filesystem::path& key) {
  const auto is_encrypted = assessment::IsKeyEncrypted(key);
  if (!is_encrypted.ok()) return is_encrypted.error();
  if (!*is_encrypted) return std::string();
  if (auto given = assessment::PassphraseOfEnvironment(); !given.empty()) return given;
  return core::AskInSecret(core::TranslateWith("Passphrase of {1}", {key.string()})).value_or("");
}

}  // namespace trocar::cli
