// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_trocar.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/image_stack.h"
#include "trocar/images/png_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

class ImagesCommand : public testing::Test {
 protected:
  void SetUp() override {
    for (int i = 3; i <= 9; ++i) {
      const images::ColorImage picture{
          40, 30, std::vector<std::uint8_t>(40 * 30 * 3, static_cast<std::uint8_t>(20 * i))};
      ASSERT_TRUE(
          images::WritePng(folder_.Path() / "stack" / ("s" + std::to_string(i) + ".png"), picture).ok());
    }
  }
  std::string Path(const std::string& name) const { return folder_.Path() / name; }
  Printed Run(std::vector<std::string> words) const {
    words.insert(words.begin(), {"anatomy", "images"});
    return RunTrocar(words);
  }
  static std::vector<std::string> With(std::vector<std::string> words) {
    for (const char* word : {"--pixel-mm", "0.7", "--slice-mm", "2", "--axes", "left,posterior,superior"})
      words.emplace_back(word);
    return words;
  }
  /// One line with this code, nothing else.
  static void ExpectRefused(const Printed& printed, const std::string& code, int status = 1) {
    EXPECT_EQ(printed.status, status);
    EXPECT_EQ(printed.out, "");
    EXPECT_THAT(printed.err, HasSubstr("trocar: " + code + " "));
    EXPECT_EQ(std::count(printed.err.begin(), printed.err.end(), '\n'), 1) << printed.err;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ImagesCommand, SaysWhatASeriesIs) {
  const Printed printed = Run(With({Path("stack"), "--preview", Path("preview.png")}));
  ASSERT_EQ(printed.status, 0) << printed.err;
  for (const char* text :
       {"PNG, files s{slice}.png", "7, number 3 to 9", "40 x 30 pixels", "0.7 mm", "posterior", "colour"})
    EXPECT_THAT(printed.out, HasSubstr(text));
  const auto preview = images::ReadImage(Path("preview.png"));
  ASSERT_TRUE(preview.ok()) << preview.error().Text();
  EXPECT_EQ(preview->At(preview->width - 300, 100)[0] % 20, 0) << "a slice of one shade";
}

TEST_F(ImagesCommand, SaysItToPrograms) {
  const Printed printed = Run(With({Path("stack"), "--json"}));
  ASSERT_EQ(printed.status, 0) << printed.err;
  const auto json = nlohmann::json::parse(printed.out);
  EXPECT_EQ(json["format"], "PNG");
  EXPECT_EQ(json["slice_numbers"], (std::vector{3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(json["pixel_mm"], 0.7);
  EXPECT_EQ(json["axes"]["slice"], "superior");
  EXPECT_EQ(json["file_frame"], "");
  EXPECT_EQ(json["window"]["width"], 255.0);
}

TEST_F(ImagesCommand, AsksAndExplains) {
  const Printed asked = Run({Path("stack")});
  ExpectRefused(asked, "E-IMG-005");
  EXPECT_THAT(asked.err, HasSubstr("--axes COLUMN,ROW,SLICE"));
  ExpectRefused(Run({Path("stack"), "--axes", "left,up"}), "E-CLI-001", 2);
  ExpectRefused(Run({Path("stack"), "--window", "40"}), "E-CLI-001", 2);
  ExpectRefused(Run({Path("stack"), "--window", "40,-2"}), "E-CLI-001", 2);
  ExpectRefused(Run({Path("stack"), "--pixel-mm", "zero"}), "E-CLI-001", 2);
  ExpectRefused(Run({}), "E-CLI-001", 2);
  const Printed help = Run({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("docs/images.md"));
}

TEST_F(ImagesCommand, DamagedFilesAreOneLineAndNoPreview) {
  const auto refuses = [&](const std::string& name, const std::string& content, const std::string& code) {
    ASSERT_TRUE(host::WriteFile(folder_.Path() / name, content).ok());
    ExpectRefused(Run(With({Path(name), "--preview", Path("preview.png")})), code);
    EXPECT_FALSE(fs::exists(Path("preview.png")));
  };
  refuses("noise.nii", "nothing", "E-IMG-004");
  refuses("bomb.nrrd",
          "NRRD0004\ntype: short\ndimension: 3\nsizes: 16000 16000 16000\nendian: little\nencoding: raw\n\n",
          "E-IMG-010");
  refuses("short.nrrd",
          "NRRD0004\ntype: short\ndimension: 3\nsizes: 16 16 16\nendian: little\nencoding: raw\n\n",
          "E-IMG-011");
  refuses("path.nhdr",
          "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\ndata file: "
          "../../x\n",
          "E-IMG-013");
  const std::string whole = *host::ReadFile(Path("stack/s5.png"));
  refuses("stack/s5.png", whole.substr(0, whole.size() / 2), "E-IMG-011");
  fs::remove(Path("stack/s5.png"));
  const Printed gap = Run(With({Path("stack")}));
  ExpectRefused(gap, "E-IMG-007");
  EXPECT_THAT(gap.err, HasSubstr("missing: 5;"));
  ExpectRefused(Run({"/dev/zero"}), "E-IMG-013");
}

TEST_F(ImagesCommand, ListsThePhasesOfADicomSeriesAndSaysWhatItPassedOver) {
  for (int slice = 1; slice <= 4; ++slice) {
    for (const int acquisition : {1, 2}) {
      test::DicomFields fields;
      fields.instance = slice + 10 * acquisition;
      fields.acquisition = std::to_string(acquisition);
      fields.position = "0\\0\\" + std::to_string(5 * slice);
      ASSERT_TRUE(host::WriteFile(folder_.Path() / "ct" / ("IM" + std::to_string(fields.instance)),
                                  test::MakeDicom(fields))
                      .ok());
    }
  }
  test::DicomFields report;
  report.sop_class = "1.2.840.10008.5.1.4.1.1.88.22";
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "ct" / "report", test::MakeDicom(report)).ok());
  const Printed asked = Run({Path("ct")});
  ExpectRefused(asked, "E-IMG-006");
  EXPECT_THAT(asked.err, HasSubstr("2 (CT, acquisition 2, slices: 4)"));
  const Printed printed = Run({Path("ct"), "--series", "2"});
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("4, number 21 to 24"));
  EXPECT_THAT(printed.out, HasSubstr("passed over: reports (SR) (1)"));
  const auto json = nlohmann::json::parse(Run({Path("ct"), "--series", "2", "--json"}).out);
  EXPECT_EQ(json["series"], 2);
  EXPECT_EQ(json["notes"].size(), 1u);
  // the id chooses the same, whatever else comes into the folder
  const auto same = nlohmann::json::parse(
      Run({Path("ct"), "--series", std::to_string(json["series_id"].get<int>()), "--json"}).out);
  EXPECT_EQ(same["slice_numbers"], json["slice_numbers"]);
}

}  // namespace
}  // namespace trocar::cli
