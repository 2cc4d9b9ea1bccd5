// SPDX-License-Identifier: Apache-2.0
#include "trocar/doctor/doctor_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::doctor {
namespace {

using testing::HasSubstr;

/// A folder that stands for "/", with devices in it.
class Devices : public testing::Test {
 protected:
  void AddInput(const std::string& event, const std::string& name, const std::string& vendor,
                const std::string& product) {
    const auto device = folder_.Path() / "sys/class/input" / event / "device";
    ASSERT_TRUE(host::WriteFile(device / "name", name + "\n").ok());
    ASSERT_TRUE(host::WriteFile(device / "id/vendor", vendor + "\n").ok());
    ASSERT_TRUE(host::WriteFile(device / "id/product", product + "\n").ok());
    ASSERT_TRUE(host::WriteFile(folder_.Path() / "dev/input" / event, "").ok());
  }

  test::TemporaryFolder folder_;
};

TEST_F(Devices, AreListedByName) {
  AddInput("event0", "Power Button", "0000", "0001");
  AddInput("event3", "Some Mouse", "046d", "c077");
  const Finding finding = CheckInputDevices(folder_.Path());
  EXPECT_EQ(finding.health, Health::kGood);
  EXPECT_EQ(finding.found, "Power Button, Some Mouse");
}

TEST_F(Devices, AbsenceOfInputIsALimitWithARemedy) {
  const Finding finding = CheckInputDevices(folder_.Path());
  EXPECT_EQ(finding.health, Health::kLimited);
  EXPECT_NE(finding.remedy, "");
}

TEST_F(Devices, ThreeDMouseIsKnownByItsUsbNumbers) {
  AddInput("event1", "Plain Mouse", "046d", "c077");
  EXPECT_THAT(CheckThreeDMouse(folder_.Path()).found, HasSubstr("no 3-D mouse"));
  AddInput("event2", "SpaceMouse Compact", "256F", "C635");
  const Finding finding = CheckThreeDMouse(folder_.Path());
  EXPECT_THAT(finding.found, HasSubstr("SpaceMouse Compact"));
  // the name that --device takes, and the service that has to run
  EXPECT_THAT(finding.meaning, testing::AllOf(HasSubstr("--device spacemouse"), HasSubstr("spacenavd")));
}

TEST_F(Devices, OlderThreeDMouseHasLogitechsNumber) {
  AddInput("event2", "SpaceNavigator", "046d", "c626");
  EXPECT_THAT(CheckThreeDMouse(folder_.Path()).found, HasSubstr("SpaceNavigator"));
}

TEST_F(Devices, SerialLinesAreListed) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "dev/ttyACM0", "").ok());
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "dev/ttyS0", "").ok());
  const Finding finding = CheckSerialDevices(folder_.Path());
  EXPECT_EQ(finding.found, "/dev/ttyACM0");
  EXPECT_THAT(finding.meaning, HasSubstr("trocar devices test"));
}

/// Sets environment variables for one test.
class Environment : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR"}) ::unsetenv(name);
  }
};

TEST_F(Environment, NoDisplayIsALimitThatNamesHeadless) {
  const Finding finding = CheckDisplay();
  EXPECT_EQ(finding.health, Health::kLimited);
  EXPECT_THAT(finding.remedy, HasSubstr("--headless"));
}

TEST_F(Environment, DisplayWithoutAServerIsNotTakenForOne) {
  for (const char* display : {":8317", "8317", "", ":", "unix:8317.0", ":99999999999999999999"}) {
    ::setenv("DISPLAY", display, 1);
    EXPECT_EQ(CheckDisplay().health, Health::kLimited) << display;
  }
  ::setenv("WAYLAND_DISPLAY", "wayland-8317", 1);
  ::setenv("XDG_RUNTIME_DIR", "/nonexistent", 1);
  EXPECT_EQ(CheckDisplay().health, Health::kLimited);
}

TEST_F(Environment, SilenceIsALimitThatNamesWhatToConnect) {
  ::unsetenv("PULSE_SERVER");
  test::TemporaryFolder folder;
  const Finding silent = CheckSound(folder.Path(), "/usr/bin/espeak-ng");
  EXPECT_EQ(silent.health, Health::kLimited);
  EXPECT_THAT(silent.remedy, HasSubstr("sound card"));
  std::filesystem::create_directories(folder.Path() / "proc/asound");
  ASSERT_TRUE(
      host::WriteFile(folder.Path() / "proc/asound/cards", " 0 [Card           ]: HDA-Intel - A card\n")
          .ok());
  EXPECT_THAT(CheckSound(folder.Path(), "").remedy, HasSubstr("espeak-ng"));
  const Finding good = CheckSound(folder.Path(), "/usr/bin/espeak-ng");
  EXPECT_EQ(good.health, Health::kGood);
  EXPECT_THAT(good.found, HasSubstr("HDA-Intel - A card"));
}

TEST(CheckWindow, SeesWhetherTheProgramIsThere) {
  test::TemporaryFolder folder;
  EXPECT_EQ(CheckWindow(folder.Path()).health, Health::kLimited);
  ASSERT_TRUE(host::WriteFile(folder.Path() / "trocar-window", "").ok());
  std::filesystem::permissions(folder.Path() / "trocar-window", std::filesystem::perms::owner_all);
  EXPECT_EQ(CheckWindow(folder.Path()).health, Health::kGood);
}

TEST(CheckImageReader, SeesWhetherTheProgramIsThere) {
  test::TemporaryFolder folder;
  EXPECT_EQ(CheckImageReader(folder.Path()).health, Health::kMissing);
  ASSERT_TRUE(host::WriteFile(folder.Path() / "trocar-import", "").ok());
  EXPECT_EQ(CheckImageReader(folder.Path()).health, Health::kMissing) << "it cannot be run";
  std::filesystem::permissions(folder.Path() / "trocar-import", std::filesystem::perms::owner_all);
  EXPECT_EQ(CheckImageReader(folder.Path()).health, Health::kGood);
}

TEST(CheckSupervisor, SeesWhetherTheProgramIsThere) {
  test::TemporaryFolder folder;
  EXPECT_EQ(CheckSupervisor(folder.Path()).health, Health::kLimited);
  ASSERT_TRUE(host::WriteFile(folder.Path() / "trocar-supervisor", "").ok());
  std::filesystem::permissions(folder.Path() / "trocar-supervisor", std::filesystem::perms::owner_all);
  EXPECT_EQ(CheckSupervisor(folder.Path()).health, Health::kGood);
}

TEST(CheckDataFolder, FindsTheBuiltInPatientAndMissesAnEmptyFolder) {
  ::setenv("TROCAR_DATA_DIR", TROCAR_SOURCE_DIR, 1);
  const Finding whole = CheckDataFolder();
  EXPECT_EQ(whole.health, Health::kGood) << whole.found;
  EXPECT_THAT(whole.found, HasSubstr("triangles"));
  test::TemporaryFolder folder;
  ::setenv("TROCAR_DATA_DIR", folder.Path().c_str(), 1);
  const Finding empty = CheckDataFolder();
  EXPECT_EQ(empty.health, Health::kMissing) << empty.found;
  EXPECT_THAT(empty.remedy, HasSubstr("TROCAR_DATA_DIR"));
  ::unsetenv("TROCAR_DATA_DIR");
}

TEST(HealthName, CoversEveryState) {
  EXPECT_EQ(HealthName(Health::kGood), "good");
  EXPECT_EQ(HealthName(Health::kLimited), "limited");
  EXPECT_EQ(HealthName(Health::kMissing), "missing");
}

}  // namespace
}  // namespace trocar::doctor
