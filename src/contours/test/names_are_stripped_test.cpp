// SPDX-License-Identifier: Apache-2.0
// A DICOM series full of a person's data is opened, an organ grown and saved: none of it is in what is written.
// The attributes are those of DICOM PS3.15, table E.1-1, basic profile, that a CT series carries in its main data set.
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
#include "trocar/core/safe_file.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::contours {
namespace {

namespace fs = std::filesystem;
using test::Element;

struct Attribute {
  std::uint16_t group, element;
  const char *vr, *value;
};
// ascending, as a data set is
constexpr Attribute kAttributes[] = {
    {0x0008, 0x0020, "DA", "19710203"},
    {0x0008, 0x0030, "TM", "123456.654321"},
    {0x0008, 0x0050, "SH", "ACCESSION77413"},
    {0x0008, 0x0080, "LO", "Zephyr Institution"},
    {0x0008, 0x0081, "ST", "Zephyr Lane 9"},
    {0x0008, 0x0090, "PN", "Referrer^Quentin"},
    {0x0008, 0x0092, "ST", "Referrer Address"},
    {0x0008, 0x0094, "SH", "0049-555-7741"},
    {0x0008, 0x1010, "SH", "STATION7741"},
    {0x0008, 0x1030, "LO", "Study of Zephyrine"},
    {0x0008, 0x103E, "LO", "Series of Zephyrine"},
    {0x0008, 0x1040, "LO", "Department Zephyr"},
    {0x0008, 0x1048, "PN", "Recorder^Rufus"},
    {0x0008, 0x1050, "PN", "Performer^Petra"},
    {0x0008, 0x1060, "PN", "Reader^Rosalind"},
    {0x0008, 0x1070, "PN", "Operator^Oswald"},
    {0x0008, 0x1080, "LO", "Diagnosis Zebra"},
    {0x0008, 0x2111, "ST", "Derived from Zephyrine"},
    {0x0009, 0x0010, "LO", "PRIVATECREATOR"},
    {0x0009, 0x1001, "LO", "PrivateZephyrine"},
    {0x0010, 0x0010, "PN", "Gruenwald^Zephyrine"},
    {0x0010, 0x0020, "LO", "PATIENTID774133"},
    {0x0010, 0x0030, "DA", "19480917"},
    {0x0010, 0x0032, "TM", "031415.926535"},
    {0x0010, 0x1000, "LO", "OTHERID774134"},
    {0x0010, 0x1001, "PN", "Othername^Zephyrine"},
    {0x0010, 0x1005, "PN", "Birthname^Zephyrine"},
    {0x0010, 0x1010, "AS", "078Y"},
    {0x0010, 0x1040, "LO", "Home Street 123"},
    {0x0010, 0x1060, "PN", "Mothername^Zenobia"},
    {0x0010, 0x2000, "LO", "Alert of Zephyrine"},
    {0x0010, 0x2154, "SH", "0049-555-8852"},
    {0x0010, 0x2180, "SH", "Lighthousekeeper"},
    {0x0010, 0x21B0, "LT", "History of Zephyrine"},
    {0x0010, 0x4000, "LT", "Comments on Zephyrine"},
    {0x0018, 0x1000, "LO", "SERIAL774135"},
    {0x0018, 0x1030, "LO", "Protocol Zephyrine"},
    {0x0020, 0x000D, "UI", "1.2.826.0.1.77413.1"},
    {0x0020, 0x000E, "UI", "1.2.826.0.1.77413.2"},
    {0x0020, 0x0010, "SH", "STUDYID774136"},
    {0x0020, 0x0052, "UI", "1.2.826.0.1.77413.3"},
    {0x0020, 0x4000, "LT", "Image of Zephyrine"},
    {0x0032, 0x1032, "PN", "Requester^Roland"},
    {0x0032, 0x1060, "LO", "Procedure Zephyrine"},
    {0x0032, 0x4000, "LT", "Studycomment Zephyr"},
    {0x0038, 0x0010, "LO", "ADMISSION774137"},
    {0x0038, 0x0300, "LO", "Ward Zephyr"},
    {0x0038, 0x0500, "LO", "State of Zephyrine"},
    {0x0040, 0x0253, "SH", "STEP774138"},
    {0x0040, 0x0254, "LO", "Step of Zephyrine"},
    {0x0040, 0x2016, "LO", "PLACER774139"},
    {0x4008, 0x0300, "ST", "Impression Zephyrine"},
};
constexpr int kSide = 96, kSlices = 26;
// the folders that series come in are often called after the person
constexpr const char* kFolder = "Foldername_Zephyrine";

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
    // the made file up to its first group, then the groups in order, then its geometry and pixels
    test::DicomFields fields;
    fields.rows = fields.columns = kSide;
    fields.spacing = "1\\1";
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        fields.pixels +=
            test::Bytes<std::int16_t>(static_cast<std::int16_t>(HounsfieldAt(x, y, slice) + 1024));
    }
    const std::string made = test::MakeDicom(fields);
    const std::size_t begin = made.find(Element(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2"));
    const std::size_t picture =
        made.find(test::Bytes<std::uint16_t>(0x28) + test::Bytes<std::uint16_t>(2) + "US");
    const std::size_t pixels =
        made.find(test::Bytes<std::uint16_t>(0x7FE0) + test::Bytes<std::uint16_t>(0x10) + "OW");
    ASSERT_TRUE(begin != std::string::npos && picture != std::string::npos && pixels != std::string::npos);
    std::vector<std::pair<std::uint32_t, std::string>> elements;
    const auto add = [&](std::uint16_t group, std::uint16_t element, const char* vr,
                         const std::string& value) {
      elements.emplace_back(std::uint32_t{group} << 16 | element, Element(group, element, vr, value));
    };
    for (const Attribute& a : kAttributes) add(a.group, a.element, a.vr, a.value);
    add(8, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2");
    add(8, 0x18, "UI", "1.2.826.0.1.77413.4." + std::to_string(slice));
    add(8, 0x60, "CS", "CT");
    add(0x20, 0x13, "IS", std::to_string(slice));
    add(0x20, 0x32, "DS", "0\\0\\" + std::to_string(3 * slice));
    add(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0");
    elements.emplace_back(0x00280000, made.substr(picture, pixels - picture));
    std::sort(elements.begin(), elements.end());
    std::string file = made.substr(0, begin);
    for (const auto& element : elements) file += element.second;
    std::ofstream(folder / ("slice" + std::to_string(slice)), std::ios::binary) << file + made.substr(pixels);
  }
}

std::string Lower(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

/// The value as bytes of UTF-8 and of UTF-16 of both orders.
std::vector<std::string> Forms(const std::string& value) {
  std::string little, big;
  for (const char c : Lower(value)) little += c, little += '\0', big += '\0', big += c;
  return {Lower(value), little, big};
}

/// What of the person stands in the files of a folder, in their bytes or names.
std::vector<std::string> FindLeaks(const fs::path& folder) {
  std::vector<std::string> values = {"Zephyrine", "Gruenwald", kFolder, "1.2.826.0.1.77413"};
  for (const Attribute& a : kAttributes) {
    const std::string value = a.value;
    // an age is too short to be told from a number
    if (value.size() < 6) continue;
    values.push_back(value);
    // a name's parts, and as it is spoken
    if (const auto cut = value.find('^'); cut != std::string::npos) {
      values.push_back(value.substr(0, cut));
      values.push_back(value.substr(cut + 1) + " " + value.substr(0, cut));
    }
  }
  std::vector<std::string> leaks;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::string bytes = fs::relative(entry.path(), folder).string() + "\n";
    if (entry.is_regular_file()) {
      std::ifstream file(entry.path(), std::ios::binary);
      bytes.append(std::istreambuf_iterator<char>(file), {});
    }
    bytes = Lower(std::move(bytes));
    for (const std::string& value : values) {
      for (const std::string& form : Forms(value)) {
        if (bytes.find(form) != std::string::npos)
          leaks.push_back(entry.path().filename().string() + ": " + value);
      }
    }
  }
  return leaks;
}

TEST(NamesAreStripped, FromWhatIsWrittenAfterReadingDicom) {
  const test::TemporaryFolder temporary;
  const fs::path images = temporary.Path() / kFolder, out = temporary.Path() / "written";
  fs::create_directories(out);
  WriteSeries(images);
  // the search finds each of them where it is
  EXPECT_GT(FindLeaks(images).size(), kSlices * std::size(kAttributes) / 2);

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
  EXPECT_EQ(FindLeaks(out), std::vector<std::string>());
}

// negative control: a name that is there is found, in any letters and in UTF-16, and in a file's name
TEST(NamesAreStripped, SearchFindsWhatLeaks) {
  const test::TemporaryFolder temporary;
  const std::string wide = Forms("STATION7741")[1];
  std::ofstream(temporary.Path() / "a.json") << "{\"name\": \"GRUENWALD\"}";
  std::ofstream(temporary.Path() / "b.bin", std::ios::binary) << "xx" << wide;
  std::ofstream(temporary.Path() / "of_zephyrine.log") << "nothing";
  const auto leaks = FindLeaks(temporary.Path());
  for (const char* file : {"a.json", "b.bin", "of_zephyrine.log"}) {
    EXPECT_TRUE(std::any_of(leaks.begin(), leaks.end(), [file](const std::string& leak) {
      return leak.starts_with(file);
    })) << file;
  }
}

}  // namespace
}  // namespace trocar::contours
