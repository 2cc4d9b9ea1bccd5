// SPDX-License-Identifier: Apache-2.0
#include "label_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

using base::ErrorCode;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

class LabelNames : public testing::Test {
 protected:
  auto Read(const std::string& content) {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / "table", content).ok());
    return ReadLabelNames(folder_.Path() / "table");
  }
  void ExpectOrgans(const std::string& content) {
    const auto names = Read(content);
    ASSERT_TRUE(names.ok()) << names.error().Text();
    EXPECT_THAT(names->names,
                UnorderedElementsAre(testing::Pair("liver", 17), testing::Pair("gall bladder", 300)))
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
  EXPECT_THAT(slicer->names,
              UnorderedElementsAre(testing::Pair("liver", 17), testing::Pair("gall_bladder", 300)));
}

TEST_F(LabelNames, BringTheCodesOfDcmqi) {
  const auto table = Read(R"({"segmentAttributes": [[
    {"labelID": 17, "SegmentLabel": "A", "SegmentedPropertyTypeCodeSequence":
      {"CodeValue": "10200004", "CodingSchemeDesignator": "SCT", "CodeMeaning": "Liver"}},
    {"labelID": 18, "SegmentLabel": "B", "SegmentedPropertyTypeCodeSequence":
      {"CodeValue": "T-71000", "CodingSchemeDesignator": "SRT", "CodeMeaning": "Kidney"},
      "SegmentedPropertyTypeModifierCodeSequence": {"CodeValue": "G-A100", "CodingSchemeDesignator": "SRT"}},
    {"labelID": 19, "SegmentLabel": "C", "SegmentedPropertyTypeCodeSequence":
      {"CodeValue": "108369006", "CodingSchemeDesignator": "SCT"},
      "AnatomicRegionSequence": {"CodeValue": "10200004", "CodingSchemeDesignator": "SCT"}},
    {"labelID": 20, "SegmentLabel": "D", "SegmentedPropertyTypeCodeSequence":
      {"CodeValue": "7197", "CodingSchemeDesignator": "FMA"}},
    {"labelID": 21, "SegmentLabel": "E", "SegmentedPropertyTypeCodeSequence": "liver"}]]})");
  ASSERT_TRUE(table.ok()) << table.error().Text();
  EXPECT_EQ(table->names.size(), 5u);
  EXPECT_THAT(table->codes,
              UnorderedElementsAre(testing::Pair("10200004", 17), testing::Pair("T-71000 G-A100", 18),
                                   testing::Pair("108369006 @10200004", 19)));
}

TEST_F(LabelNames, AreReadAsTheTradeWritesThem) {
  const std::string snap = "17 liver\n300 gall bladder\n";
  ExpectOrgans("\xef\xbb\xbf" + snap);
  ExpectOrgans("17 liver\r300 gall bladder\r");
  // UTF-16 of a spreadsheet
  std::string little = "\xff\xfe", big = "\xfe\xff";
  for (const char c : std::string("Label\tName\r\n17\tliver\r\n300\tgall bladder\r\n"))
    (little += c) += '\0', (big += '\0') += c;
  ExpectOrgans(little), ExpectOrgans(big);
  // tables with a header
  ExpectOrgans("label,name\n0,background\n17,liver\n300,gall bladder\n");
  ExpectOrgans("Name;Color;Label Value\nliver;red;17\n\"gall bladder\";green;300\n");
  ExpectOrgans(
      "index\tname\tabbreviation\tcolor\tmapping\n17\tliver\tL\t#dd8265\t1\n300\tgall "
      "bladder\tGB\t#8b9662\t2\n");
  ExpectOrgans(
      "LabelValue,Name,Color_R,Color_G,Color_B,Color_A,Category_CodeMeaning\n17,liver,221,130,101,255,"
      "\"Organ, solid\"\n"
      "300,\"gall bladder\",139,150,98,255,Organ\n");
  ExpectOrgans("\"structure\",\"value\"\n\"liver\",17.0\n\"gall bladder\",300.0\n");
  ExpectOrgans("# BIDS\n\nid,label\n17,liver\n300,gall bladder\n");
  // lines without one
  ExpectOrgans("17,liver\n300,gall bladder\n");
  ExpectOrgans("17: liver\n300: gall bladder\n");
  ExpectOrgans("class_map:\n  17: liver\n  300: \"gall bladder\"\n");
  ExpectOrgans("liver = 17\ngall bladder = 300\n");
  ExpectOrgans("liver: 17\ngall bladder: 300\n");
  ExpectOrgans("    17: \"liver\",\n    300: \"gall bladder\",\n");
  ExpectOrgans("17 liver 221 130 101 255\n300 gall bladder 139 150 98 255\n");
  // JSON
  ExpectOrgans("\xef\xbb\xbf{\"17\": \"liver\", \"300\": \"gall bladder\"}");
  ExpectOrgans(
      R"({"0": {"name": "background"}, "17": {"name": "liver", "parent": "organ"}, "300": {"name": "gall bladder"}})");
  ExpectOrgans(R"([{"label": 17, "name": "liver"}, {"label": 300, "name": "gall bladder"}])");
  ExpectOrgans(R"({"labels": [{"id": "17", "name": "liver"}, {"id": "300", "name": "gall bladder"}]})");
  ExpectOrgans(R"({"liver": "17", "gall bladder": 300.0})");
  ExpectOrgans(R"({"segmentAttributes": [[{"labelID": 17, "SegmentDescription": "liver"},
                   {"labelID": 300, "SegmentedPropertyTypeCodeSequence": {"CodeMeaning": "gall bladder"}}]]})");
}

