// SPDX-License-Identifier: Apache-2.0
#include "pseudonym_option.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "trocar/host/translate.h"
#include "trocar/store/people.h"

namespace trocar::cli {
namespace {

/// Empty where it is valid.
std::string ComplainOfPseudonym(const std::string& text) {
  const base::Status sound = store::CheckPseudonym(text);
  return sound.ok() ? std::string() : host::TranslateComposed(sound.error().message);
}

}  // namespace

CLI::Option* AddPseudonymOption(CLI::App& command, const char* name, std::string& person, const char* about) {
  return command.add_option(name, person, about)->check(ComplainOfPseudonym)->type_name("PSEUDONYM");
}

}  // namespace trocar::cli
