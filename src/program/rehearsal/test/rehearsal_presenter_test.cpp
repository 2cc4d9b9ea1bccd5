// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/rehearsal_presenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

#include "trocar/anatomy/phantom.h"
#include "trocar/contours/contour_workspace.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/images/png_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/made_images.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::rehearsal {
namespace {

namespace fs = std::filesystem;
using base::ErrorCode;
using testing::HasSubstr;

/// Opens series as the window does, and remembers what it was shown.
class FakeScreen : public RehearsalScreen {
 public:
  void Show(const RehearsalPage& shown) override { page = shown; }
  void ShowSlices(const std::optional<editor::ContourOptions>& slices) override {
    asked_sizes = false;
    points.clear();
    if (!slices) return;
    contours::WorkspaceOptions options;
    options.images = slices->images;
    options.points = points = slices->points;
    options.series = slices->series;
    auto opened = contours::ContourWorkspace::Open(options);
    if (!opened.ok()) {
      asked_sizes = opened.error().code == ErrorCode::kImageSpacingUnknown;
      return;
    }
    presenter->SlicesOpened(opened->Series(), options.series);
  }
  /// The person says what pictures do not.
  void AnswerSizes(images::ImageSeriesOptions series) {
    editor::ContourOptions options;
    options.images = presenter->State().series;
    options.series = std::move(series);
    options.points = points;
    ShowSlices(options);
  }
  void ShowOverlay(std::optional<images::LabelVolume> labels) override { has_overlay = labels.has_value(); }
  base::Status SaveContours() override {
    ++saves;
    return {};
  }
  void ShowFigure(const patient::Patient& shown) override {
    triangles = shown.organs.front().mesh.triangles.size();
  }
  void ShowPorts(const patient::Patient& shown, std::optional<std::size_t> port) override {
    ports = shown.ports;
    chosen = port;
  }
  void Operate(const fs::path& patient) override { operated = patient; }

  RehearsalPresenter* presenter = nullptr;
  RehearsalPage page;
  fs::path points, operated;
  bool asked_sizes = false, has_overlay = false;
  int saves = 0;
  std::size_t triangles = 0;
  std::vector<patient::Port> ports;
  std::optional<std::size_t> chosen;
};

/// Phantom of the delivered patient, coarse: slices, labels and contours that belong together.
class RehearsalTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    phantom_ = new test::TemporaryFolder;
    const auto patient =
        files::ReadPatient(fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient");
    ASSERT_TRUE(patient.ok()) << patient.error().Text();
    anatomy::PhantomOptions options;
    options.pixel_mm = 2, options.slice_mm = 3, options.every = 4;
    const auto written = anatomy::WritePhantom(phantom_->Path() / "p", *patient, options);
    ASSERT_TRUE(written.ok()) << written.error().Text();
  }
  static void TearDownTestSuite() { delete phantom_; }

  void SetUp() override { Open(); }
  void TearDown() override { Close(); }
  void Open() {
    screen_ = FakeScreen();
    presenter_ =
        std::make_unique<RehearsalPresenter>(Kept(), Patients(), screen_, [this] { news_.set_value(); });
    screen_.presenter = presenter_.get();
    presenter_->Start();
    Settle();
  }
  /// The window closes.
  void Close() {
    if (presenter_ == nullptr) return;
    if (presenter_->IsBusy()) Settle();
    presenter_->Leave();
    presenter_.reset();
  }
  void Settle() {
    while (presenter_->IsBusy()) {
      news_.get_future().wait();
      news_ = {};
      presenter_->FinishWork();
    }
  }
  fs::path Kept() const { return folder_.Path() / "rehearsal"; }
  fs::path Patients() const { return folder_.Path() / "patients"; }
  static fs::path Slices() { return phantom_->Path() / "p" / "slices"; }
  static fs::path Labels() { return phantom_->Path() / "p" / "labels.nrrd"; }
  static images::ImageSeriesOptions Sizes() {
    images::ImageSeriesOptions series;
    series.pixel_mm = 2, series.slice_mm = 3;
    series.axes = {"left", "posterior", "inferior"};
    return series;
  }
  const RehearsalPage& Page() const { return screen_.page; }
  bool IsStepOpen(RehearsalStep step) const { return Page().steps[static_cast<std::size_t>(step)].is_open; }
  void ChooseSlices() {
    presenter_->ChooseImages(Slices());
    Settle();
    ASSERT_TRUE(screen_.asked_sizes) << "pictures say no size";
    screen_.AnswerSizes(Sizes());
    presenter_->GoOn();
    ASSERT_EQ(Page().step, RehearsalStep::kOrgans);
  }
  void ChooseMap() {
    presenter_->ChooseLabels(Labels());
    Settle();
    ASSERT_FALSE(Page().problem) << Page().problem->Text();
  }
  void BuildIt() {
    ChooseSlices();
    ChooseMap();
    presenter_->GoOn();
    Settle();
    ASSERT_TRUE(Page().is_built) << (Page().problem ? Page().problem->Text() : "");
  }

