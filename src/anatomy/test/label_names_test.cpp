// SPDX-License-Identifier: Apache-2.0
#include "label_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "trocar/core/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

using core::ErrorCode;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class LabelNames : public testing::Test {
 protected:
  auto Read(const std::string& content) {
    EXPECT_TRUE(core::WriteFile(folder_.Path() / "table", content).ok());
    return ReadLabelNames(folder_.Path() / "table");
  }
  void ExpectOrgans(const std::string& content) {
    const auto names = Read(content);
    ASSERT_TRUE(names.ok()) << names.error().Text();
    EXPECT_THAT(*names, UnorderedElementsAre(testing::Pair("liver", 17), testing::Pair("gall bladder", 300)))
        << content;
  }
  void ExpectRefused(const std::string& content, ErrorCode code, const char* why) {
    const auto names = Read(content);
    ASSERT_FALSE(names.ok()) << content;
    EXPECT_EQ(names.error().code, code) << content;
    EXPECT_THAT(names.error().message, HasSubstr(why));
  }

  test::TemporaryFolder folder_;
};

TEST_F(LabelNames, AreReadInEveryForm) {
  ExpectOrgans(R"({"background": 0, "liver": 17, "gall bladder": 300})");
  ExpectOrgans(R"({"0": "background", "17": "liver", "300": "gall bladder"})");
  ExpectOrgans(R"({"name": "Task", "labels": {"liver": 17, "gall bladder": 300}, "numTraining": 3})");
  ExpectOrgans(
      "# ITK-SnAP Label Description File\n\n    0     0    0    0        0  0  0    \"Clear Label\"\n"
      "   17   255    0    0        1  1  1    \"liver\"\r\n  300     0  255    0        1  1  1    \"gall "
      "bladder\"\n");
  const auto slicer = Read(
      "# Color table file\n// two\n0 Background 0 0 0 0\n17 liver 221 130 101 255\n300 gall_bladder 139 150 "
      "98 255");
  ASSERT_TRUE(slicer.ok());
  EXPECT_THAT(*slicer, UnorderedElementsAre(testing::Pair("liver", 17), testing::Pair("gall_bladder", 300)));
}

TEST_F(LabelNames, WithMistakesAreRefused) {
  ExpectRefused("5 liver\nfour gallbladder\n", ErrorCode::kLabelsMismatch, "line 2");
  ExpectRefused("5\n", ErrorCode::kLabelsMismatch, "line 1");
  ExpectRefused("-5 liver\n", ErrorCode::kLabelsMismatch, "line 1");
  ExpectRefused("5 liver\n5 spleen\n", ErrorCode::kLabelsMismatch, "label 5 has two names");
  ExpectRefused("# nothing\n", ErrorCode::kLabelsMismatch, "names no label");
  ExpectRefused("", ErrorCode::kLabelsMismatch, "names no label");
  ExpectRefused(R"({"liver": 5.5})", ErrorCode::kJsonField, "liver");
  ExpectRefused(R"({"liver": 5)", ErrorCode::kJsonSyntax, "table");
  EXPECT_EQ(ReadLabelNames(folder_.Path() / "none").error().code, ErrorCode::kFileMissing);
}

}  // namespace
}  // namespace trocar::anatomy
