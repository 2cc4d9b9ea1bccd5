// SPDX-License-Identifier: Apache-2.0
// What commands print, in Spanish: no line of it has an English word. JSON stays as it is.
#include <functional>
#include <regex>
#include <sstream>

#include "command_fixture.h"
#include "trocar_test/made_images.h"

namespace trocar {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::string> kSpanish = {"LANGUAGE=es", "LC_ALL=C.UTF-8"};
const std::vector<std::string> kEnglish = {"LANGUAGE=", "LC_ALL=C.UTF-8"};

/// Lines with a word that Spanish does not have.
std::vector<std::string> EnglishLinesOf(const std::string& text) {
  static const std::regex word(
      "\\b(the|of|and|with|is|are|was|not|from|which|that|this|what|each|nothing|no one|yes|holds|wrote|"
      "found|hand|hands|left|right|completed|missing|seconds|where|needs?|because)\\b",
      std::regex::icase);
  std::vector<std::string> found;
  std::istringstream lines(text);
  static const std::regex key("[a-z0-9]+(-[a-z0-9]+)+");  // typed again: "lift-and-fetch"
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(std::regex_replace(line, key, ""), word)) found.push_back(line);
  }
  return found;
}

class SpanishConsole : public Command {
 protected:
  test::ProcessResult RunSpanish(const std::vector<std::string>& arguments) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    auto result = Run(arguments, kSpanish);
    EXPECT_THAT(result.out, Not(IsEmpty())) << result.err;
    EXPECT_THAT(EnglishLinesOf(result.out), IsEmpty());
    EXPECT_THAT(EnglishLinesOf(result.err), IsEmpty());
    return result;
  }
};

TEST_F(SpanishConsole, DoctorSaysWhatIsThereInSpanish) {
  const std::string found = RunSpanish({"doctor"}).out;
  EXPECT_THAT(found, HasSubstr("no hace falta"));
  EXPECT_THAT(found, HasSubstr("el paciente incluido está completo"));
}

TEST_F(SpanishConsole, ListsAreSpanish) {
  EXPECT_THAT(RunSpanish({"play", "--list"}).out, HasSubstr("corta la arteria cística y se queda mirando"));
  EXPECT_THAT(RunSpanish({"metrics", "--list"}).out, HasSubstr("unidad"));
  EXPECT_THAT(RunSpanish({"errors"}).out, HasSubstr("significado"));
  EXPECT_THAT(RunSpanish({"course", "list"}).out, HasSubstr("curso"));
  EXPECT_THAT(RunSpanish({"course", "show", "basic-skills"}).out, HasSubstr("como mucho"));
  EXPECT_THAT(RunSpanish({"devices", "list"}).out, HasSubstr("sensor de pinza"));
  EXPECT_THAT(RunSpanish({"pictures", "--list"}).out, HasSubstr("clips en el conducto y la arteria"));
  EXPECT_THAT(RunSpanish({"bench", "--list"}).out, HasSubstr("fuerza bruta"));
  // the form's own name is English
  EXPECT_THAT(Run({"rating", "form", "goals"}, kSpanish).out, HasSubstr("Fuente: "));
}

TEST_F(SpanishConsole, ARecordingsWayIsSpanish) {
  const std::string recording = Path("attempt.trocar");
  const auto simulated = RunSpanish({"simulate", Source("scenes/demonstration.json"), "--ticks", "24",
                                     "--threads", "2", "--record", recording});
  EXPECT_THAT(simulated.out, HasSubstr("24 ciclos, huella del estado "));
  // the decimal mark of a time in milliseconds
  EXPECT_TRUE(std::regex_search(simulated.out, std::regex("ciclo completo +[0-9]+(,[0-9]+)?\n")))
      << simulated.out;
  const auto info = RunSpanish({"record", "info", recording});
  EXPECT_THAT(info.out, HasSubstr("0,2 s, 24 ciclos"));
  EXPECT_THAT(info.out, HasSubstr("terminada"));
  EXPECT_THAT(RunSpanish({"record", "verify", recording}).out, HasSubstr("terminada"));
  EXPECT_THAT(Run({"replay", recording, "--verify"}, kSpanish).out, HasSubstr("VERIFICADO: 24 ciclos"));
}

