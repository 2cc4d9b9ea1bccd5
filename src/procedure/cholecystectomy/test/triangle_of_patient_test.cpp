// SPDX-License-Identifier: Apache-2.0
// The built-in patient's critical view: what the eye sees of the hepatocystic triangle is what is judged.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "operation_harness.h"
#include "trocar/anatomy/generate_patient.h"
#include "trocar/cholecystectomy/cholecystectomy.h"
#include "trocar/cholecystectomy/critical_view.h"
#include "trocar/cholecystectomy/injury.h"
#include "trocar/cholecystectomy/triangle_description.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/simulation/model_description.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cholecystectomy {

using math::Vec3;
using scene::Scene;
using scene::StrandInfo;

namespace {

using Kind = StrandInfo::Kind;

class TriangleOfPatient : public simulation::OperationHarness {
 protected:
  void SetUp() override {
    auto made = simulation::DescribeModel(*simulation::OperationScene());
    ASSERT_TRUE(made.ok()) << made.error().Text();
    model_description_ = std::move(*made);
    triangle_ = DescribeTriangle(*simulation::OperationScene(), model_description_);
    MakeOperation();
  }

  bool IsFat(std::uint32_t strand) const {
    const Kind kind = operation_->Strands()[strand].kind;
    return kind == Kind::kTriangle || kind == Kind::kPeritoneum;
  }
  /// From the middle of a strand to the nearest point of what must stay [m].
  double DistanceToMain(std::uint32_t strand) const {
    const StrandInfo& info = operation_->Strands()[strand];
    const Vec3 middle = 0.5 * (state_.position[info.a] + state_.position[info.b]);
    double least = 1;
    const std::size_t organs = simulation::OperationScene()->patient.organs.size();
    for (std::size_t t = 0; t < model_description_.tube_roles.size(); ++t) {
      const auto& roles = model_description_.tube_roles[t];
      for (std::uint32_t k = 0; k < roles.size(); ++k) {
        if (MayBeDivided(roles[k])) continue;
        const std::uint32_t node = model_description_.surfaces[organs + t].first_node + k;
        least = std::min(least, math::Distance(state_.position[node], middle));
      }
    }
    return least;
  }
  void Divide(std::uint32_t strand) { state_.strand_is_intact[strand] = 0; }
  /// Fat on the last of what enters the gallbladder, as far as it is exposable.
  void DivideAboutEntries() {
    for (std::size_t t = 0; t < triangle_.exposable.size(); ++t) {
      const double exposable = triangle_.exposable[t];
      if (exposable == 0.0) continue;
      const scene::SurfaceInfo& tube =
          model_description_.surfaces[simulation::OperationScene()->patient.organs.size() + t];
      const std::int32_t gallbladder =
          scene::FindSurface(model_description_.surfaces, roles::OrganRole::kGallbladder);
      const std::uint32_t end = tube.first_node + (tube.ends[0] == gallbladder ? 0 : tube.node_count - 1);
      for (std::uint32_t i = 0; i < operation_->Strands().size(); ++i) {
        const StrandInfo& strand = operation_->Strands()[i];
        const Vec3 middle = 0.5 * (state_.position[strand.a] + state_.position[strand.b]);
        if (IsFat(i) && math::Distance(middle, state_.position[end]) < exposable) Divide(i);
      }
    }
  }
  /// Lenses about the cystic duct, 60 mm from it, from which fat hides nothing of what has to be seen.
  int CountOpenViews() {
    TriangleSight& sight = triangle_.sight;
    sight.Update(state_.strand_is_intact, [](std::uint32_t) { return false; });
    const auto points = sight.FindPoints(state_.position);
    const Vec3 along = math::Normalized(points[1] - points[0]);
    const Vec3 up = math::Normalized(math::Cross(along, {1, 0, 0}), {0, 0, 1});
    int open = 0;
    for (int step = 0; step < kLenses; ++step) {
      const Vec3 eye =
          points[2] + 0.06 * math::Rotate(math::RotationAbout(along, 2 * M_PI * step / kLenses), up);
      open += std::none_of(points.begin(), points.end(),
                           [&](const Vec3& p) { return sight.DoesFatHide(state_.position, p, eye); });
    }
    return open;
  }
  static constexpr int kLenses = 36;

