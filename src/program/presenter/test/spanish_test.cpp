// SPDX-License-Identifier: Apache-2.0
// What a trainee reads in Spanish: tasks with their briefings, tutorial, hints, results, events, numbers.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "trocar/host/translate.h"
#include "trocar/presenter/hints.h"
#include "trocar/presenter/home.h"
#include "trocar/presenter/patient_list.h"
#include "trocar/presenter/read_outs.h"
#include "trocar/presenter/task_page.h"
#include "trocar/presenter/task_result.h"
#include "trocar/presenter/tutorial.h"

namespace trocar::presenter {
namespace {

class Spanish : public testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder = host::FindLocaleFolder();
    if (folder.empty()) GTEST_SKIP() << "this build has no catalogue: no msgfmt";
    ::setenv("LANGUAGE", "es", 1);
    host::UseLanguage(folder);
  }
};

/// Words of English that are none of Spanish.
bool IsEnglish(const std::string& text) {
  for (const char* word : {" the ", " of ", " and ", " is ", " with ", "The ", "Hold ", " to "}) {
    if (text.find(word) != std::string::npos) return true;
  }
  return false;
}

/// Without the code before it.
std::string Message(const base::Error& error) {
  const std::string text = host::ShownText(error);
  return text.substr(text.find(' ') + 1);
}

TEST_F(Spanish, TasksAndPartsHaveSpanishNamesAndBriefings) {
  const auto page = LoadTaskPage(TaskSection::kAll, "/patients/seed-7");
  ASSERT_TRUE(page.ok());
  std::size_t rows = 0;
  for (const TaskPage::Group& group : page->groups) {
    EXPECT_FALSE(IsEnglish(group.title)) << group.title;
    for (const TaskPage::Row& row : group.rows) {
      ++rows;
      EXPECT_FALSE(IsEnglish(row.name) || IsEnglish(row.about)) << row.name << ": " << row.about;
      for (const TaskPage::Level& level : row.levels) EXPECT_FALSE(IsEnglish(level.about)) << level.about;
    }
  }
  EXPECT_GT(rows, 12u);
  EXPECT_EQ(page->groups[1].title, "Colecistectomía laparoscópica: paciente generado 7");
}

TEST_F(Spanish, TutorialAndHintsNameTheKeys) {
  const KeyBindings bindings;
  Tutorial tutorial;
  for (int step = 0; step <= kTutorialSteps; ++step) {
    tutorial.Begin(step);
    const std::string text = tutorial.Text(bindings);
    EXPECT_FALSE(IsEnglish(text)) << text;
    EXPECT_EQ(text.find('{'), std::string::npos) << text;
  }
  const Situation taken{.is_loaded = true, .is_paused = false, .is_pointer_taken = true};
  EXPECT_NE(ModeText(taken).find("botón izquierdo cierra"), std::string::npos) << ModeText(taken);
  EXPECT_FALSE(IsEnglish(ModeText(taken)));
  WindowSettings settings;
  settings.last_task = "peg_transfer", settings.last_level = "hard";
  EXPECT_EQ(MakeHomePage(settings, "", {}).last, "transferencia de anillos, difícil");
  EXPECT_EQ(ShortPatientName({}), "el paciente incluido");
}

TEST_F(Spanish, ResultsHaveADecimalComma) {
  TaskResult result;
  result.task = "Peg transfer", result.level = "normal";
  result.verdict = "Completado";
  result.time = 83.26, result.score = 41.24, result.best_score = 85, result.is_score_percent = true;
  result.goals = {{"Ring 3 to the right", true}};
  result.errors = {
      {12.5, "dropped", "A ring fell in the field; pick it up again", "major", "ring_3, left hand", 10, {}}};
  EXPECT_EQ(FormatScore(result), "41,2 de 85");
  EXPECT_EQ(FormatTime(83.26), "1:23,3");
  EXPECT_EQ(FormatForce(4.25), "4,2 N");
  const std::string html = FormatTaskResultHtml(result);
  for (const char* text : {"<html lang=\"es\">", "Transferencia de anillos", "Anillo 3 a la derecha", "grave",
                           "anillo 3, mano izquierda", "Un anillo cayó dentro del campo"})
    EXPECT_NE(html.find(text), std::string::npos) << text;
  EXPECT_FALSE(IsEnglish(html.substr(html.find("<body>"))));
  EXPECT_NE(FormatTaskResultJson(result).find("\"task\": \"Peg transfer\""), std::string::npos)
      << "what programs read stays as it is";
}

TEST_F(Spanish, ErrorsSayWhatMendsThem) {
  const base::Error error{base::ErrorCode::kFileUnreadable, "/a/b.json cannot be opened; check the path"};
  EXPECT_EQ(Message(error), "/a/b.json no se puede abrir; compruebe la ruta");
  const base::Error nested{base::ErrorCode::kJsonField,
                           "/a.json: at levels[0]: is 9, but must lie between 0 and 5"};
  EXPECT_EQ(Message(nested), "/a.json: en levels[0]: es 9, pero debe estar entre 0 y 5");
  // the issue: "de for instance con 3D Slicer, a DICOM"
  const base::Error image{
      base::ErrorCode::kImageUnsupported,
      "/a/b.dcm: nobody has heard of this; convert it, for instance with 3D Slicer, to DICOM, NIfTI "
      "or NRRD"};
  EXPECT_EQ(
      Message(image),
      "/a/b.dcm: nobody has heard of this; conviértala, por ejemplo con 3D Slicer, a DICOM, NIfTI o NRRD");
  const base::Error unknown{base::ErrorCode::kImageUnsupported,
                            "take this old thing, for a moment, to somebody who knows"};
  EXPECT_EQ(Message(unknown), unknown.message)
      << "a sentence that has no Spanish is English, and not half of each";
}

}  // namespace
}  // namespace trocar::presenter
