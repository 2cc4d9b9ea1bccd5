// SPDX-License-Identifier: Apache-2.0
// A check of options that take a pseudonym.
#pragma once

#include <string>

#include "trocar/host/translate.h"
#include "trocar/store/people.h"

namespace trocar::cli {

/// Complaint about a pseudonym; empty where it is valid.
inline std::string ComplainOfPseudonym(const std::string& text) {
  const base::Status sound = store::CheckPseudonym(text);
  return sound.ok() ? std::string() : host::TranslateComposed(sound.error().message);
}

}  // namespace trocar::cli