  static test::TemporaryFolder* phantom_;
  test::TemporaryFolder folder_;
  FakeScreen screen_;
  std::promise<void> news_;
  std::unique_ptr<RehearsalPresenter> presenter_;
};
test::TemporaryFolder* RehearsalTest::phantom_ = nullptr;

/// The table of states: what may be gone to after what.
TEST_F(RehearsalTest, EachStepOpensWhenTheOneBeforeIsDone) {
  const auto open = [this] {
    std::string text;
    for (const RehearsalStepPage& step : Page().steps) text += step.is_open ? '1' : '0';
    return text;
  };
  EXPECT_EQ(open(), "10000");
  EXPECT_FALSE(Page().can_go_on || Page().can_go_back);
  ChooseSlices();
  EXPECT_EQ(open(), "11000");
  EXPECT_TRUE(Page().can_go_back);
  presenter_->GoTo(RehearsalStep::kPorts);
  EXPECT_EQ(Page().step, RehearsalStep::kOrgans) << "there is no patient yet";
  ChooseMap();
  EXPECT_EQ(open(), "11100");
  EXPECT_TRUE(screen_.has_overlay);
  EXPECT_GE(Page().label_choices.size(), 2u);
  EXPECT_THAT(Page().label_choices[0].text, HasSubstr("liver"));
  presenter_->GoOn();  // builds
  EXPECT_EQ(Page().step, RehearsalStep::kPatient);
  EXPECT_FALSE(Page().doing.empty());
  EXPECT_FALSE(Page().can_go_on);
  Settle();
  EXPECT_EQ(open(), "11111");
  presenter_->GoOn();
  presenter_->GoOn();
  EXPECT_EQ(Page().step, RehearsalStep::kOperate);
  EXPECT_FALSE(Page().origin.empty());
  presenter_->GoOn();
  ASSERT_EQ(screen_.operated, Patients() / "from-images");
  EXPECT_TRUE(files::ReadPatient(screen_.operated).ok());
}

TEST_F(RehearsalTest, ThePatientIsCheckedAndSaysWhatItIsMadeOf) {
  BuildIt();
  std::string all;
  for (const RehearsalLine& line : Page().check) all += line.text + "\n";
  EXPECT_THAT(all, HasSubstr("The check finds nothing wrong"));
  EXPECT_THAT(all, HasSubstr("liver: "));
  EXPECT_THAT(all, HasSubstr("From the template, because nothing outlines them"));
  EXPECT_GT(screen_.triangles, 1000u) << "it is shown";
  all.clear();
  for (const RehearsalLine& line : Page().origin) all += line.text + "\n";
  EXPECT_THAT(all, HasSubstr("cystic duct"));
  EXPECT_THAT(all, HasSubstr("docs/measurements.md"));
  // changed since: build again
  presenter_->GoBack();
  presenter_->NameLabels(1, 2);
  Settle();
  presenter_->GoTo(RehearsalStep::kOrgans);
  EXPECT_TRUE(Page().is_stale);
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kPorts));
}