  simulation::ModelDescription model_description_;
  TriangleDescription triangle_;
};

// The old rule left out whatever lay within 10 mm of a main duct or artery, which is nearly the whole triangle.
TEST_F(TriangleOfPatient, IsNotClearWhileALumpLiesOverItNearAMainDuct) {
  for (std::uint32_t i = 0; i < operation_->Strands().size(); ++i) {
    if (IsFat(i) && DistanceToMain(i) >= 0.010) Divide(i);
  }
  Judge();
  const scene::ProcedureResult result = Result().procedure;
  EXPECT_LT(result.now.Measure(kClearedShare), 0.4);
  EXPECT_EQ(result.now.view.Points(kTriangle), 0);
  const auto& reasons = result.missing;
  ASSERT_FALSE(reasons.empty());
  EXPECT_NE(reasons[0].find("hepatocystic triangle is not clear"), std::string::npos);
}

TEST_F(TriangleOfPatient, IsClearWhenNothingCoversItThoughTheMainDuctsKeepTheirFat) {
  for (const std::uint32_t strand : triangle_.window_strands) Divide(strand);
  Judge();
  EXPECT_EQ(Result().procedure.now.Measure(kClearedShare), 1.0);
  EXPECT_EQ(Result().procedure.now.view.Points(kTriangle), 2);
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < operation_->Strands().size(); ++i)
    kept += IsFat(i) && state_.strand_is_intact[i] != 0 ? 1 : 0;
  EXPECT_GT(kept, 100u) << "the common hepatic duct need not be exposed";
}

/// What may be asked to lie bare of the tube in that role [m].
double ExposableOf(const Scene& scene, roles::TubeRole role) {
  const auto model = simulation::DescribeModel(scene);
  EXPECT_TRUE(model.ok());
  if (!model.ok()) return 0;
  const TriangleDescription triangle = DescribeTriangle(scene, *model);
  double found = 0;
  for (std::size_t t = 0; t < scene.patient.tubes.size(); ++t) {
    if (scene.patient.tubes[t].role == role) found = std::max(found, triangle.exposable[t]);
  }
  return found;
}

// The cystic duct of generated patient 4 is 11 mm long.
TEST(ExposableOfTubes, EndsWhereMainDuctsKeepWhatLiesBesideThem) {
  const Scene& whole = *simulation::OperationScene();
  const double usual = CriticalViewSettings{}.skeletonised;
  EXPECT_GT(ExposableOf(whole, roles::TubeRole::kCysticDuct), usual);
  EXPECT_GT(ExposableOf(whole, roles::TubeRole::kCysticArtery), usual);
  EXPECT_EQ(ExposableOf(whole, roles::TubeRole::kCommonHepaticDuct), 0.0) << "it enters no gallbladder";
  Scene wide = whole;
  wide.operation->parameters.judgement.kept_fat = 0.020;
  EXPECT_LT(ExposableOf(wide, roles::TubeRole::kCysticDuct),
            ExposableOf(whole, roles::TubeRole::kCysticDuct) - 0.010);

  const test::TemporaryFolder temporary;
  const auto patient = anatomy::GeneratePatient(4);
  ASSERT_TRUE(patient.ok()) << patient.error().Text();
  ASSERT_TRUE(files::WritePatient(temporary.Path() / "patient", *patient).ok());
  const auto read = files::ReadScene(std::filesystem::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json",
                                     temporary.Path() / "patient");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_GT(ExposableOf(*read, roles::TubeRole::kCysticDuct), 0.003);
  EXPECT_LT(ExposableOf(*read, roles::TubeRole::kCysticDuct), 0.007);
}

// Where the main duct keeps more, a view is asked for less of the cystic duct: for nothing beyond what is exposable.
TEST(SightOfTriangle, AsksForNoPlaceOfTheDuctThatKeepsItsFat) {
  const auto farthest_asked = [](const Scene& scene) {
    const auto model = simulation::DescribeModel(scene);
    EXPECT_TRUE(model.ok());
    TriangleDescription triangle = DescribeTriangle(scene, *model);
    const std::int32_t gallbladder = scene::FindSurface(model->surfaces, roles::OrganRole::kGallbladder);
    const auto& duct = model->surfaces[static_cast<std::size_t>(
        scene::FindSurface(model->surfaces, roles::TubeRole::kCysticDuct))];
    const std::uint32_t end =
        duct.ends[0] == gallbladder ? duct.first_node : duct.first_node + duct.node_count - 1;
    const auto points = triangle.sight.FindPoints(model->rest);
    return std::max(math::Distance(points[0], model->rest[end]), math::Distance(points[1], model->rest[end]));
  };
  const Scene& whole = *simulation::OperationScene();
  Scene wide = whole;
  wide.operation->parameters.judgement.kept_fat = 0.020;
  const double exposable = ExposableOf(wide, roles::TubeRole::kCysticDuct);
  EXPECT_LE(farthest_asked(wide), exposable + 0.0025) << "a node of the duct more";
  EXPECT_GT(farthest_asked(whole), exposable + 0.005);
}

// The fat that is drawn is the fat that hides: none of the triangle is seen before it is cleared.
TEST_F(TriangleOfPatient, IsHiddenByItsFatFromAllSidesAndSeenOnceItAndTheEntriesAreCleared) {
  EXPECT_EQ(CountOpenViews(), 0);
  for (const std::uint32_t strand : triangle_.window_strands) Divide(strand);
  const int of_window = CountOpenViews();
  EXPECT_LE(of_window, kLenses / 10) << "fat lies where duct and artery enter";
  DivideAboutEntries();
  EXPECT_GT(CountOpenViews(), 2 * of_window);
}

}  // namespace
}  // namespace trocar::cholecystectomy
