// SPDX-License-Identifier: Apache-2.0
// From a CT series full of a person's data to contours, a patient, an attempt on it and a data set: no byte and no name of what is
// written names the person or the folder that the images lie in.
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "command_fixture.h"
#include "trocar_test/named_series.h"

namespace trocar {
namespace {

namespace fs = std::filesystem;

class NamesAreStrippedSlow : public Command {
 protected:
  std::string Out(const std::string& name) const { return Path("written/" + name); }
  void Do(std::vector<std::string> arguments) {
    const auto result = Run(arguments);
    ASSERT_EQ(result.status, 0) << arguments[0] << " " << arguments[1] << ": " << result.err;
  }
  /// A CT phantom whose files are a person's.
  void MakeNamedSeries() {
    Do({"anatomy", "phantom", "--ct", "portal", "--seed", "1", "--pixel-mm", "1.6", "--slice-mm", "4", "-o",
        Path("phantom")});
    images_ = fs::path(Path(test::kNamedFolder)) / "study";
    fs::create_directories(images_);
    int slice = 0;
    for (const auto& entry : fs::directory_iterator(Path("phantom/slices"))) {
      std::ofstream(images_ / entry.path().filename(), std::ios::binary)
          << test::WithPerson(Read(entry.path().string()), ++slice);
    }
    ASSERT_GT(slice, 20);
    fs::create_directories(Path("written"));
  }
  /// The voxel of a label that has most of it around: "column,row,slice", as --at wants it.
  std::string FindMiddle(char label) const {
    const std::string map = Read(Path("phantom/labels.nrrd"));
    std::array<int, 3> size = {};
    std::istringstream(map.substr(map.find("sizes: ") + 7)) >> size[0] >> size[1] >> size[2];
    const std::size_t begin = map.find("\n\n") + 2;
    const auto at = [&](int i, int j, int k) {
      return map[begin + (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i] == label;
    };
    int most = -1;
    std::array<int, 3> best = {};
    for (int k = 1; k + 1 < size[2]; ++k) {
      for (int j = 12; j + 12 < size[1]; ++j) {
        for (int i = 12; i + 12 < size[0]; ++i) {
          if (!at(i, j, k)) continue;
          int around = at(i, j, k - 1) + at(i, j, k + 1);
          for (int d = 1; d <= 12; ++d) {
            const bool is_cross = at(i + d, j, k) && at(i - d, j, k) && at(i, j + d, k) && at(i, j - d, k);
            if (!is_cross) break;
            around += 4;
          }
          if (around > most) most = around, best = {i, j, k};
        }
      }
    }
    // the series' slices are numbered from 1
    return std::to_string(best[0]) + "," + std::to_string(best[1]) + "," + std::to_string(best[2] + 1);
  }
  fs::path images_;
};

TEST_F(NamesAreStrippedSlow, FromThePatientItsAttemptsAndTheirDataSets) {
  ASSERT_NO_FATAL_FAILURE(MakeNamedSeries());
  EXPECT_GT(test::FindLeaks(images_).size(), 20 * std::size(test::kNamedAttributes))
      << "the search finds nothing";
  Do({"anatomy", "grow", images_.string(), "--organ", "liver", "--at", FindMiddle(1), "-o",
      Out("liver.json")});
  Do({"anatomy", "grow", images_.string(), "--organ", "gallbladder", "--at", FindMiddle(2), "--points",
      Out("liver.json"), "-o", Out("contours.json")});
  Do({"anatomy", "build", Out("contours.json"), "--images", images_.string(), "-o", Out("patient"),
      "--no-overlays"});
  Do({"play", "expert", "--task", "cholecystectomy", "--patient", Out("patient"), "--seconds", "2",
      "--record", Out("attempt.trocar")});
  Do({"dataset", "--layout", "trocar", "--recording", Out("attempt.trocar"), "--size", "320x180", "-o",
      Out("set")});
  for (const char* written : {"contours.json", "patient/patient.json", "attempt.trocar", "set/card.json"})
    ASSERT_TRUE(fs::exists(Out(written))) << written;
  EXPECT_EQ(test::FindLeaks(Path("written")), std::vector<std::string>());
  // control: the search goes into the recording, too
  std::ofstream(Out("attempt.trocar"), std::ios::binary | std::ios::app) << "GRUENWALD";
  EXPECT_FALSE(test::FindLeaks(Path("written")).empty());
}

}  // namespace
}  // namespace trocar
