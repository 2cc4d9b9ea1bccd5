// SPDX-License-Identifier: Apache-2.0
/// \file task_window_picture_check.cpp  Judges the pictures of the list of tasks and of a task's result.
#include <nlohmann/json.hpp>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar_test/window_picture.h"

namespace {

using trocar::test::Fail;

/// The report that trocar-window printed among other lines.
nlohmann::json ReadReport(const char* file) {
  const auto text = trocar::host::ReadFile(file);
  if (!text) return nullptr;
  const std::size_t begin = text->find("{\"screenshot\"");
  if (begin == std::string::npos) return nullptr;
  return nlohmann::json::parse(text->substr(begin, text->find('\n', begin) - begin), nullptr, false);
}

bool IsText(const unsigned char* p) {
  return p[0] > 190 && p[1] > 190 && p[2] > 190;
}
bool IsCard(const unsigned char* p) {
  return p[0] < 32 && p[1] < 36 && p[2] < 42 && p[1] > 14;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return Fail("usage: task_window_picture_check list|result PICTURE.png REPORT.json");
  const bool is_list = std::string(argv[1]) == "list";
  const nlohmann::json report = ReadReport(argv[3]);
  if (!report.is_object()) return Fail("there is no report");
  if (report.at("has_task_list") != is_list)
    return Fail("the list of tasks is shown when it should not be, or not");
  if (report.at("result") != (is_list ? "" : "Completed"))
    return Fail("the result is " + report.at("result").dump());
  const auto picture = trocar::test::ReadWindowPicture(argv[2]);
  // the card lies in the middle of the laparoscope's picture, left of the panel
  const unsigned x0 = picture.width / 5, x1 = picture.width * 3 / 5, y0 = picture.height / 4,
                 y1 = picture.height * 3 / 4;
  const int all = static_cast<int>((x1 - x0) * (y1 - y0));
  const int card = picture.Count(x0, y0, x1, y1, IsCard), text = picture.Count(x0, y0, x1, y1, IsText);
  std::printf("card %d text %d of %d\n", card, text, all);
  if (card < all / 4) return Fail("no card lies over the picture");
  if (text < 300) return Fail("the card says nothing");
  if (is_list) return 0;
  const int primary = picture.Count(0, y0, x1, picture.height, [](const unsigned char* p) {
    return p[0] < 60 && p[1] > 100 && p[1] < 150 && p[2] > 120 && p[2] < 170;
  });
  if (primary < 500) return Fail("there is no button to try again");
  return 0;
}