TEST_F(RehearsalTest, AFolderWithoutImagesSaysSoAndLeadsOn) {
  ASSERT_TRUE(host::WriteFile(folder_.Path() / "letters" / "a.txt", "no image").ok());
  presenter_->ChooseImages(folder_.Path() / "letters");
  Settle();
  ASSERT_TRUE(Page().problem.has_value());
  EXPECT_EQ(Page().problem->code, ErrorCode::kImageSliceMissing);
  EXPECT_THAT(Page().problem->message, HasSubstr("choose the folder"));
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kOrgans));
  presenter_->ChooseImages(Slices());
  Settle();
  EXPECT_FALSE(Page().problem) << "another choice is another try";
  EXPECT_EQ(Page().series.size(), 1u);
}

TEST_F(RehearsalTest, OfTwoDicomSeriesAMapOfTheOtherFrameIsRefused) {
  const fs::path dicom = folder_.Path() / "dicom";
  for (const int series : {1, 2}) {
    for (int i = 1; i <= 4; ++i) {
      test::DicomFields fields;
      fields.series = "1.2." + std::to_string(series);
      fields.frame = "1.3." + std::to_string(series);
      fields.instance = i;
      fields.position = "-10\\-20\\" + std::to_string(500 * series + 2 * i);
      ASSERT_TRUE(
          host::WriteFile(dicom / (std::to_string(series) + "-" + std::to_string(i)), test::MakeDicom(fields))
              .ok());
    }
  }
  presenter_->ChooseImages(dicom);
  Settle();
  ASSERT_EQ(Page().series.size(), 2u);
  EXPECT_FALSE(Page().chosen_series) << "the person chooses";
  presenter_->ChooseSeries(0);
  ASSERT_TRUE(IsStepOpen(RehearsalStep::kOrgans));
  presenter_->GoOn();
  presenter_->ChooseLabels(Labels());
  Settle();
  ASSERT_TRUE(Page().problem.has_value());
  EXPECT_EQ(Page().problem->code, ErrorCode::kLabelsMismatch);
  EXPECT_THAT(Page().problem->message, HasSubstr("mm apart"));
  EXPECT_FALSE(screen_.has_overlay);
  EXPECT_EQ(Page().source, OrganSource::kNone);
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kPatient));
}

TEST_F(RehearsalTest, AMapWithoutAGallbladderIsNamedAndAnotherLabelMayBeChosen) {
  ChooseSlices();
  auto labels = images::ReadLabelVolume(Labels());
  ASSERT_TRUE(labels.ok());
  for (std::int32_t& label : labels->labels) label = label == anatomy::kGallbladderLabel ? 9 : label;
  labels->names.clear();
  const fs::path map = folder_.Path() / "renamed.nrrd";
  ASSERT_TRUE(anatomy::WriteLabelVolume(map, *labels).ok());
  presenter_->ChooseLabels(map);
  Settle();
  ASSERT_TRUE(Page().problem.has_value());
  EXPECT_THAT(Page().problem->message, HasSubstr("gallbladder"));
  EXPECT_THAT(Page().hint, HasSubstr("Say which labels"));
  EXPECT_TRUE(screen_.has_overlay) << "it lies on these pictures";
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kPatient));
  presenter_->NameLabels(1, 9);
  Settle();
  EXPECT_FALSE(Page().problem);
  EXPECT_TRUE(IsStepOpen(RehearsalStep::kPatient));
}

TEST_F(RehearsalTest, ABuildThatIsGivenUpLeavesNothing) {
  ChooseSlices();
  ChooseMap();
  presenter_->GoOn();
  presenter_->Cancel();
  EXPECT_EQ(Page().doing, "Giving it up");
  Settle();
  EXPECT_FALSE(Page().is_built);
  EXPECT_FALSE(Page().problem) << "nobody made a mistake";
  EXPECT_FALSE(fs::exists(Kept() / "patient"));
  for (const auto& file : fs::directory_iterator(Kept()))
    EXPECT_FALSE(file.path().filename().string().starts_with("patient")) << file.path();
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kPorts));
  presenter_->Build();
  Settle();
  EXPECT_TRUE(Page().is_built);
}

