// SPDX-License-Identifier: Apache-2.0
#include "trocar/editor/contour_panel_presenter.h"

#include <gtest/gtest.h>

#include <optional>

#include "disc_series.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::editor {
namespace {

/// Keeps what it was given, as a panel without widgets.
struct FakeContourPanel : ContourPanelScreen {
  void Show(const ContourPanelPage& shown) override { page = shown; }
  void ShowSurfaces(std::vector<render::FigureSurface> shown, bool is_fit_wanted) override {
    surfaces = std::move(shown);
    fits += is_fit_wanted ? 1 : 0;
  }
  void ShowSurfaceText(const std::string& text) override { surface_text = text; }
  void OnEdited() override { ++edits; }

  ContourPanelPage page;
  std::vector<render::FigureSurface> surfaces;
  std::string surface_text;
  int fits = 0, edits = 0;
};

class ContourPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    auto opened = OpenDisc(folder_.Path() / "slices");
    ASSERT_TRUE(opened.ok()) << opened.error().Text();
    workspace_.emplace(std::move(*opened));
    editor_.emplace(*workspace_);
    editor_->on_error = [this](const base::Error& error) { error_ = error; };
    presenter_.UseEditor(&*editor_);
  }
  /// A corner of a box of 10 mm.
  static contours::OrganMesh MakeMesh() {
    contours::OrganMesh organ;
    organ.mesh.positions = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
    organ.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return organ;
  }

  test::TemporaryFolder folder_;
  std::optional<contours::ContourWorkspace> workspace_;
  std::optional<ContourEditor> editor_;
  std::optional<base::Error> error_;
  FakeContourPanel screen_;
  ContourPanelPresenter presenter_{screen_};
};

TEST_F(ContourPanelTest, ListsTheOrgansOfANewDocument) {
  ASSERT_EQ(screen_.page.organs.size(), 2u);
  EXPECT_EQ(screen_.page.organs[0].name, "liver");
  EXPECT_EQ(screen_.page.organs[0].slices, "0 slices");
  EXPECT_TRUE(screen_.page.organs[0].is_chosen);
  EXPECT_NE(screen_.page.organs[0].colour, screen_.page.organs[1].colour);
  EXPECT_EQ(screen_.page.step.text, "1 slice");
}

TEST_F(ContourPanelTest, AddsRenamesAndDeletesOrgans) {
  presenter_.AddOrgan("spleen");
  EXPECT_EQ(presenter_.ChosenName(), "spleen");
  presenter_.RenameOrgan("stomach");
  presenter_.Refresh();
  EXPECT_EQ(screen_.page.organs.back().name, "stomach");
  presenter_.DeleteOrgan();
  presenter_.Refresh();
  EXPECT_EQ(screen_.page.organs.size(), 2u);
  EXPECT_EQ(presenter_.ChosenName(), "liver");
  EXPECT_EQ(screen_.edits, 3);
  EXPECT_FALSE(error_);
  presenter_.AddOrgan("liver");
  ASSERT_TRUE(error_) << "a name is there once";
  EXPECT_EQ(workspace_->Document().Points().structures.size(), 2u);
}

TEST_F(ContourPanelTest, SlidersSetTheChosenOrganInHalfPixels) {
  presenter_.ChooseOrgan(1);
  presenter_.SetReach(6.3);
  presenter_.SetSkippedReach(2.2);
  presenter_.SetSliceStep(4.4);
  const auto& adaption = workspace_->Document().Points().structures[1].adaption;
  EXPECT_EQ(adaption.max_shift_px, 6.5);
  EXPECT_EQ(adaption.skipped_shift_px, 2.0);
  EXPECT_EQ(editor_->SliceStep(), 4);
  presenter_.Refresh();
  EXPECT_EQ(screen_.page.reach, (SliderPage{6.5, "6.5 px"}));
  EXPECT_EQ(screen_.page.step.text, "4 slices");
}

TEST_F(ContourPanelTest, ShowsSurfacesAndWhyThereIsNone) {
  presenter_.SetMesh(0, MakeMesh());
  ASSERT_EQ(screen_.surfaces.size(), 1u);
  EXPECT_EQ(screen_.fits, 1);
  EXPECT_NE(screen_.surface_text.find("liver: 4 triangles"), std::string::npos) << screen_.surface_text;
  presenter_.SetMesh(0, MakeMesh());
  EXPECT_EQ(screen_.fits, 1) << "the camera stays where it is";
  presenter_.SetMeshProblem(1, "gallbladder: too thin");
  EXPECT_NE(screen_.surface_text.find("\ngallbladder: too thin"), std::string::npos);
  presenter_.ClearMeshes();
  EXPECT_TRUE(screen_.surfaces.empty());
  EXPECT_TRUE(screen_.surface_text.empty());
}

// Columns go to the left, rows to posterior and slices to inferior: a left-handed frame, so triangles turn.
TEST_F(ContourPanelTest, SurfacesLieInTheWorldFrame) {
  const auto& points = workspace_->Document().Points();
  const auto surface = MakeOrganSurface(points, 0, MakeMesh());
  EXPECT_NEAR(surface.positions[1].x, 0.010, 1e-12) << "x to the patient's left [m]";
  EXPECT_NEAR(surface.positions[2].z, -0.010, 1e-12) << "z anterior";
  EXPECT_NEAR(surface.positions[3].y, -0.010, 1e-12) << "y cranial";
  EXPECT_EQ(surface.triangles[0], (geometry::Triangle{0, 1, 2}));
}

TEST_F(ContourPanelTest, DoesNothingWithoutAnEditor) {
  presenter_.UseEditor(nullptr);
  presenter_.AddOrgan("spleen");
  presenter_.SetReach(3);
  EXPECT_EQ(screen_.edits, 0);
  EXPECT_TRUE(presenter_.ChosenName().empty());
}

}  // namespace
}  // namespace trocar::editor
