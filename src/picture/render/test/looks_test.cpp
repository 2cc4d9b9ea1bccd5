// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/looks.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::render {
namespace {

class LooksFile : public testing::Test {
 protected:
  void SetUp() override {
    auto text = host::ReadFile(std::filesystem::path(TROCAR_SOURCE_DIR) / kLooksFile);
    ASSERT_TRUE(text.ok());
    text_ = *text;
  }
  /// The delivered file with one text in the place of another.
  base::Result<Looks> ReadWith(const std::string& what, const std::string& by) {
    std::string text = text_;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    if (at != std::string::npos) text.replace(at, what.size(), by);
    const auto path = folder_.Path() / "looks.json";
    EXPECT_TRUE(host::WriteFile(path, text).ok());
    return ReadLooks(path);
  }
  void ExpectRefused(const std::string& what, const std::string& by, base::ErrorCode code) {
    const auto looks = ReadWith(what, by);
    ASSERT_FALSE(looks.ok()) << by;
    EXPECT_EQ(looks.error().code, code) << looks.error().Text();
  }

  test::TemporaryFolder folder_;
  std::string text_;
};

TEST_F(LooksFile, ThatIsDeliveredGivesEveryMaterialItsLook) {
  const auto looks = ReadLooks(std::filesystem::path(TROCAR_SOURCE_DIR) / kLooksFile);
  ASSERT_TRUE(looks.ok()) << looks.error().Text();
  // sRGB 84 of 255 is a linear reflectance of 0.0887
  EXPECT_NEAR((*looks)[Material::kLiver].low[0], 0.0887, 1e-4);
  EXPECT_EQ((*looks)[Material::kLiver].cell_amount, 0.26f);
  EXPECT_FALSE((*looks)[Material::kSteel].is_tissue);
  EXPECT_EQ((*looks)[Material::kSteel].opacity, 1.0f);
  EXPECT_EQ(looks->light_offset, (math::Vec3{0, 0.0035, 0.001}));
  EXPECT_EQ(looks->trainer_light, 1.2);
  EXPECT_EQ(looks->trainer_lid, 0.55);
  EXPECT_EQ(looks->effects[static_cast<std::size_t>(Effect::kBloodFilm)],
            (std::array<double, 3>{0.17, 0.005, 0.006}));
}

TEST_F(LooksFile, ChangesTheLook) {
  const auto looks = ReadWith("\"cell_amount\": 0.26", "\"cell_amount\": 0.5");
  ASSERT_TRUE(looks.ok()) << looks.error().Text();
  EXPECT_EQ((*looks)[Material::kLiver].cell_amount, 0.5f);
}

TEST_F(LooksFile, IsRefusedWhereItIsWrong) {
  using enum base::ErrorCode;
  ExpectRefused("\"cell_amount\": 0.26", "\"cell_amount\": 1.5", kJsonField);
  ExpectRefused("\"cell_amount\": 0.26", "\"cel_amount\": 0.26", kJsonField);
  ExpectRefused("[84, 28, 22]", "[84, 28, 256]", kJsonField);
  ExpectRefused("[84, 28, 22]", "[84, 28]", kJsonField);
  ExpectRefused("\"liver\": {", "\"lever\": {", kJsonField);
  ExpectRefused("trocar-looks", "trocar-look", kJsonField);
  ExpectRefused("\"rinse\": 0.1", "\"rinse\": 0", kJsonField);
  ExpectRefused("\"trainer_light\": 1.2", "\"trainer_light\": -1", kJsonField);
  ExpectRefused("\"smoke\": [0.66", "\"smoke\": [1.66", kJsonField);
  ExpectRefused("\"smoke\": [", "\"smokes\": [", kJsonField);
  ExpectRefused("{", "", kJsonSyntax);
  EXPECT_EQ(ReadLooks(folder_.Path() / "none.json").error().code, kFileMissing);
}

}  // namespace
}  // namespace trocar::render
