// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_from_labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using testing::HasSubstr;

constexpr int kX = 70, kY = 60, kZ = 52;  // voxels of 3 mm

/// A liver of a ball above and an egg below it, 1 mm apart from left/right symmetry. Index axes are right,
/// anterior, superior (RAS).
std::vector<std::uint8_t> MakeLabels(int liver, int gallbladder) {
  std::vector<std::uint8_t> labels(static_cast<std::size_t>(kX) * kY * kZ, 0);
  for (int k = 0; k < kZ; ++k) {
    for (int j = 0; j < kY; ++j) {
      for (int i = 0; i < kX; ++i) {
        // mm: right of, in front of and above the middle
        const double r = 3.0 * (i - 35), a = 3.0 * (j - 30), s = 3.0 * (k - 26);
        auto& label = labels[(static_cast<std::size_t>(k) * kY + j) * kX + i];
        if (r * r / (85.0 * 85) + a * a / (62.0 * 62) + (s - 10) * (s - 10) / (50.0 * 50) < 1)
          label = static_cast<std::uint8_t>(liver);
        const double egg_r = r - 20, egg_a = a - 8, egg_s = s + 45;
        if (egg_r * egg_r / (14.0 * 14) + egg_a * egg_a / (38.0 * 38) + egg_s * egg_s / (15.0 * 15) < 1)
          label = static_cast<std::uint8_t>(gallbladder);
      }
    }
  }
  return labels;
}

template <typename T>
void Put(std::string& text, std::size_t at, T value) {
  std::memcpy(&text[at], &value, sizeof value);
}

/// NIfTI-1 file with 8-bit voxels of 3 mm; index axes run to the right (or left), anterior and superior.
std::string FormatNifti(const std::vector<std::uint8_t>& labels, bool mirrored = false) {
  std::string text(352, '\0');
  Put<std::int32_t>(text, 0, 348);
  const std::int16_t dims[8] = {3, kX, kY, kZ, 1, 1, 1, 1};
  std::memcpy(&text[40], dims, sizeof dims);
  Put<std::int16_t>(text, 70, 2);  // unsigned bytes
  Put<std::int16_t>(text, 72, 8);
  const float sizes[8] = {1, 3, 3, 3, 1, 1, 1, 1};
  std::memcpy(&text[76], sizes, sizeof sizes);
  Put<float>(text, 108, 352);
  Put<float>(text, 112, 1);
  Put<char>(text, 123, 2);          // mm
  Put<std::int16_t>(text, 254, 1);  // the rows below hold
  const float x = mirrored ? -3.0f : 3.0f;
  const float rows[12] = {x, 0, 0, 10, 0, 3, 0, -20, 0, 0, 3, 30};
  std::memcpy(&text[280], rows, sizeof rows);
  std::memcpy(&text[344], "n+1", 4);
  text.append(reinterpret_cast<const char*>(labels.data()), labels.size());
  return text;
}

/// The same with a label table in an extension of the header, as TotalSegmentator writes it with --ml.
std::string WithLabelTable(std::string nifti, const std::vector<std::pair<int, std::string>>& names) {
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?> <CaretExtension>  <VolumeInformation Index=\"0\">   "
      "<LabelTable>\n";
  for (const auto& [label, name] : names) {
    xml += "<Label Key=\"" + std::to_string(label) +
           "\" Red=\"1.0\" Green=\"0.0\" Blue=\"0.0\" Alpha=\"1\"><![CDATA[" + name + "]]></Label>\n";
  }
  xml +=
      "  </LabelTable>  <VolumeType><![CDATA[Label]]></VolumeType>   </VolumeInformation></CaretExtension>";
  xml.resize((xml.size() + 8 + 15) / 16 * 16 - 8, ' ');
  std::string extension(8, '\0');
  Put<std::int32_t>(extension, 0, static_cast<std::int32_t>(xml.size() + 8));
  extension += xml;
  Put<char>(nifti, 348, 1);
  Put<float>(nifti, 108, static_cast<float>(352 + extension.size()));
  return nifti.insert(352, extension);
}

