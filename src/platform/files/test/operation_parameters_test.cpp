// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/operation_parameters_file.h"

#include <gtest/gtest.h>

#include <string>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::files {
namespace {

class OperationParametersFile : public testing::Test {
 protected:
  void SetUp() override {
    auto text = host::ReadFile(std::filesystem::path(TROCAR_SOURCE_DIR) / kOperationParametersFile);
    ASSERT_TRUE(text.ok());
    text_ = *text;
  }
  /// The delivered file with one text in the place of another.
  base::Result<scene::OperationParameters> ReadWith(const std::string& what, const std::string& by) {
    std::string text = text_;
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    if (at != std::string::npos) text.replace(at, what.size(), by);
    const auto path = folder_.Path() / "parameters.json";
    EXPECT_TRUE(host::WriteFile(path, text).ok());
    return ReadOperationParameters(path);
  }

  test::TemporaryFolder folder_;
  std::string text_;
};

// Code that makes its operation without a file, as tests do, has the delivered one.
TEST_F(OperationParametersFile, ThatIsDeliveredHoldsTheDefaults) {
  const auto read =
      ReadOperationParameters(std::filesystem::path(TROCAR_SOURCE_DIR) / kOperationParametersFile);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_TRUE(*read == scene::OperationParameters{});
}

TEST_F(OperationParametersFile, ChangesWhatItSays) {
  const auto read = ReadWith("\"pull_n\": 4.4", "\"pull_n\": 3.5");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  scene::OperationParameters wanted;
  wanted.vessels.clips.pull = 3.5;
  EXPECT_TRUE(*read == wanted);
}

TEST_F(OperationParametersFile, IsRefusedWhereItIsWrong) {
  const auto refuses = [this](const std::string& what, const std::string& by) {
    const auto read = ReadWith(what, by);
    return !read.ok() && read.error().code == base::ErrorCode::kJsonField;
  };
  EXPECT_TRUE(refuses("\"lumen_share\": 0.7", "\"lumen_share\": 1.2")) << "out of range";
  EXPECT_TRUE(refuses("\"clot_s\": 87", "\"clot_s\": 0")) << "no time to clot";
  EXPECT_TRUE(refuses("\"clot_s\": 87", "\"clot_s\": 87, \"clots\": 1")) << "unknown";
  EXPECT_TRUE(refuses("\"least_filling\": 0.1,", "")) << "missing";
  EXPECT_TRUE(refuses("\"version\": 1", "\"version\": 2"));
}

}  // namespace
}  // namespace trocar::files
