// SPDX-License-Identifier: Apache-2.0
/// \file gpu_test.cpp  The command on computers without a GPU, with one, and with one that fails. The GPU is
/// the stand-in driver of src/platform/tissue_cuda/test.
#include <nlohmann/json.hpp>

#include "command_fixture.h"

namespace trocar {
namespace {

using testing::HasSubstr;
using testing::Not;

class GpuCommand : public Command {
 protected:
  static test::ProcessResult RunWithGpu(std::vector<std::string> arguments, const std::string& plan = "") {
    return Run(std::move(arguments),
               {"LD_LIBRARY_PATH=" TROCAR_STAND_IN_FOLDER, "TROCAR_STAND_IN_CUDA=" + plan});
  }
  static std::vector<std::string> Simulate(int ticks) {
    return {"simulate", Source("scenes/demonstration.json"), "--ticks", std::to_string(ticks), "--gpu",
            "--json"};
  }
  static std::string GpuState(const test::ProcessResult& doctor) {
    const auto json = nlohmann::json::parse(doctor.out);
    for (const auto& check : json.at("checks")) {
      if (check.at("name") == "gpu")
        return check.at("state").get<std::string>() + " " + check.at("found").get<std::string>();
    }
    return "";
  }
};

TEST_F(GpuCommand, SaysInOneLineWhyThereIsNoGpuAndGoesOn) {
  const auto with = RunWithGpu(Simulate(3), "init=100");
  EXPECT_EQ(with.status, 0) << with.err;
  EXPECT_THAT(with.err, HasSubstr("E-GPU-001"));
  EXPECT_EQ(with.err.find("E-GPU-001"), with.err.rfind("E-GPU-001")) << "one line";
  const auto report = nlohmann::json::parse(with.out);
  EXPECT_THAT(report.at("gpu"), HasSubstr("E-GPU-001"));
  // the processor's own bits
  auto without = Simulate(3);
  without.erase(without.end() - 2);
  EXPECT_EQ(report.at("hash"), nlohmann::json::parse(Run(without).out).at("hash"));
}

TEST_F(GpuCommand, SolvesOnTheGpuAndFallsBackInTheTickInWhichItFails) {
#if !TROCAR_HAS_GPU_CODE
  GTEST_SKIP() << "this build has no GPU code: nvcc was not found";
#endif
  const auto solved = RunWithGpu(Simulate(3));
  ASSERT_EQ(solved.status, 0) << solved.err;
  EXPECT_THAT(solved.err, Not(HasSubstr("E-GPU")));
  const auto report = nlohmann::json::parse(solved.out);
  EXPECT_EQ(report.at("gpu"), "Stand-in");
  EXPECT_LT(report.at("residual"), 1.0);

  const auto failing = RunWithGpu(Simulate(3), "fail=cuLaunchCooperativeKernel:12:700");
  ASSERT_EQ(failing.status, 0) << failing.err;
  EXPECT_THAT(failing.err,
              HasSubstr("E-GPU-003 starting a kernel: the NVIDIA driver answers CUDA_ERROR_ILLEGAL_ADDRESS"));
  EXPECT_EQ(failing.err.find("E-GPU-003"), failing.err.rfind("E-GPU-003")) << "one line";
  EXPECT_EQ(nlohmann::json::parse(failing.out).at("ticks"), 3);
}

TEST_F(GpuCommand, DoctorDescribesTheGpu) {
#if TROCAR_HAS_GPU_CODE
  EXPECT_THAT(GpuState(RunWithGpu({"doctor", "--json"})), HasSubstr("good Stand-in, compute capability 9.0"));
#endif
  EXPECT_THAT(GpuState(RunWithGpu({"doctor", "--json"}, "devices=0")), HasSubstr("good E-GPU-001"));
  EXPECT_THAT(GpuState(RunWithGpu({"doctor", "--json"}, "init=999")), HasSubstr("limited E-GPU-003"));
  EXPECT_THAT(GpuState(RunWithGpu({"doctor", "--json"}, "capability=61")), HasSubstr("limited E-GPU-002"));
}

TEST_F(GpuCommand, BenchChecksWithoutAGpuAndSaysThatNothingWasTimed) {
  const auto result = RunWithGpu({"bench", "tissue_cuda", "--json"}, "init=100");
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_THAT(json.at("machine"), HasSubstr("no GPU: E-GPU-001"));
  EXPECT_THAT(json.at("notes").at(0), HasSubstr("nothing is timed"));
  EXPECT_FALSE(json.at("cases").empty());
  for (const auto& entry : json.at("cases")) EXPECT_THAT(entry.at("name"), testing::StartsWith("error/"));
}

}  // namespace
}  // namespace trocar
