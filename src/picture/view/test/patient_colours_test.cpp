// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/patient_colours.h"

#include <gtest/gtest.h>

#include <string>

#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar/view/patient_figure.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::view {
namespace {

class PatientColoursFile : public testing::Test {
 protected:
  void SetUp() override {
    auto text = host::ReadFile(std::filesystem::path(TROCAR_SOURCE_DIR) / kPatientColoursFile);
    ASSERT_TRUE(text.ok());
    text_ = *text;
  }
  /// The delivered file with one text in the place of another.
  base::Result<PatientColours> ReadWith(const std::string& what, const std::string& by) {
    std::string text = text_;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    if (at != std::string::npos) text.replace(at, what.size(), by);
    const auto path = folder_.Path() / "colours.json";
    EXPECT_TRUE(host::WriteFile(path, text).ok());
    return ReadPatientColours(path);
  }

  test::TemporaryFolder folder_;
  std::string text_;
};

// A figure that is made without a file is drawn as with the delivered one.
TEST_F(PatientColoursFile, ThatIsDeliveredHoldsTheDefaults) {
  const auto colours = ReadPatientColours(std::filesystem::path(TROCAR_SOURCE_DIR) / kPatientColoursFile);
  ASSERT_TRUE(colours.ok()) << colours.error().Text();
  EXPECT_TRUE(*colours == PatientColours{});
}

TEST_F(PatientColoursFile, ColoursTheFigure) {
  const auto colours = ReadWith("[0.66, 0.36, 0.31]", "[0.1, 0.2, 0.3]");
  ASSERT_TRUE(colours.ok()) << colours.error().Text();
  patient::Patient patient;
  patient::Organ& liver = patient.organs.emplace_back();
  liver.name = "liver";
  liver.role = roles::OrganRole::kLiver;
  liver.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  liver.mesh.triangles = {{0, 1, 2}};
  PatientFigureOptions options;
  options.colours = *colours;
  const PatientFigure figure = MakePatientFigure(patient, options);
  ASSERT_EQ(figure.surfaces.size(), 1u);
  EXPECT_EQ(figure.surfaces[0].colours.front(), (render::SrgbColour{0.1, 0.2, 0.3}));
}

TEST_F(PatientColoursFile, IsRefusedWhereItIsWrong) {
  const auto refuses = [this](const std::string& what, const std::string& by) {
    const auto read = ReadWith(what, by);
    return !read.ok() && read.error().code == base::ErrorCode::kJsonField;
  };
  EXPECT_TRUE(refuses("[0.66, 0.36, 0.31]", "[0.66, 0.36, 1.31]")) << "out of range";
  EXPECT_TRUE(refuses("[0.66, 0.36, 0.31]", "[0.66, 0.36]")) << "two of three";
  EXPECT_TRUE(refuses("\"falciform\"", "\"falsiform\"")) << "unknown";
  EXPECT_TRUE(refuses("\"version\": 1", "\"version\": 2"));
}

}  // namespace
}  // namespace trocar::view
