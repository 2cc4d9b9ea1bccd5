// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/patient_desk.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <future>

#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::presenter {
namespace {

namespace fs = std::filesystem;

class Patients : public testing::Test {
 protected:
  void SetUp() override {
    ::setenv("TROCAR_CACHE_HOME", (folder_.Path() / "cache").c_str(), 1);
    desk_ = std::make_unique<PatientDesk>(Kept(), [this] { news_.set_value(); });
  }
  void TearDown() override {
    desk_.reset();
    ::unsetenv("TROCAR_CACHE_HOME");
  }
  fs::path Kept() const { return folder_.Path() / "patients"; }
  std::optional<fs::path> Wait() {
    news_.get_future().wait();
    news_ = {};
    return desk_->Finish();
  }

  test::TemporaryFolder folder_;
  std::promise<void> news_;
  std::unique_ptr<PatientDesk> desk_;
};

TEST_F(Patients, TheBuiltInOneIsThereFirstWithItsPicture) {
  desk_->List();
  EXPECT_FALSE(desk_->Look().doing.empty());
  EXPECT_FALSE(Wait().has_value());
  const PatientPage& page = desk_->Look();
  ASSERT_EQ(page.patients.size(), 1u);
  EXPECT_TRUE(page.patients[0].folder.empty());
  EXPECT_FALSE(page.patients[0].problem) << page.patients[0].problem->Text();
  EXPECT_TRUE(fs::file_size(page.patients[0].picture) > 1000) << "drawn once, and kept";
}

TEST_F(Patients, OneIsMadeFromASeedAndListed) {
  desk_->Generate(7);
  EXPECT_TRUE(desk_->Look().can_cancel);
  const auto made = Wait();
  ASSERT_TRUE(made.has_value()) << desk_->Look().problem->Text();
  EXPECT_EQ(*made, Kept() / "seed-7");
  const PatientPage& page = desk_->Look();
  ASSERT_EQ(page.patients.size(), 2u);
  EXPECT_EQ(page.patients[1].name, "generated patient 7");
  EXPECT_NE(page.patients[1].about.find("cystic duct"), std::string::npos) << page.patients[1].about;
  EXPECT_FALSE(page.patients[1].problem);
  EXPECT_NE(page.patients[1].picture, page.patients[0].picture);
  // again: it is there
  const auto written = fs::last_write_time(*made / "patient.json");
  desk_->Generate(7);
  EXPECT_EQ(Wait(), made);
  EXPECT_EQ(fs::last_write_time(*made / "patient.json"), written);
}

TEST_F(Patients, WhatIsGivenUpLeavesNothing) {
  desk_->Generate(8);
  desk_->Cancel();
  EXPECT_EQ(desk_->Look().doing, "Giving it up");
  EXPECT_FALSE(Wait().has_value());
  EXPECT_FALSE(desk_->Look().problem) << "nobody made a mistake";
  EXPECT_EQ(desk_->Look().patients.size(), 1u);
  EXPECT_TRUE(!fs::exists(Kept()) || fs::is_empty(Kept()));
}

TEST_F(Patients, ALabelMapThatIsNoneSaysSo) {
  const fs::path file = folder_.Path() / "Case 3 (CT).nii";
  ASSERT_TRUE(host::WriteFile(file, "no image").ok());
  desk_->Import(file);
  EXPECT_FALSE(Wait().has_value());
  ASSERT_TRUE(desk_->Look().problem.has_value());
  EXPECT_FALSE(desk_->Look().problem->message.empty());
  EXPECT_TRUE(fs::is_empty(Kept()));
}

TEST_F(Patients, AnImportIsNeverTakenForAPatientOfTheSameName) {
  ASSERT_TRUE(host::WriteFile(Kept() / "segmentation" / "patient.json", "{}").ok());
  const fs::path file = folder_.Path() / "segmentation.nii";
  ASSERT_TRUE(host::WriteFile(file, "no image").ok());
  desk_->Import(file);
  EXPECT_FALSE(Wait().has_value()) << "that would be another person";
  EXPECT_TRUE(desk_->Look().problem.has_value()) << "the map was read";
}

TEST_F(Patients, ABrokenOneIsListedWithItsProblem) {
  ASSERT_TRUE(host::WriteFile(Kept() / "broken" / "patient.json", "{").ok());
  desk_->Choose(folder_.Path() / "gone");
  desk_->List();
  Wait();
  const PatientPage& page = desk_->Look();
  ASSERT_EQ(page.patients.size(), 3u);
  EXPECT_EQ(page.patients[1].name, "broken");
  ASSERT_TRUE(page.patients[1].problem.has_value());
  EXPECT_EQ(page.patients[1].problem->code, base::ErrorCode::kJsonSyntax);
  ASSERT_TRUE(page.patients[2].problem.has_value()) << "one that was chosen and has vanished";
  EXPECT_EQ(page.patients[2].problem->code, base::ErrorCode::kFileMissing);
}

}  // namespace
}  // namespace trocar::presenter
