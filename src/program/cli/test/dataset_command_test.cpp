// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>

#include "run_trocar.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;

class DatasetCommandTest : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
};

TEST_F(DatasetCommandTest, MakesASetThatItsReaderAccepts) {
  const std::string set = (folder_.Path() / "set").string();
  const Printed made = RunTrocar({"dataset", "--layout", "trocar", "--task", "peg_transfer", "--seeds", "3:4",
                                  "--size", "64x48", "--every", "0.5", "--most-seconds", "1", "-o", set});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_NE(made.out.find("2 videos, 6 labelled frames"), std::string::npos) << made.out;
  EXPECT_EQ(RunTrocar({"dataset", "verify", set}).status, 0);
  // a second one does not go into the same folder
  const Printed again = RunTrocar({"dataset", "--layout", "trocar", "--task", "peg_transfer", "-o", set});
  EXPECT_EQ(again.status, 1);
  EXPECT_NE(again.err.find("E-IO-003"), std::string::npos) << again.err;
  fs::remove(folder_.Path() / "set" / "video_00004.h5");
  const Printed damaged = RunTrocar({"dataset", "verify", set});
  EXPECT_EQ(damaged.status, 1);
  EXPECT_NE(damaged.err.find("E-DAT-001"), std::string::npos) << damaged.err;
}

TEST_F(DatasetCommandTest, RefusesWhatItDoesNotKnow) {
  const std::string set = (folder_.Path() / "set").string();
  EXPECT_NE(RunTrocar({"dataset", "--layout", "movies", "-o", set}).err.find("E-SCN-003"), std::string::npos);
  for (const char* seeds : {"1:", "a", "2:1", "1:2:3", "-1"}) {
    const Printed refused = RunTrocar({"dataset", "--layout", "cholec80", "--seeds", seeds, "-o", set});
    EXPECT_EQ(refused.status, 2) << seeds;
  }
  EXPECT_EQ(RunTrocar({"dataset"}).status, 2);
  EXPECT_TRUE(fs::is_empty(folder_.Path()));
}

}  // namespace
}  // namespace trocar::cli
