// SPDX-License-Identifier: Apache-2.0
// Ended from outside, or denied what it needs: a code where there is somebody to tell, and nothing half-written.
#include <chrono>
#include <csignal>
#include <thread>

#include "command_fixture.h"

namespace trocar {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class EndedEarly : public Command {
 protected:
  /// Work of several seconds that writes a folder.
  std::vector<std::string> MakePhantom() const {
    return {"anatomy", "phantom", "--seed", "7", "--every", "2", "-o", Path("out/phantom")};
  }
  /// By a shell that sets a limit first.
  test::ProcessResult RunLimited(const std::string& limit, const std::vector<std::string>& arguments) const {
    std::string line = "ulimit " + limit + "; exec '" + TROCAR_PROGRAM + "'";
    for (const std::string& argument : arguments) line += " '" + argument + "'";
    return test::RunProcess({"/bin/bash", "-c", line}, {});
  }
  bool HasPart() const {
    for (const std::string& name : List()) {
      if (name.find(".part") != std::string::npos) return true;
    }
    return false;
  }
};

TEST_F(EndedEarly, ASignalLeavesNothingHalfWritten) {
  for (const int signal : {SIGTERM, SIGINT}) {
    std::vector<std::string> words = MakePhantom();
    words.insert(words.begin(), TROCAR_PROGRAM);
    test::Process process(words);
    bool was_seen = false;
    for (int i = 0; i < 12'000 && !was_seen && !process.HasEnded(); ++i) {
      was_seen = HasPart();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ASSERT_TRUE(was_seen) << "the control: it writes beside its target";
    process.Signal(signal);
    process.Wait();
    EXPECT_EQ(process.Status(), 128 + signal);
    EXPECT_FALSE(HasPart()) << testing::PrintToString(List());
    EXPECT_FALSE(std::filesystem::exists(Path("out/phantom")));
  }
}

TEST_F(EndedEarly, AFileThatMayNotGrowIsAnErrorWithACode) {
  const test::ProcessResult result = RunLimited("-f 20", MakePhantom());  // blocks of 1,024 bytes
  EXPECT_EQ(result.status, 1) << result.status;
  EXPECT_THAT(result.err, HasSubstr("trocar: E-IO-003 "));
  EXPECT_THAT(List(), testing::Each(testing::Not(HasSubstr("phantom"))));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they reserve terabytes
TEST_F(EndedEarly, RefusedMemoryIsAnErrorWithACodeAndARemedy) {
  const std::vector<std::string> work = {"simulate", Source("scenes/retraction.json"), "--ticks", "1"};
  int refused = 0;
  // from too little to load the program to nearly enough [KiB]
  for (int limit = 30'000; limit <= 120'000; limit += 5'000) {
    const test::ProcessResult result = RunLimited("-v " + std::to_string(limit), work);
    constexpr int kLoaderRefused = 127;
    if (result.status == 0 || result.status == kLoaderRefused) continue;
    // at the next limit after the loader's, what libraries make before main() may be refused, which nothing can catch
    if (refused == 0 && result.err.starts_with("terminate called")) continue;
    EXPECT_THAT(result.err, HasSubstr("trocar: E-SIM-005 ")) << limit << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr("ulimit -v"));
    EXPECT_EQ(result.status, 1);
    ++refused;
  }
  EXPECT_GT(refused, 0) << "at least one of the limits lets the program begin, and not end";
}
#endif

// pictures and video appear under their name when all went well, and not before
TEST_F(EndedEarly, PlayWritesBesideItsFolder) {
  const std::vector<std::string> work = {"play",      "expert",   "--task", "instrument_navigation",
                                         "--seconds", "1",        "--size", "64x64",
                                         "-o",        Path("out")};
  const test::ProcessResult result = RunLimited("-f 1", work);
  if (result.err.find("E-GL-") != std::string::npos) GTEST_SKIP() << "no graphics: " << result.err;
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_THAT(List(), testing::Not(testing::Contains(HasSubstr("out/")))) << "nothing in place";
  EXPECT_FALSE(HasPart());
  const test::ProcessResult whole = Run(work);
  EXPECT_EQ(whole.status, 0) << whole.err;
  EXPECT_TRUE(std::filesystem::exists(Path("out/demo.webm")));
  EXPECT_FALSE(HasPart());
}

}  // namespace
}  // namespace trocar
