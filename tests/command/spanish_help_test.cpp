// SPDX-License-Identifier: Apache-2.0
// The help of every command and complaints about the command line in Spanish, and unchanged in English.
#include <sstream>

#include "command_fixture.h"

namespace trocar {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::string> kSpanish = {"LANGUAGE=es", "LC_ALL=C.UTF-8"};
const std::vector<std::string> kNoLanguage = {"LANGUAGE=", "LC_ALL=C.UTF-8"};

/// What only English help has.
std::vector<std::string> EnglishWordsOf(const std::string& text) {
  std::vector<std::string> found;
  for (const char* word : {" the ",    " of ",    " with ",   " and ",        " which ",          " are ",
                           "The ",     "Of the ", "With ",    "Which ",       "Needs:",           "Excludes:",
                           "REQUIRED", "Usage:",  "Options:", "Positionals:", "Subcommands:",     "Example",
                           " FILE ",   " DIR ",   "INT in",   "FLOAT in",     "Machine-readable", "Print "}) {
    if (text.find(word) != std::string::npos) found.emplace_back(word);
  }
  return found;
}

/// The commands below one, as its help lists them.
std::vector<std::string> ListCommands(const std::string& help) {
  std::vector<std::string> names;
  std::istringstream lines(help);
  bool is_listing = false;
  for (std::string line; std::getline(lines, line);) {
    if (line == "Subcomandos:") {
      is_listing = true;
    } else if (is_listing && line.starts_with("  ") && line[2] != ' ') {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    } else if (is_listing && line.empty()) {
      break;
    }
  }
  return names;
}

class SpanishHelp : public Command {
 protected:
  /// Looks at a command's help and at that of all below it; returns how many.
  int Walk(std::vector<std::string> words) {
    SCOPED_TRACE(testing::PrintToString(words));
    std::vector<std::string> arguments = words;
    arguments.emplace_back("--help");
    const auto result = Run(arguments, kSpanish);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("Uso: trocar"));
    EXPECT_THAT(result.out, HasSubstr("\nOpciones:\n"));
    EXPECT_THAT(result.out, HasSubstr("Muestra esta ayuda y termina"));
    EXPECT_THAT(EnglishWordsOf(result.out), IsEmpty()) << result.out;

    int count = 1;
    for (const std::string& name : ListCommands(result.out)) {
      words.push_back(name);
      count += Walk(words);
      words.pop_back();
    }
    return count;
  }
};

TEST_F(SpanishHelp, HasNoEnglishWordInAnyCommand) {
  EXPECT_GT(Walk({}), 100);
}

// without its catalogue the program cannot know Spanish: the words that the test looks for are noticed
TEST_F(SpanishHelp, WithoutACatalogueIsNoticed) {
  const auto result =
      Run({"replay", "--help"}, {"LANGUAGE=es", "LC_ALL=C.UTF-8", "TROCAR_LOCALE_DIR=" + Path("")});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(EnglishWordsOf(result.out), Not(IsEmpty()));
}

TEST_F(SpanishHelp, LeavesEnglishAsItIs) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--help"}, {"window", "--help"}, {"store", "list", "--help"}}) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const std::string english = Run(arguments, kNoLanguage).out;
    EXPECT_EQ(english, Run(arguments, {"LANGUAGE=", "LC_ALL=C.UTF-8", "TROCAR_LOCALE_DIR=" + Path("")}).out);
    EXPECT_EQ(english, Run(arguments, {"LANGUAGE=en", "LC_ALL=C.UTF-8"}).out);
    EXPECT_THAT(english, HasSubstr("Usage: trocar"));
  }
  EXPECT_THAT(
      Run({"simulate", "--help"}, kNoLanguage).out,
      HasSubstr("  --ticks N:INT in [1 - 10000000] REQUIRED\n"
                "                              How many ticks, each scene.tick_seconds long (1/120 s)\n"));
}

TEST_F(SpanishHelp, NamesTypesAndRanges) {
  const std::string help = Run({"simulate", "--help"}, kSpanish).out;
  EXPECT_THAT(help, HasSubstr("scene ARCHIVO OBLIGATORIO"));
  EXPECT_THAT(help, HasSubstr("--ticks N:entero en [1 - 10000000] OBLIGATORIO"));
  // what is typed keeps its point
  EXPECT_THAT(Run({"demo", "--help"}, kSpanish).out, HasSubstr("S:decimal en [0.01 - 3600]"));
}

TEST_F(SpanishHelp, ComplaintsAreSpanish) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> wrong = {
      {{}, "falta un subcomando; véase trocar --help"},
      {{"nonsense"}, "no hay ningún subcomando «nonsense»; véase trocar --help"},
      {{"doctor", "--nonsense"}, "no se esperaba el argumento --nonsense; véase trocar doctor --help"},
      {{"doctor", "a", "b"}, "no se esperaban los argumentos b a; véase trocar doctor --help"},
      {{"simulate"}, "falta scene; véase trocar simulate --help"},
      {{"simulate", "s.json", "--ticks", "0"}, "--ticks: el valor 0 no está entre 1 y 10000000; véase"},
      {{"metrics", "--json", "--csv"}, "excluye --"},
      {{"window", "--beside", "b.trocar"}, "--beside necesita --replay"},
      {{"window", "--page", "home"}, "--page: home no está en {history,courses,group,exam}; véase"},
      {{"replay", "a.trocar", "--camera"}, "--camera: valores que faltan: 1 (LADO"},
  };
  for (const auto& [arguments, complaint] : wrong) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const auto result = Run(arguments, kSpanish);
    ExpectError(result, "E-CLI-001", 2);
    EXPECT_THAT(result.err, HasSubstr(complaint));
  }
}

// an error that only a command gives: its remedy, too
TEST_F(SpanishHelp, ErrorsOfCommandsAreSpanish) {
  const auto result = Run({"dataset"}, kSpanish);
  ExpectError(result, "E-CLI-001", 2);
  EXPECT_THAT(result.err, HasSubstr("indique --layout y -o CARPETA; véase trocar dataset --help"));
}

}  // namespace
}  // namespace trocar
