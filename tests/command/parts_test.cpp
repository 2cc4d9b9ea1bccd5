// SPDX-License-Identifier: Apache-2.0
// trocar starts the program that has a command: beside it, or in libexec/ of an installation; and says so where there is none.
#include <filesystem>

#include "command_fixture.h"

namespace trocar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class Parts : public Command {
 protected:
  /// The built program, alone at another place.
  std::string Install(const std::string& program, const std::string& folder) const {
    const fs::path place = Path(folder);
    fs::create_directories(place);
    const fs::path built = fs::path(TROCAR_PROGRAM).parent_path() / program;
    fs::copy_file(built, place / program);
    return place / program;
  }
};

TEST_F(Parts, OneThatIsMissingSaysHowToGetIt) {
  const std::string alone = Install("trocar", "bin");
  const auto missing = test::RunProcess({alone, "bench", "--list"});
  ExpectError(missing, "E-IO-001");
  EXPECT_THAT(missing.err, HasSubstr("trocar-research is not beside this program"));
  EXPECT_THAT(missing.err, HasSubstr("./run bench --help"));
  EXPECT_THAT(missing.err, HasSubstr("ninja command-bench"));
  // what the program has itself works, and the help names what it has not
  EXPECT_EQ(test::RunProcess({alone, "errors"}).status, 0);
  const auto help = test::RunProcess({alone, "--help"});
  EXPECT_EQ(help.out, Run({"--help"}).out);
  EXPECT_THAT(help.out, HasSubstr("bench"));
}

TEST_F(Parts, OneThatCannotStartSaysWhy) {
  const std::string trocar = Install("trocar", "bin");
  Write("bin/trocar-research", "no program");
  const auto refused = test::RunProcess({trocar, "bench", "--list"});
  ExpectError(refused, "E-IO-002");
  EXPECT_THAT(refused.err, HasSubstr("trocar-research does not start: Permission denied"));
}

// what is listed is what share/ of this installation holds, not what the source tree does
TEST_F(Parts, OfAnInstallationFindTheirData) {
  const std::string trocar = Install("trocar", "bin");
  Install("trocar-training", "libexec/trocar");
  fs::create_directories(Path("share/trocar/scenes/tasks"));
  fs::create_symlink(Source("assets"), Path("share/trocar/assets"));
  fs::create_symlink(Source("scenes/tasks/peg_transfer.json"),
                     Path("share/trocar/scenes/tasks/peg_transfer.json"));
  const auto listed = test::RunProcess({trocar, "play", "--list"});
  EXPECT_EQ(listed.status, 0) << listed.err;
  EXPECT_THAT(listed.out, HasSubstr("peg_transfer"));
  EXPECT_THAT(listed.out, Not(HasSubstr("pattern_cut")));
}

TEST_F(Parts, KeepTheirExitStatusAndTheirOutput) {
  const auto wrong = Run({"bench", "--nonsense"});
  ExpectError(wrong, "E-CLI-001", 2);
  EXPECT_THAT(wrong.err, HasSubstr("trocar bench --help"));
  EXPECT_THAT(Run({"bench", "--list"}).out, HasSubstr("tissue"));
}

}  // namespace
}  // namespace trocar
