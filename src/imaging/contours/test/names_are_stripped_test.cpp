// SPDX-License-Identifier: Apache-2.0
// A DICOM series full of a person's data is opened, an organ grown and saved: none of it is in what is written.
// What goes on from there, the patient, attempts on it and data sets: tests/command/names_are_stripped_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "trocar/contours/build_organs.h"
#include "trocar/contours/contour_autosave.h"
#include "trocar/contours/contour_workspace.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/named_series.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::contours {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 96, kSlices = 26;

/// Signed HU of a gallbladder in a liver in air, with a bone.
std::int16_t HounsfieldAt(int x, int y, int slice) {
  const double to_middle = std::hypot(x - 48, y - 48);
  const double to_bile = std::hypot(x - 48, y - 48, 3.0 * (slice - 13));
  if (to_middle > 44) return -1000;
  if (std::hypot(x - 80, y - 48) < 6) return 700;
  return static_cast<std::int16_t>((to_bile < 18 ? 10 : 110) + (7 * x + 13 * y + 5 * slice) % 9 - 4);
}

void WriteSeries(const fs::path& folder) {
  fs::create_directories(folder);
  for (int slice = 1; slice <= kSlices; ++slice) {
    test::DicomFields fields;
    fields.rows = fields.columns = kSide;
    fields.spacing = "1\\1";
    fields.instance = slice;
    fields.position = "0\\0\\" + std::to_string(3 * slice);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        fields.pixels +=
            test::Bytes<std::int16_t>(static_cast<std::int16_t>(HounsfieldAt(x, y, slice) + 1024));
    }
    std::ofstream(folder / ("slice" + std::to_string(slice)), std::ios::binary)
        << test::WithPerson(test::MakeDicom(fields), slice);
  }
}

TEST(NamesAreStripped, FromWhatIsWrittenAfterReadingDicom) {
  const test::TemporaryFolder temporary;
  const fs::path images = temporary.Path() / test::kNamedFolder, out = temporary.Path() / "written";
  fs::create_directories(out);
  WriteSeries(images);
  // the search finds each of them where it is
  EXPECT_GT(test::FindLeaks(images).size(), kSlices * std::size(test::kNamedAttributes) / 2);

  auto workspace = ContourWorkspace::Open({images, {}, {}, {}});
  ASSERT_TRUE(workspace.ok()) << workspace.error().Text();
  const auto grown = GrowOrgan(workspace->MakeGrowthRequest(1, 13, {48, 48}));
  ASSERT_TRUE(grown.ok()) << grown.error().Text();
  ASSERT_TRUE(ApplyGrowth(workspace->Document(), *grown).ok());
  ASSERT_TRUE(workspace->Document().DeleteStructure(0).ok());
  {
    ContourAutosave autosave(AutosavePath(out / "contours.json"));
    autosave.Offer(workspace->Document().Text());
  }
  ASSERT_TRUE(fs::exists(AutosavePath(out / "contours.json")));
  ASSERT_TRUE(workspace->Save(out / "contours.json").ok());

  const auto points = ReadControlPoints(out / "contours.json");
  ASSERT_TRUE(points.ok()) << points.error().Text();
  std::vector<int> slices;
  for (const SliceContours& slice : points->structures[0].slices) slices.push_back(slice.slice);
  const auto pictures = ReadContouredSlices(*points, images, slices);
  ASSERT_TRUE(pictures.ok()) << pictures.error().Text();
  const auto built = BuildOrgans(*points, *pictures);
  ASSERT_TRUE(built.ok()) << built.error().Text();
  ASSERT_EQ(built->meshes.size(), 1u);
  EXPECT_EQ(test::FindLeaks(out), std::vector<std::string>());
}

// negative control: a name that is there is found, in any letters and in UTF-16, and in a file's name
TEST(NamesAreStripped, SearchFindsWhatLeaks) {
  const test::TemporaryFolder temporary;
  const std::string wide = test::Forms("STATION7741")[1];
  std::ofstream(temporary.Path() / "a.json") << "{\"name\": \"GRUENWALD\"}";
  std::ofstream(temporary.Path() / "b.bin", std::ios::binary) << "xx" << wide;
  std::ofstream(temporary.Path() / "of_zephyrine.log") << "nothing";
  const auto leaks = test::FindLeaks(temporary.Path());
  for (const char* file : {"a.json", "b.bin", "of_zephyrine.log"}) {
    EXPECT_TRUE(std::any_of(leaks.begin(), leaks.end(), [file](const std::string& leak) {
      return leak.starts_with(file);
    })) << file;
  }
}

}  // namespace
}  // namespace trocar::contours