/// NRRD as 3D Slicer writes it, LPS, the same body.
std::string FormatNrrd(const std::vector<std::uint8_t>& labels, int liver, int gallbladder) {
  std::string text =
      "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\nsizes: " +
      std::to_string(kX) + " " + std::to_string(kY) + " " + std::to_string(kZ) +
      "\nspace directions: (-3,0,0) (0,-3,0) (0,0,3)\nkinds: domain domain domain\nencoding: raw\n"
      "space origin: (0,0,0)\nSegment0_LabelValue:=" +
      std::to_string(liver) + "\nSegment0_Name:=Liver\nSegment1_LabelValue:=" + std::to_string(gallbladder) +
      "\nSegment1_Name:=gall bladder\n\n";
  text.append(reinterpret_cast<const char*>(labels.data()), labels.size());
  return text;
}

class FromLabels : public testing::Test {
 protected:
  fs::path Write(const char* name, const std::string& content) {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / name, content).ok());
    return folder_.Path() / name;
  }
  base::Result<BuildReport> Build(const fs::path& labels, int liver = 0, int gallbladder = 0) {
    LabelOptions options;
    options.labels = labels, options.output = folder_.Path() / "patient";
    options.liver = liver, options.gallbladder = gallbladder;
    options.spacing_mm = 2.0;
    return BuildPatientFromLabels(options);
  }
  base::Error Failure(const fs::path& labels, int liver = 0, int gallbladder = 0) {
    const auto report = Build(labels, liver, gallbladder);
    EXPECT_FALSE(fs::exists(folder_.Path() / "patient"));
    return report.ok() ? base::Error{} : report.error();
  }

  test::TemporaryFolder folder_;
};

void ExpectThatBody(const BuildReport& report) {
  ASSERT_EQ(report.organs.size(), 2u);
  for (const contours::OrganReport& organ : report.organs) {
    EXPECT_TRUE(organ.closed && organ.manifold && organ.outward) << organ.name;
    EXPECT_EQ(organ.genus, 0) << organ.name;
    EXPECT_EQ(organ.self_intersections, 0u) << organ.name;
  }
  EXPECT_NEAR(report.organs[1].volume_ml, 4.0 / 3 * M_PI * 14 * 38 * 15 / 1000, 3.0);
  // the gallbladder lies to the right of the liver's middle, below it, its long axis to the front
  const patient::Patient& patient = report.patient;
  EXPECT_TRUE(patient::CheckPatient(patient).ok());
  const auto liver = geometry::CalcBox(patient.organs[0].mesh.positions);
  const auto gallbladder = geometry::CalcBox(patient.organs[1].mesh.positions);
  const math::Vec3 offset = 0.5 * (gallbladder.min + gallbladder.max) - 0.5 * (liver.min + liver.max);
  EXPECT_NEAR(offset.x, -0.020, 0.004);
  EXPECT_LT(offset.y, -0.040);
  EXPECT_NEAR(offset.z, 0.008, 0.004);
  EXPECT_GT(patient.FindLandmark("fundus")->position.z,
            patient.FindLandmark("infundibulum")->position.z + 0.04);
  EXPECT_GE(patient.tubes.size(), 5u);
  for (const patient::Tube& tube : patient.tubes) EXPECT_FALSE(tube.is_seen) << tube.name;
}

/// What TotalSegmentator's task "total" makes of that body, with a spleen and a right kidney: 1 spleen,
/// 2 kidney_right, 4 gallbladder, 5 liver.
std::vector<std::uint8_t> MakeTotalLabels() {
  auto labels = MakeLabels(5, 4);
  for (int k = 4; k < 12; ++k) {
    for (int j = 4; j < 12; ++j) {
      for (const auto& [i, label] : {std::pair{10, 1}, {60, 2}}) {
        for (int width = 0; width < 6; ++width)
          labels[(static_cast<std::size_t>(k) * kY + j) * kX + i + width] = static_cast<std::uint8_t>(label);
      }
    }
  }
  return labels;
}