TEST_F(RehearsalTest, PortsMoveWithinReachAndComeBack) {
  BuildIt();
  presenter_->GoOn();
  ASSERT_EQ(Page().ports.list.size(), 4u);
  EXPECT_FALSE(Page().ports.list[1].reason.empty());
  EXPECT_EQ(screen_.chosen, std::size_t{0});
  presenter_->ChoosePort(1);
  const std::vector<patient::Port> proposal = screen_.ports;
  presenter_->MovePort(0, -5);
  EXPECT_NEAR(screen_.ports[1].position.y, proposal[1].position.y - 0.005, 1e-9);
  EXPECT_FALSE(Page().ports.is_proposal);
  presenter_->MovePort(0, -500);
  ASSERT_TRUE(Page().problem.has_value());
  EXPECT_THAT(Page().problem->message, HasSubstr("The port stays"));
  EXPECT_NEAR(screen_.ports[1].position.y, proposal[1].position.y - 0.005, 1e-9);
  // a drag is one step
  presenter_->GrabPort(1);
  for (int i = 1; i <= 4; ++i) presenter_->DragPort(proposal[1].position + math::Vec3{-0.001 * i, -0.005, 0});
  presenter_->ReleasePort();
  EXPECT_NEAR(screen_.ports[1].position.x, proposal[1].position.x - 0.004, 1e-9);
  presenter_->TiltTable(20, 45);
  EXPECT_NEAR(Page().ports.head_up_deg, 20, 1e-9);
  EXPECT_NEAR(Page().ports.right_up_deg, 30, 1e-9) << "tables tilt no further";
  presenter_->Undo();
  presenter_->Undo();
  EXPECT_NEAR(screen_.ports[1].position.x, proposal[1].position.x, 1e-9);
  presenter_->Undo();
  EXPECT_EQ(screen_.ports, proposal);
  EXPECT_TRUE(Page().ports.is_proposal);
  EXPECT_FALSE(Page().ports.can_undo);
  presenter_->Redo();
  EXPECT_NEAR(screen_.ports[1].position.y, proposal[1].position.y - 0.005, 1e-9);
  presenter_->ResetPorts();
  EXPECT_EQ(screen_.ports, proposal);
  presenter_->Undo();
  EXPECT_NEAR(screen_.ports[1].position.y, proposal[1].position.y - 0.005, 1e-9)
      << "resetting can be taken back, too";
}

TEST_F(RehearsalTest, TheWindowMayCloseAnywhereAndGoesOnThere) {
  ChooseSlices();
  ChooseMap();
  Close();
  Open();
  EXPECT_EQ(Page().step, RehearsalStep::kOrgans);
  EXPECT_FALSE(screen_.asked_sizes) << "that was said";
  EXPECT_TRUE(screen_.has_overlay);
  EXPECT_TRUE(IsStepOpen(RehearsalStep::kPatient));
  presenter_->GoOn();
  Settle();
  presenter_->GoOn();
  presenter_->ChoosePort(2);
  presenter_->MovePort(0, 2);
  const std::vector<patient::Port> moved = screen_.ports;
  ASSERT_FALSE(Page().ports.is_proposal) << Page().problem->Text();
  Close();
  Open();
  EXPECT_EQ(Page().step, RehearsalStep::kPorts);
  ASSERT_TRUE(Page().is_built);
  ASSERT_EQ(screen_.ports.size(), moved.size());
  EXPECT_NEAR(screen_.ports[2].position.y, moved[2].position.y, 1e-9);
  EXPECT_EQ(screen_.ports[2].reason, moved[2].reason);
  EXPECT_FALSE(Page().is_stale);
  // back and forward loses nothing
  for (int i = 0; i < 3; ++i) presenter_->GoBack();
  EXPECT_EQ(Page().step, RehearsalStep::kImages);
  for (int i = 0; i < 3; ++i) presenter_->GoOn();
  EXPECT_EQ(Page().step, RehearsalStep::kPorts);
  EXPECT_NEAR(screen_.ports[2].position.y, moved[2].position.y, 1e-9);
  presenter_->GoOn();
  presenter_->GoOn();
  const auto operated = files::ReadPatient(screen_.operated);
  ASSERT_TRUE(operated.ok());
  EXPECT_NEAR(operated->PortOf(moved[2].use)->position.y, moved[2].position.y, 1e-6);
}

