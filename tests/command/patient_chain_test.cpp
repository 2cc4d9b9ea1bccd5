// SPDX-License-Identifier: Apache-2.0
// Somebody's label map becomes a patient that the check passes and that can be operated on.
#include "command_fixture.h"

namespace trocar {
namespace {

using PatientChain = Command;

TEST_F(PatientChain, ALabelMapIsOperatedOn) {
  const auto phantom =
      Run({"anatomy", "phantom", "--seed", "7", "--pixel-mm", "2", "--slice-mm", "3", "-o", Path("phantom")});
  ASSERT_EQ(phantom.status, 0) << phantom.err;
  const auto made = Run({"anatomy", "from-labels", Path("phantom/labels.nrrd"), "-o", Path("patient")});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto check = Run({"anatomy", "check", Path("patient")});
  EXPECT_EQ(check.status, 0) << check.out;
  const auto operated = Run({"simulate", Source("scenes/cholecystectomy.json"), "--patient", Path("patient"),
                             "--ticks", "3", "--json"});
  EXPECT_EQ(operated.status, 0) << operated.err;
  EXPECT_THAT(operated.out, testing::HasSubstr("\"hash\""));
}

}  // namespace
}  // namespace trocar