TEST_F(LabelNames, OfRegionsAreTheSmallestFirst) {
  const auto names =
      Read(R"({"channel_names": {"0": "CT"}, "labels": {"background": 0, "liver": [17, 18], "tumor": 18,
                              "gall bladder": 300}, "regions_class_order": [17, 18, 300]})");
  ASSERT_TRUE(names.ok()) << names.error().Text();
  EXPECT_THAT(names->names,
              testing::UnorderedElementsAre(testing::Pair("tumor", 18), testing::Pair("liver", 17),
                                            testing::Pair("liver", 18), testing::Pair("gall bladder", 300)));
  const auto at = [&](const char* name) {
    return std::find(names->names.begin(), names->names.end(), std::pair<std::string, int>(name, 18)) -
           names->names.begin();
  };
  EXPECT_LT(at("tumor"), at("liver"));
  ExpectRefused(R"({"labels": {"a": [1, 2], "b": [2, 3]}})", ErrorCode::kLabelsMismatch,
                "label 2 has two names, a and b");
  ExpectRefused(R"({"labels": {"liver": []}})", ErrorCode::kJsonField, "labels.liver");
  ExpectRefused(R"({"labels": {"liver": [1, "x"]}})", ErrorCode::kJsonField, "labels.liver");
}

TEST_F(LabelNames, WhatIsNoTableIsCalledByItsName) {
  ExpectRefused(std::string("PK\x03\x04", 4) + std::string(60, '\0'), ErrorCode::kLabelsMismatch,
                "save the table as CSV");
  ExpectRefused("\x1f\x8b\x08", ErrorCode::kLabelsMismatch, "compressed");
  ExpectRefused("NRRD0004\ntype: uchar\n", ErrorCode::kLabelsMismatch, "it is an image");
  ExpectRefused("<?xml version=\"1.0\"?><LabelTable/>", ErrorCode::kLabelsMismatch, "XML");
  ExpectRefused(std::string("5 liver\0", 8), ErrorCode::kLabelsMismatch, "no text");
  ExpectRefused(
      "\xff\xfe"
      "5",
      ErrorCode::kLabelsMismatch, "UTF-16");
  ExpectRefused("Structure,SegmentedPropertyCategory\nliver,Anatomical\n", ErrorCode::kLabelsMismatch,
                "column of labels");
  ExpectRefused("label,name\n5\n", ErrorCode::kLabelsMismatch, "fewer columns");
  ExpectRefused("label,name\nfive,liver\n", ErrorCode::kLabelsMismatch, "line 2 (five,liver)");
  ExpectRefused("Segment 5\nSegment 6 7\n", ErrorCode::kLabelsMismatch, "line 2");
  ExpectRefused(R"([{"label": 5}])", ErrorCode::kJsonField, "a name");
  ExpectRefused(R"([{"label": 5, "name": "a"}, {"label": 5, "name": "b"}])", ErrorCode::kLabelsMismatch,
                "two names");
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