TEST_F(SpanishConsole, PatientsAndTheStoreAreSpanish) {
  const std::string patient = Source("assets/patients/visible-human-male/patient");
  EXPECT_THAT(RunSpanish({"anatomy", "check", patient}).out, HasSubstr("Sin hallazgos."));
  EXPECT_THAT(RunSpanish({"anatomy", "measure", patient}).out, HasSubstr("del infundíbulo al fondo"));
  const std::vector<std::string> store = {"--store", Path("store.sqlite")};
  const auto with_store = [&](std::vector<std::string> words) {
    words.insert(words.end(), store.begin(), store.end());
    return RunSpanish(words).out;
  };
  EXPECT_THAT(with_store({"store", "migrate"}), HasSubstr("las tablas son de la versión"));
  EXPECT_THAT(with_store({"store", "info"}), HasSubstr("para siempre"));
  EXPECT_THAT(with_store({"store", "attempts"}), HasSubstr("ningún intento"));
}

TEST_F(SpanishConsole, VolumesOfAFolderAreListedInSpanish) {
  const auto write = [&](int series, const std::function<void(test::DicomFields&)>& change) {
    for (int slice = 1; slice <= 4; ++slice) {
      test::DicomFields fields;
      fields.instance = slice + 10 * series;
      fields.position = "0\\0\\" + std::to_string(5 * slice);
      change(fields);
      Write("ct/IM" + std::to_string(fields.instance), test::MakeDicom(fields));
    }
  };
  for (const int acquisition : {1, 2})
    write(acquisition, [&](test::DicomFields& f) { f.acquisition = std::to_string(acquisition); });
  // another series, of two echoes and a localizer
  for (const char* echo : {"2.5", "7.5"}) {
    write(echo[0] - '0' + 10, [&](test::DicomFields& f) {
      f.series = "1.2.3.9", f.modality = "MR", f.sop_class = "1.2.840.10008.5.1.4.1.1.4";
      f.scanning = test::Element(0x18, 0x81, "DS", echo);
    });
  }
  test::DicomFields localizer;
  localizer.instance = 99, localizer.image_type = "ORIGINAL\\PRIMARY\\LOCALIZER";
  Write("ct/IM99", test::MakeDicom(localizer));
  const auto asked = Run({"anatomy", "images", Path("ct")}, kSpanish);
  EXPECT_THAT(EnglishLinesOf(asked.err), IsEmpty());
  for (const char* said : {"(CT, adquisición 1, cortes: 4); ", "(CT, adquisición 2, cortes: 4)",
                           "tiempo de eco 2,5 ms", "(CT, localizador, cortes: 1)"})
    EXPECT_THAT(asked.err, HasSubstr(said));
  for (const char* word : {"slices", "acquisition", "echo", "localizer"})
    EXPECT_THAT(asked.err, Not(HasSubstr(word)));
}

TEST_F(SpanishConsole, EnglishIsAsItWasAndNoticed) {
  const auto english = Run({"doctor"}, kEnglish);
  EXPECT_THAT(english.out, HasSubstr("the built-in patient is whole"));
  EXPECT_THAT(EnglishLinesOf(english.out), Not(IsEmpty()));
  // for programs: the same in both languages
  EXPECT_EQ(Run({"metrics", "--list", "--json"}, kSpanish).out,
            Run({"metrics", "--list", "--json"}, kEnglish).out);
  const std::string json = Run({"doctor", "--json"}, kSpanish).out;
  EXPECT_THAT(json, HasSubstr("\"state\": \"good\""));
  EXPECT_THAT(json, HasSubstr("the built-in patient is whole"));
}

}  // namespace
}  // namespace trocar