TEST_F(FromLabels, BuildsAPatientFromNifti) {
  // the right kidney is there, too: taken for the gallbladder it would lie far to the right
  const auto report = Build(Write("total.nii", FormatNifti(MakeTotalLabels())));
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ExpectThatBody(*report);
  EXPECT_THAT(report->patient.provenance, HasSubstr("TotalSegmentator"));
  EXPECT_TRUE(files::ReadPatient(folder_.Path() / "patient").ok());
}

/// The same file with wider samples, whose labels are these.
template <typename Sample>
std::string Widened(const std::string& nifti, std::int16_t type, double liver, double gallbladder) {
  std::string wide = nifti.substr(0, 352);
  Put<std::int16_t>(wide, 70, type);
  Put<std::int16_t>(wide, 72, 8 * sizeof(Sample));
  for (std::size_t at = 352; at < nifti.size(); ++at) {
    const Sample sample = static_cast<Sample>(nifti[at] == 1 ? liver : nifti[at] == 2 ? gallbladder : 0);
    wide.append(reinterpret_cast<const char*>(&sample), sizeof sample);
  }
  return wide;
}

TEST_F(FromLabels, TakesLabelsOfEveryWidth) {
  const std::string plain = FormatNifti(MakeLabels(1, 2));
  const auto narrow = Build(Write("narrow.nii", plain));
  ASSERT_TRUE(narrow.ok());
  const auto expect_same = [&](const std::string& content, int liver, int gallbladder) {
    fs::remove_all(folder_.Path() / "patient");
    const auto wide = Build(Write("wide.nii", content), liver, gallbladder);
    ASSERT_TRUE(wide.ok()) << wide.error().Text();
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_EQ(wide->patient.organs[i].mesh, narrow->patient.organs[i].mesh) << liver;
  };
  expect_same(Widened<std::uint16_t>(plain, 512, 65535, 40000), 65535, 40000);
  expect_same(Widened<std::int32_t>(plain, 8, 614'454'277, 614'454'276), 614'454'277, 614'454'276);
  expect_same(Widened<float>(plain, 16, 70'000, 300), 70'000, 300);
  // found by the names in the header
  expect_same(WithLabelTable(Widened<std::uint16_t>(plain, 512, 65535, 300),
                             {{65535, "liver"}, {300, "gallbladder"}, {7, "spleen"}}),
              0, 0);
  fs::remove_all(folder_.Path() / "patient");
  const base::Error error = Failure(Write("odd.nii", Widened<std::uint16_t>(plain, 512, 65535, 40000)));
  EXPECT_EQ(error.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(error.message, HasSubstr("it has 40000, 65535"));
  EXPECT_THAT(Failure(Write("half.nii", Widened<float>(plain, 16, 1, 2.5))).message,
              HasSubstr("2.5 is no whole number"));
}

TEST_F(FromLabels, FollowsTheHeadersDirections) {
  // a header whose first axis runs to the left mirrors the body: the gallbladder lies on the left
  const auto report = Build(Write("mirrored.nii", FormatNifti(MakeLabels(1, 2), true)));
  ASSERT_TRUE(report.ok()) << report.error().Text();
  const auto liver = geometry::CalcBox(report->patient.organs[0].mesh.positions);
  const auto gallbladder = geometry::CalcBox(report->patient.organs[1].mesh.positions);
  EXPECT_NEAR(0.5 * (gallbladder.min.x + gallbladder.max.x) - 0.5 * (liver.min.x + liver.max.x), 0.020,
              0.004);
}

TEST_F(FromLabels, KnowsSlicersSegmentNames) {
  const auto report = Build(Write("mine.seg.nrrd", FormatNrrd(MakeLabels(7, 9), 7, 9)));
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ExpectThatBody(*report);
  EXPECT_THAT(report->patient.provenance, HasSubstr("the map's names"));
}

TEST_F(FromLabels, KnowsTheNamesInANiftiHeader) {
  const std::string plain = FormatNifti(MakeLabels(17, 3));
  const auto report = Build(Write(
      "ml.nii", WithLabelTable(plain, {{1, "spleen"}, {3, "gallbladder"}, {17, "liver"}, {300, "far"}})));
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ExpectThatBody(*report);
  EXPECT_THAT(report->patient.provenance, HasSubstr("the map's names"));
}

TEST_F(FromLabels, AsksForTheOrganThatAFileWithNamesDoesNotName) {
  const std::string plain = FormatNifti(MakeTotalLabels());
  const fs::path file =
      Write("ml.nii", WithLabelTable(plain, {{1, "spleen"}, {2, "kidney_right"}, {5, "liver"}}));
  const base::Error error = Failure(file);
  EXPECT_EQ(error.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(error.message, HasSubstr("--gallbladder"));
  EXPECT_TRUE(Build(file, 0, 4).ok());
}

TEST_F(FromLabels, PassesOverExtensionsThatAreNoLabelTables) {
  const std::string whole = WithLabelTable(FormatNifti(MakeLabels(1, 2)), {{1, "liver"}, {2, "gallbladder"}});
  const auto convention = [&](const std::string& content) {
    const auto volume = images::ReadLabelVolume(Write("odd.nii", content));
    EXPECT_TRUE(volume.ok());
    return volume.ok() ? FindLabels(*volume, {})->convention : "";
  };
  EXPECT_EQ(convention(whole), "the map's names");
  for (const std::int32_t size : {0, -16, 7, 1 << 30, INT32_MAX, INT32_MIN}) {
    std::string lying = whole;
    Put<std::int32_t>(lying, 352, size);
    EXPECT_EQ(convention(lying), "the numbers of Trocar") << size;
  }
  for (const char* text :
       {"<Label Key=\"1", "<Label >liver</Label>", "<Label Key=\"x\">liver</Label>",
        "<Label Key=\"0\">liver</Label>", "<Label Key=\"1\"></Label>", "<Label Key=\"1\"><![CDATA["}) {
    std::string odd = whole;
    const auto end = static_cast<std::size_t>(odd.find("</CaretExtension>"));
    std::fill(odd.begin() + 360, odd.begin() + static_cast<std::ptrdiff_t>(end) + 17, ' ');
    odd.replace(end - std::strlen(text), std::strlen(text), text);
    EXPECT_EQ(convention(odd), "the numbers of Trocar") << text;
  }
}

TEST_F(FromLabels, ObeysATableOfNames) {
  LabelOptions options;
  options.labels = Write("odd.nii", FormatNifti(MakeLabels(17, 3)));
  options.names = Write("names.txt", "3 gallbladder 0 255 0 255\n17 liver 255 0 0 255\n");
  options.spacing_mm = 2.0;
  const auto report = BuildPatientFromLabels(options);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ExpectThatBody(*report);
  options.names = folder_.Path() / "none.txt";
  EXPECT_EQ(BuildPatientFromLabels(options).error().code, ErrorCode::kFileMissing);
}

TEST_F(FromLabels, RefusesWhatIsNoPerson) {
  EXPECT_THAT(Failure(Write("swapped.nii", FormatNifti(MakeLabels(2, 1)))).message, HasSubstr("swapped"));
  std::string centimetres = FormatNifti(MakeLabels(1, 2));
  for (const std::size_t at : {280u, 300u, 320u}) Put<float>(centimetres, at, 0.3f);
  EXPECT_THAT(Failure(Write("cm.nii", centimetres)).message, HasSubstr("centimetres"));
  const base::Error none = Failure(Write("none.nii", FormatNifti(MakeLabels(1, 0))));
  EXPECT_EQ(none.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(none.message, testing::AllOf(HasSubstr("taken out before"), HasSubstr("trocar play --list")));
}

TEST_F(FromLabels, KnowsAMapOfTheChest) {
  // lungs by TotalSegmentator's numbers
  const base::Error numbers = Failure(Write("lungs.nii", FormatNifti(MakeLabels(10, 12))));
  EXPECT_EQ(numbers.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(numbers.message, HasSubstr("map of the chest"));
  const base::Error names =
      Failure(Write("named.nii", WithLabelTable(FormatNifti(MakeLabels(7, 8)),
                                                {{7, "lung_upper_lobe_left"}, {8, "heart"}})));
  EXPECT_EQ(names.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(names.message, HasSubstr("map of the chest"));
  // the top of the liver is in a scan of the chest, the gallbladder is not
  const base::Error dome =
      Failure(Write("dome.nii", WithLabelTable(FormatNifti(MakeLabels(5, 8)), {{5, "liver"}, {8, "heart"}})));
  EXPECT_THAT(dome.message, testing::AllOf(HasSubstr("ends above it"), HasSubstr("--gallbladder")));
  // another region
  EXPECT_THAT(Failure(Write("hips.nii", FormatNifti(MakeLabels(77, 78)))).message,
              HasSubstr("another region of the body"));
}

TEST_F(FromLabels, RefusesTwoLivers) {
  // the body twice, beside each other
  auto labels = MakeLabels(1, 2);
  for (int k = 0; k < kZ; ++k) {
    for (int j = 0; j < kY; ++j) {
      for (int i = 0; i < kX / 2; ++i) {
        const auto row = (static_cast<std::size_t>(k) * kY + j) * kX;
        labels[row + i] = labels[row + kX / 4 + i];
        labels[row + kX - 1 - i] = labels[row + i];
      }
      const auto row = (static_cast<std::size_t>(k) * kY + j) * kX;
      for (int i = kX / 2 - 2; i < kX / 2 + 2; ++i) labels[row + i] = 0;
    }
  }
  const base::Error error = Failure(Write("twins.nii", FormatNifti(labels)));
  EXPECT_EQ(error.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(error.message, HasSubstr("--largest-part"));
}

TEST_F(FromLabels, SaysWhatItLeavesOut) {
  auto labels = MakeLabels(1, 2);
  // a piece of 8 mL beside the liver
  for (int k = 5; k < 12; ++k) {
    for (int j = 5; j < 12; ++j) {
      for (int i = 60; i < 66; ++i) labels[(static_cast<std::size_t>(k) * kY + j) * kX + i] = 1;
    }
  }
  const auto report = Build(Write("pieces.nii", FormatNifti(labels)));
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ASSERT_EQ(report->notes.size(), 1u);
  EXPECT_THAT(report->notes[0], testing::AllOf(HasSubstr("2 parts"), HasSubstr("left out")));
  const auto whole = Build(Write("whole.nii", FormatNifti(MakeLabels(1, 2))));
  ASSERT_TRUE(whole.ok());
  EXPECT_TRUE(whole->notes.empty());
  // the piece does not swell the liver
  EXPECT_NEAR(report->organs[0].volume_ml, whole->organs[0].volume_ml, 0.5);

  // as large as a seventh of the liver
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 40; i < 68; ++i) labels[(static_cast<std::size_t>(k) * kY + j) * kX + i] = 1;
    }
  }
  fs::remove_all(folder_.Path() / "patient");
  EXPECT_THAT(Failure(Write("two.nii", FormatNifti(labels))).message, HasSubstr("--largest-part"));
  LabelOptions options;
  options.labels = folder_.Path() / "two.nii", options.spacing_mm = 2.0, options.takes_largest_part = true;
  const auto largest = BuildPatientFromLabels(options);
  ASSERT_TRUE(largest.ok()) << largest.error().Text();
  EXPECT_NEAR(largest->organs[0].volume_ml, whole->organs[0].volume_ml, 0.5);
}

TEST_F(FromLabels, JoinsAFolderOfMasks) {
  const fs::path masks = folder_.Path() / "segmentations";
  fs::create_directories(masks);
  auto liver = MakeLabels(1, 0), gallbladder = MakeLabels(0, 1);
  Write("segmentations/liver.nii", FormatNifti(liver));
  const base::Error missing = Failure(masks);
  EXPECT_EQ(missing.code, ErrorCode::kFileMissing);
  EXPECT_THAT(missing.message, HasSubstr("gallbladder.nii.gz"));
  Write("segmentations/gallbladder.nii", FormatNifti(gallbladder, true));
  EXPECT_EQ(Failure(masks).code, ErrorCode::kLabelsMismatch) << "one mask is mirrored";
  fs::remove(masks / "gallbladder.nii");
  fs::create_symlink(Write("elsewhere.nii", FormatNifti(gallbladder)), masks / "gallbladder.nii");
  EXPECT_EQ(Failure(masks).code, ErrorCode::kImagePathUnsafe);
  fs::remove(masks / "gallbladder.nii");
  Write("segmentations/gallbladder.nii", FormatNifti(gallbladder));
  const auto report = Build(masks);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ExpectThatBody(*report);
}

TEST_F(FromLabels, NamesTheLabelThatIsMissing) {
  const fs::path file = Write("odd.nii", FormatNifti(MakeLabels(3, 4)));
  const base::Error error = Failure(file);
  EXPECT_EQ(error.code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(error.message, HasSubstr("liver"));
  EXPECT_THAT(error.message, testing::AllOf(HasSubstr("label 3: "), HasSubstr("label 4: ")));
  EXPECT_THAT(Failure(file, 3, 8).message, HasSubstr("--gallbladder"));
  EXPECT_EQ(Failure(file, 3, 3).code, ErrorCode::kLabelsMismatch);
  EXPECT_TRUE(Build(file, 3, 4).ok());
}

TEST_F(FromLabels, RefusesDamagedFiles) {
  EXPECT_EQ(Failure(folder_.Path() / "nowhere.nii").code, ErrorCode::kFileMissing);
  EXPECT_EQ(Failure(Write("text.nii", "not an image")).code, ErrorCode::kImageUndecodable);
  const std::string whole = FormatNifti(MakeLabels(5, 4));
  for (const std::size_t length : {100u, 348u, 352u, 5000u, 100'000u}) {
    const bool has_magic = length >= 348;
    EXPECT_EQ(Failure(Write("cut.nii", whole.substr(0, length))).code,
              has_magic ? ErrorCode::kImageTruncated : ErrorCode::kImageUndecodable)
        << length;
  }
  // a header that promises more than is there
  std::string lying = whole;
  Put<std::int16_t>(lying, 46, 30'000);
  EXPECT_EQ(Failure(Write("lying.nii", lying)).code, ErrorCode::kImageTooLarge);
  const std::string nrrd = FormatNrrd(MakeLabels(7, 9), 7, 9);
  EXPECT_EQ(Failure(Write("cut.nrrd", nrrd.substr(0, 2000))).code, ErrorCode::kImageTruncated);
}

TEST(FromLabelsSlow, RebuildsTheReferenceOfTheVisibleHuman) {
  const fs::path labels = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male/reference/labels.nii.gz";
  if (!fs::exists(labels)) GTEST_SKIP() << labels.parent_path() << " is not there";
  LabelOptions options;
  options.labels = labels;
  const auto report = BuildPatientFromLabels(options);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  EXPECT_NEAR(report->organs[0].volume_ml, 1766, 0.03 * 1766);
  EXPECT_NEAR(report->organs[1].volume_ml, 28.6, 0.08 * 28.6);
  for (const contours::OrganReport& organ : report->organs) {
    EXPECT_TRUE(organ.closed && organ.manifold && organ.outward) << organ.name;
    EXPECT_EQ(organ.self_intersections, 0u) << organ.name;
    EXPECT_GT(organ.min_angle_deg, 5.0) << organ.name;
    EXPECT_LT(std::fabs(organ.volume_change), 0.005) << organ.name;
    EXPECT_LT(organ.mean_distance_mm, 0.3) << organ.name;
  }
  EXPECT_TRUE(patient::CheckPatient(report->patient).ok());
}

}  // namespace
}  // namespace trocar::anatomy
