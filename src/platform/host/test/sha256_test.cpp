// SPDX-License-Identifier: Apache-2.0
#include "trocar/host/sha256.h"

#include <gtest/gtest.h>

#include <string>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::host {
namespace {

// FIPS 180-4, and NIST's examples
TEST(Sha256, HasThePublishedDigitsOfTextsAndFiles) {
  EXPECT_EQ(CalcSha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(CalcSha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const std::string million(1'000'000, 'a');
  constexpr const char* kMillion = "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";
  EXPECT_EQ(CalcSha256(million), kMillion);
  test::TemporaryFolder folder;
  ASSERT_TRUE(WriteFile(folder.Path() / "million", million).ok());
  EXPECT_EQ(*CalcSha256OfFile(folder.Path() / "million"), kMillion);
}

TEST(Sha256, OfAFileLongerThanOnePieceIsThatOfItsText) {
  std::string text(3 * (1u << 20) + 17, '\0');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 31 + i / 257);
  test::TemporaryFolder folder;
  ASSERT_TRUE(WriteFile(folder.Path() / "long", text).ok());
  EXPECT_EQ(*CalcSha256OfFile(folder.Path() / "long"), CalcSha256(text));
}

TEST(Sha256, SaysThatAFileIsMissingOrNone) {
  test::TemporaryFolder folder;
  EXPECT_EQ(CalcSha256OfFile(folder.Path() / "none").error().code, base::ErrorCode::kFileMissing);
  EXPECT_FALSE(CalcSha256OfFile(folder.Path()).ok()) << "a folder";
}

}  // namespace
}  // namespace trocar::host
