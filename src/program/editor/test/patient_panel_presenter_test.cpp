// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/patient_panel_presenter.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace trocar::editor {
namespace {

/// Keeps what it was given, as a panel without widgets.
struct FakePatientPanel : PatientPanelScreen {
  void Show(const PatientPanelPage& shown) override { page = shown; }
  void OnEdited() override { ++edits; }
  void OnRefused(const base::Error& error) override { refusals.push_back(error.code); }

  PatientPanelPage page;
  int edits = 0;
  std::vector<base::ErrorCode> refusals;
};

class PatientPanelTest : public testing::Test {
 protected:
  PatientPanelTest() : editor_(Open()) { presenter_.UseEditor(&editor_); }
  static anatomy::PatientDocument Open() {
    auto document = anatomy::PatientDocument::Open(std::string(TROCAR_SOURCE_DIR) +
                                                   "/assets/patients/visible-human-male/patient");
    EXPECT_TRUE(document.ok()) << document.error().Text();
    return std::move(document).value();
  }
  const PatientPanelPage& Page() {
    presenter_.Refresh();
    return screen_.page;
  }
  std::size_t FindTube(const std::string& name) {
    const auto& tubes = Page().tubes;
    return static_cast<std::size_t>(
        std::find_if(tubes.begin(), tubes.end(), [&](const auto& tube) { return tube.name == name; }) -
        tubes.begin());
  }

  PatientEditor editor_;
  FakePatientPanel screen_;
  PatientPanelPresenter presenter_{screen_};
};

TEST_F(PatientPanelTest, ShowsThePatientInWords) {
  const PatientPanelPage& page = Page();
  ASSERT_LT(page.regions.chosen, page.regions.names.size());
  EXPECT_EQ(page.regions.names[page.regions.chosen], "liver: diaphragmatic face");
  EXPECT_LT(FindTube("cystic duct"), page.tubes.size());
  EXPECT_FALSE(page.tube);
  EXPECT_EQ(page.tube_facts, "Choose a duct here or in the picture.");
  EXPECT_FALSE(page.landmarks.empty());
  EXPECT_DOUBLE_EQ(page.brush_mm, 10);
}

TEST_F(PatientPanelTest, PaintsTheRegionThatIsChosen) {
  presenter_.ChooseTool(EditorTool::kPaint);
  presenter_.ChooseRegion(1);
  presenter_.SetErasing(true);
  presenter_.SetBrush(4);
  presenter_.ChooseRegion(999);
  EXPECT_EQ(screen_.edits, 4);
  EXPECT_EQ(editor_.tool, EditorTool::kPaint);
  EXPECT_EQ(Page().regions.chosen, 1u);
  EXPECT_TRUE(Page().is_erasing);
  EXPECT_DOUBLE_EQ(editor_.brush_radius, 0.004);
}

TEST_F(PatientPanelTest, ChoosesADuctAndSaysWhereItLeads) {
  presenter_.ChooseTube(FindTube("cystic duct"));
  const PatientPanelPage& page = Page();
  ASSERT_TRUE(page.tube);
  EXPECT_NE(page.tube_facts.find(" mm long, radius "), std::string::npos);
  ASSERT_LT(page.from.chosen, page.from.names.size());
  EXPECT_EQ(page.from.names.front(), "leaves the scene");
  EXPECT_EQ(page.from.names[page.from.chosen], "gallbladder");
  EXPECT_FALSE(page.has_tube_point);
  EXPECT_EQ(std::count(page.from.names.begin(), page.from.names.end(), "cystic duct"), 0)
      << "a duct does not begin at itself";
}

TEST_F(PatientPanelTest, InsertsAndDeletesPoints) {
  presenter_.InsertPoint();
  EXPECT_EQ(screen_.refusals, std::vector{base::ErrorCode::kUsage});
  presenter_.ChooseTube(FindTube("cystic duct"));
  editor_.ChooseTubePoint(2);
  EXPECT_TRUE(Page().has_tube_point);
  const std::size_t count = editor_.GetPatient().tubes[*editor_.Tube()].line.points.size();
  presenter_.InsertPoint();
  EXPECT_EQ(editor_.GetPatient().tubes[*editor_.Tube()].line.points.size(), count + 1);
  presenter_.DeletePoint();
  EXPECT_EQ(editor_.GetPatient().tubes[*editor_.Tube()].line.points.size(), count);
}

TEST_F(PatientPanelTest, RemovesAndAddsADuct) {
  presenter_.RemoveTube();
  EXPECT_EQ(screen_.refusals, std::vector{base::ErrorCode::kUsage}) << "which one?";
  const std::size_t count = Page().tubes.size();
  presenter_.ChooseTube(FindTube("cystic duct"));
  presenter_.RemoveTube();
  ASSERT_EQ(Page().tubes.size(), count - 1);
  EXPECT_FALSE(Page().tube);
  ASSERT_TRUE(Page().can_add);
  const auto& missing = Page().missing.names;
  const auto found = std::find(missing.begin(), missing.end(), "cystic duct");
  ASSERT_NE(found, missing.end());
  presenter_.AddMissingTube(static_cast<std::size_t>(found - missing.begin()));
  EXPECT_EQ(screen_.refusals.size(), 1u);
  EXPECT_EQ(Page().tubes.size(), count);
  ASSERT_TRUE(Page().tube);
  EXPECT_TRUE(Page().tubes[*Page().tube].is_placed) << "no picture showed it";
}

TEST_F(PatientPanelTest, JoinsADuctsEnd) {
  presenter_.ChooseTube(FindTube("cystic duct"));
  presenter_.JoinTube(anatomy::TubeEnd::kFrom, 0);
  EXPECT_TRUE(screen_.refusals.empty());
  EXPECT_EQ(Page().from.names[Page().from.chosen], "leaves the scene");
  presenter_.JoinTube(anatomy::TubeEnd::kFrom, 999);
  EXPECT_EQ(screen_.edits, 2);
}

TEST_F(PatientPanelTest, ChoosesALandmarkAndWhatIsDrawn) {
  presenter_.ChooseLandmark(1);
  EXPECT_EQ(Page().landmark, 1u);
  view::PatientFigureOptions look = Page().look;
  look.has_edges = true;
  look.liver_opacity = 0.5;
  presenter_.SetLook(look);
  EXPECT_TRUE(editor_.look.has_edges);
  EXPECT_EQ(Page().look.liver_opacity, 0.5);
}

TEST_F(PatientPanelTest, DoesNothingWithoutAPatient) {
  presenter_.UseEditor(nullptr);
  presenter_.ChooseTube(0);
  presenter_.RemoveTube();
  EXPECT_EQ(screen_.edits, 0);
}

TEST(FindingsPage, CountsAndNamesWhatWasFound) {
  EXPECT_EQ(MakeFindingsPage({}).title, "No findings: this patient can be operated on.");
  anatomy::LintReport report;
  report.findings.push_back({"L-MESH-OPEN", "liver", "a hole"});
  FindingsPage page = MakeFindingsPage(report);
  EXPECT_EQ(page.title, "1 finding; click one to look at it");
  EXPECT_EQ(page.rows[0].title, "L-MESH-OPEN  liver");
  EXPECT_EQ(page.rows[0].where, "liver");
  report.findings.push_back({"L-TUBE-CYCLE", "cystic_duct", "a ring"});
  EXPECT_EQ(MakeFindingsPage(report).title, "2 findings; click one to look at it");
}

}  // namespace
}  // namespace trocar::editor
