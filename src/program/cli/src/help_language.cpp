// SPDX-License-Identifier: Apache-2.0
#include "help_language.h"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>

#include "trocar/host/translate.h"

namespace trocar::cli {
namespace {

using host::Mark;

// CLI11's words of its help; its complaints stand in tests/texts/list_texts.cpp
constexpr std::array kWords = {Mark("Usage"),       Mark("OPTIONS"),  Mark("Positionals"), Mark("SUBCOMMAND"),
                               Mark("SUBCOMMANDS"), Mark("REQUIRED"), Mark("Needs"),       Mark("Excludes")};

/// What limits the option's values, or null. CLI11 throws where there is none.
CLI::Validator* FindCheck(CLI::Option& option) {
  try {
    return option.get_validator();
  } catch (const CLI::OptionNotFound&) {
    return nullptr;
  }
}

/// The placeholder ("T" of "T:INT in [1 - 256]") and the range behind it; the values of a list are what is typed, and stay.
void VisitType(CLI::Option& option, const TextVisitor& visit) {
  std::string type = option.get_type_name();
  CLI::Validator* check = FindCheck(option);
  if (check != nullptr && !check->get_description().empty()) {
    const std::string range = check->get_description();
    type.resize(type.size() - range.size() - 1);
    // "INT in [1 - 256]": the numbers are typed with a point in every language
    if (const std::size_t numbers = range.find(" ["); numbers != std::string::npos)
      check->description(visit(range.substr(0, numbers)) + range.substr(numbers));
  }
  option.type_name(visit(type));
}

}  // namespace

void VisitHelpTexts(CLI::App& app, const TextVisitor& visit) {
  app.description(visit(app.get_description()));
  app.footer(visit(app.get_footer()));
  if (app.get_parent() != nullptr) app.group(visit(app.get_group()));
  for (CLI::Option* option : app.get_options({})) {
    option->description(visit(option->get_description()));
    option->group(visit(option->get_group()));
    if (option->get_type_size() != 0) VisitType(*option, visit);
  }
  for (CLI::App* command : app.get_subcommands({})) VisitHelpTexts(*command, visit);
}

void TranslateHelp(CLI::App& app) {
  if (host::Translate("en") == "en") return;
  for (const char* word : kWords) app.get_formatter()->label(word, host::Translate(word));
  VisitHelpTexts(app, host::Translate);
}

}  // namespace trocar::cli
