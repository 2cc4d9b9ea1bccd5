// SPDX-License-Identifier: Apache-2.0
// A check of options that take a pseudonym.
#pragma once

#include <string>

#include "trocar/host/translate.h"
#include "trocar/store/people.h"

namespace trocar::cli {

/// What is wrong with a pseudonym; empty where nothing is.
inline std::string ComplainOfPseudonym(const std::string& text) {
  const base::Status sound = store::CheckPseudonym(text);
  return sound.ok() ? std::string() : host::TranslateComposed(sound.error().message);
}

}  // namespace trocar::cli