TEST_F(RehearsalTest, AttemptsStayThoseOfTheSamePatient) {
  BuildIt();
  presenter_->GoTo(RehearsalStep::kOperate);
  presenter_->Operate();
  presenter_->Operate();
  EXPECT_EQ(screen_.operated, Patients() / "from-images") << "nothing has changed";
  presenter_->GoTo(RehearsalStep::kPorts);
  presenter_->ChoosePort(2);
  presenter_->MovePort(0, 2);
  presenter_->Operate();
  EXPECT_EQ(screen_.operated, Patients() / "from-images-2") << "other ports make another patient";
  EXPECT_TRUE(fs::exists(Patients() / "from-images" / "patient.json"));
}

TEST_F(RehearsalTest, DrawnContoursBecomeAPatientAndStayWhereTheyWere) {
  ChooseSlices();
  presenter_->DrawContours();
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kPatient));
  EXPECT_THAT(Page().hint, HasSubstr("0 and 0"));
  // what the person draws stands in the file of these slices
  fs::copy_file(phantom_->Path() / "p" / "control_points.json", screen_.points);
  presenter_->SetContoured(9, 1);
  EXPECT_FALSE(IsStepOpen(RehearsalStep::kPatient)) << "one slice has no shape";
  presenter_->SetContoured(9, 4);
  ASSERT_TRUE(IsStepOpen(RehearsalStep::kPatient));
  presenter_->GoOn();
  EXPECT_GE(screen_.saves, 1) << "before it is built from";
  Settle();
  ASSERT_TRUE(Page().is_built) << (Page().problem ? Page().problem->Text() : "");
  EXPECT_EQ(Page().ports.list.size(), 4u);
  EXPECT_THAT(Page().ports.list[1].reason, HasSubstr("usual place"));
  std::string all;
  for (const RehearsalLine& line : Page().check) all += line.text + "\n";
  EXPECT_THAT(all, HasSubstr("From the template, because nothing outlines them: stomach"));
  const fs::path points = screen_.points;
  presenter_->ChooseImages(Slices());
  Settle();
  EXPECT_EQ(screen_.points, points) << "the same slices have the same contours";
}

TEST_F(RehearsalTest, WhatHasVanishedIsSaidAndLeadsOn) {
  ChooseSlices();
  const fs::path gone = folder_.Path() / "gone.nrrd";
  fs::copy_file(Labels(), gone);
  presenter_->ChooseLabels(gone);
  Settle();
  Close();
  fs::remove(gone);
  Open();
  EXPECT_EQ(Page().step, RehearsalStep::kOrgans);
  ASSERT_TRUE(Page().problem.has_value());
  EXPECT_EQ(Page().source, OrganSource::kNone);
  ChooseMap();
  EXPECT_TRUE(IsStepOpen(RehearsalStep::kPatient));
}

TEST_F(RehearsalTest, ASecondWindowLeavesItToTheFirst) {
  FakeScreen other;
  RehearsalPresenter second(Kept(), Patients(), other, [] {});
  other.presenter = &second;
  second.Start();
  ASSERT_TRUE(other.page.problem.has_value());
  EXPECT_EQ(other.page.problem->code, ErrorCode::kFileInUse);
  second.ChooseImages(Slices());
  EXPECT_FALSE(second.IsBusy());
}

// it holds the path of the images, and a folder is often called after a person
TEST_F(RehearsalTest, NobodyElseMayReadWhereTheImagesLie) {
  fs::permissions(Kept(), fs::perms::owner_all | fs::perms::group_read | fs::perms::others_read);
  ChooseSlices();
  const auto modes = [](const fs::path& path) { return fs::status(path).permissions() & fs::perms::all; };
  ASSERT_TRUE(fs::exists(Kept() / "rehearsal.json"));
  EXPECT_EQ(modes(Kept() / "rehearsal.json"), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(modes(Kept()), fs::perms::owner_all);
}

TEST_F(RehearsalTest, ABrokenFileOfItsStateIsPutAside) {
  Close();
  ASSERT_TRUE(host::WriteFile(Kept() / "rehearsal.json", "{").ok());
  Open();
  ASSERT_TRUE(Page().problem.has_value());
  EXPECT_TRUE(fs::exists(Kept() / "rehearsal.json.unreadable"));
  ChooseSlices();
}

}  // namespace
}  // namespace trocar::rehearsal
