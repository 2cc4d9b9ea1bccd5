// SPDX-License-Identifier: Apache-2.0
#include "postgres_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::store {
namespace {

using testing::HasSubstr;

constexpr const char* kNowhere = "postgresql://nobody@/none?host=/nowhere";

TEST(PostgresPart, LiesBesideTheProgramAndAnswers) {
  const auto opened = OpenPostgres(kNowhere, 1, 1);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().code, base::ErrorCode::kStoreAway) << opened.error().Text();
}

TEST(PostgresPart, ThatIsMissingSaysHowToGetIt) {
  const auto opened = OpenPostgresBy("/nowhere/trocar-postgres.so", kNowhere, 1, 1);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().code, base::ErrorCode::kFileMissing);
  EXPECT_THAT(opened.error().message, HasSubstr("ninja trocar-postgres"));
}

TEST(PostgresPart, ThatIsNoneIsRefused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(host::WriteFile(folder.Path() / "part.so", "no library").ok());
  const auto opened = OpenPostgresBy(folder.Path() / "part.so", kNowhere, 1, 1);
  ASSERT_FALSE(opened.ok());
  EXPECT_EQ(opened.error().code, base::ErrorCode::kFileUnreadable);
}

}  // namespace
}  // namespace trocar::store
