// SPDX-License-Identifier: Apache-2.0
/// \file contour_picture_check.cpp  Makes slices and a script for the contour window, and judges the picture
/// and the report of its --screenshot.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "trocar/host/safe_file.h"
#include "trocar/images/png_file.h"
#include "trocar_test/window_picture.h"

namespace {

using trocar::images::ColorImage;
namespace fs = std::filesystem;

constexpr int kWidth = 320, kHeight = 240, kSlices = 12;

using trocar::test::Fail;

double Radius(int slice) {
  return 40 + 5 * slice - 0.3 * slice * slice;
}

int Make(const fs::path& folder) {
  for (int slice = 1; slice <= kSlices; ++slice) {
    ColorImage image{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight * 3)};
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double part = std::fmin(1, std::fmax(0, Radius(slice) - std::hypot(x - 160.0, y - 120.0)));
        const double shade[] = {190 - 80 * part, 165 - 125 * part, 130 - 100 * part};
        for (int c = 0; c < 3; ++c)
          image.At(x, y)[c] = static_cast<std::uint8_t>(shade[c] + (x * 7 + y * 13) % 9);
      }
    }
    if (!trocar::images::WritePng(folder / "slices" / ("s" + std::to_string(slice) + ".png"), image).ok())
      return Fail("cannot write the slices");
  }
  std::string script = "# a disc drawn in one slice and carried on\norgan liver\nslice 2\n";
  for (int i = 0; i < 10; ++i) {
    const double angle = 2 * M_PI * i / 10, r = Radius(2) + 2;
    script += "click " + std::to_string(160 + r * std::cos(angle)) + " " +
              std::to_string(120 + r * std::sin(angle)) + "\n";
  }
  script += "close\npropagate 4\npropagate 6\npropagate 8\nslice 2\npointer 160 60\nawait mesh\n";
  return trocar::host::WriteFile(folder / "contours.script", script).ok() ? 0
                                                                          : Fail("cannot write the script");
}

int Check(const char* picture, const char* report_file) {
  const auto text = trocar::host::ReadFile(report_file);
  if (!text) return Fail(text.error().Text());
  const std::size_t begin = text.value().find("{\"screenshot\""), end = text.value().find('\n', begin);
  if (begin == std::string::npos || end == std::string::npos) return Fail("there is no report");
  const auto report = nlohmann::json::parse(text.value().substr(begin, end - begin), nullptr, false);
  if (report.is_discarded()) return Fail("the report is no JSON");
  if (report.at("contoured_slices") != 4) return Fail("the script made other contours than four");
  if (report.at("surfaces") != 1) return Fail("there is no surface");
  if (report.at("triangles").get<int>() < 500) return Fail("the surface has fewer than 500 triangles");
  if (report.at("slice") != 2) return Fail("another slice is shown");

  const trocar::test::WindowPicture image = trocar::test::ReadWindowPicture(picture);
  // the three stages on the canvas, and the shaded surface beside it
  int clicked = 0, adapted = 0, spline = 0, surface = 0;
  const unsigned canvas_end = image.width - 360;
  for (unsigned y = 60; y < image.height - 100; ++y) {
    for (unsigned x = 0; x < image.width; ++x) {
      const unsigned char* p = image.At(x, y);
      if (x < canvas_end) {
        clicked += p[0] > 220 && p[1] < 110 && p[2] < 100;
        adapted += p[0] > 230 && p[1] > 190 && p[2] < 90;
        spline += p[0] < 120 && p[1] > 200 && p[2] < 150;
      } else if (y > image.height / 2) {
        surface += p[0] > 90 && p[0] > p[2] + 30;
      }
    }
  }
  std::printf("clicked %d adapted %d spline %d surface %d\n", clicked, adapted, spline, surface);
  if (clicked < 60) return Fail("the clicked points are not shown in red");
  if (adapted < 60) return Fail("the adapted points are not shown in yellow");
  if (spline < 500) return Fail("the spline is not shown in green");
  if (surface < 1000) return Fail("the surface is not shown beside it");
  return 0;
}

/// The report that trocar-window printed among other lines.
nlohmann::json ReadReport(const char* file) {
  const auto text = trocar::host::ReadFile(file);
  if (!text) return nullptr;
  const std::size_t begin = text.value().find("{\"screenshot\"");
  if (begin == std::string::npos) return nullptr;
  return nlohmann::json::parse(text.value().substr(begin, text.value().find('\n', begin) - begin), nullptr,
                               false);
}

/// A recovered session that was saved and built, with nothing left beside the file.
int CheckBuilt(const fs::path& folder, int recovered_slices) {
  const auto report = ReadReport((folder / "report.json").c_str());
  if (!report.is_object()) return Fail("there is no report");
  if (report.at("contoured_slices") != recovered_slices)
    return Fail("not the recovered contours are shown: " + report.dump());
  if (report.at("is_saved") != true) return Fail("the recovered contours are not saved: " + report.dump());
  const std::string messages = report.at("messages").dump();
  if (messages.find("Wrote the patient") == std::string::npos || messages.find("liver") == std::string::npos)
    return Fail("the window does not say what it built: " + messages);
  if (!fs::exists(folder / "built" / "patient.json")) return Fail("no patient was written");
  if (fs::exists(folder / "given-up")) return Fail("a patient that was given up was written");
  for (const char* name : {"points.json.autosave", "points.json.autosave.lock"}) {
    if (fs::exists(folder / name)) return Fail(std::string(name) + " was left behind");
  }
  return 0;
}

/// A second window on the same file.
int CheckSecond(const fs::path& folder) {
  const auto report = ReadReport((folder / "second.json").c_str());
  if (!report.is_object()) return Fail("there is no report");
  if (report.at("has_autosave") != false) return Fail("two windows keep the same side file");
  if (!fs::exists(folder / "points.json.autosave")) return Fail("the other window's side file is gone");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "check-built") return CheckBuilt(argv[2], std::atoi(argv[3]));
  if (argc == 3 && std::string(argv[1]) == "check-second") return CheckSecond(argv[2]);
  if (argc == 3 && std::string(argv[1]) == "make") return Make(argv[2]);
  if (argc == 4 && std::string(argv[1]) == "check") return Check(argv[2], argv[3]);
  return Fail(
      "usage: contour_picture_check make FOLDER | check PICTURE.png REPORT.json | check-built FOLDER SLICES "
      "| check-second FOLDER");
}
