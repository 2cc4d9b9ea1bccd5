// SPDX-License-Identifier: Apache-2.0
/// \file window_picture_check.cpp  Judges the picture and the report of `trocar-window --screenshot`.
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar_test/window_picture.h"

using trocar::test::Fail;

int main(int argc, char** argv) {
  if (argc != 3) return Fail("usage: window_picture_check PICTURE.png REPORT.json");
  const auto text = trocar::host::ReadFile(argv[2]);
  if (!text) return Fail(text.error().Text());
  // the session's helpers may have written lines of their own
  const std::size_t begin = text.value().find("{\"screenshot\""), end = text.value().find('}', begin);
  if (begin == std::string::npos || end == std::string::npos) return Fail("there is no report");
  const nlohmann::json report =
      nlohmann::json::parse(text.value().substr(begin, end - begin + 1), nullptr, false);
  if (report.is_discarded()) return Fail("the report is no JSON");
  if (report.at("ticks").get<int>() < 200) return Fail("two seconds are at least 200 ticks of 1/120 s");
  if (report.at("pictures").get<int>() < 2) return Fail("fewer than 2 pictures were drawn");

  const trocar::test::WindowPicture image = trocar::test::ReadWindowPicture(argv[1]);

  // the middle of the laparoscope's picture shows tissue: red over blue, in many shades
  std::set<int> shades;
  int tissue = 0, all = 0;
  for (unsigned y = image.height / 4; y < image.height * 3 / 4; ++y) {
    for (unsigned x = image.width / 6; x < image.width * 11 / 20; ++x) {
      const unsigned char* pixel = image.At(x, y);
      shades.insert(pixel[0] << 16 | pixel[1] << 8 | pixel[2]);
      tissue += pixel[0] > 40 && pixel[0] > pixel[2] + 15;
      ++all;
    }
  }
  if (shades.size() < 500) return Fail("the laparoscope's picture is nearly empty: fewer than 500 colours");
  if (tissue < all / 4) return Fail("less than a quarter of the laparoscope's picture shows tissue");
  return 0;
}
