// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>

#include "trocar/agent/surgeon.h"
#include "trocar/files/scene_file.h"
#include "trocar/files/task_file.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/renderer.h"
#include "trocar/scene/task.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::view {
namespace {

using math::Vec3;

constexpr int kWidth = 320, kHeight = 240;
constexpr double kNear = 0.004;              // m, before the lens: what the renderer cuts off
constexpr double kDepthTolerance = 0.00002;  // m, of single precision

bool IsOrgan(LabelClass label) {
  return label >= LabelClass::kLiver && label <= LabelClass::kArtery;
}
bool IsFine(LabelClass label) {
  return label >= LabelClass::kConnectiveTissue && label <= LabelClass::kRinse;
}

/// What a ray through the middle of each pixel meets first.
struct RayCast {
  std::vector<double> depth;
  std::vector<std::uint16_t> label;
  std::vector<Vec3> normal;  // camera frame, of the triangle
  /// Of the triangle that was met: its mesh, its place there, and where in it.
  struct Place {
    std::size_t mesh = 0, triangle = 0;
    double u = 0, v = 0;
  };
  std::vector<Place> place;
};

RayCast CastRays(const std::vector<LabelledMesh>& meshes, const math::Pose& X_world_camera, double focal) {
  RayCast cast;
  cast.depth.assign(kWidth * kHeight, std::numeric_limits<double>::infinity());
  cast.label.assign(kWidth * kHeight, 0);
  cast.normal.assign(kWidth * kHeight, {});
  cast.place.assign(kWidth * kHeight, {});
  const math::Pose X_camera_world = math::Inverse(X_world_camera);
  for (const LabelledMesh& labelled : meshes) {
    if (labelled.label == 0) continue;
    std::vector<Vec3> points;
    for (const Vec3& p : labelled.mesh.positions) points.push_back(X_camera_world * p);
    for (std::size_t index = 0; index < labelled.mesh.triangles.size(); ++index) {
      const auto& t = labelled.mesh.triangles[index];
      const Vec3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
      const Vec3 e1 = b - a, e2 = c - a, normal = math::Cross(e1, e2);
      if (math::Dot(normal, a) >= 0) continue;  // seen from behind
      int x0 = 0, x1 = kWidth - 1, y0 = 0, y1 = kHeight - 1;
      if (std::max({a.z, b.z, c.z}) < -kNear) {
        const auto column = [&](const Vec3& p) { return 0.5 * kWidth - 0.5 - focal * p.x / p.z; };
        const auto row = [&](const Vec3& p) { return 0.5 * kHeight - 0.5 + focal * p.y / p.z; };
        x0 = std::max(x0, static_cast<int>(std::floor(std::min({column(a), column(b), column(c)}))));
        x1 = std::min(x1, static_cast<int>(std::ceil(std::max({column(a), column(b), column(c)}))));
        y0 = std::max(y0, static_cast<int>(std::floor(std::min({row(a), row(b), row(c)}))));
        y1 = std::min(y1, static_cast<int>(std::ceil(std::max({row(a), row(b), row(c)}))));
      }
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          const Vec3 ray{(x + 0.5 - 0.5 * kWidth) / focal, -(y + 0.5 - 0.5 * kHeight) / focal, -1};
          const Vec3 p = math::Cross(ray, e2);
          const double determinant = math::Dot(e1, p);
          if (determinant == 0) continue;
          const double u = math::Dot(-a, p) / determinant;
          const Vec3 q = math::Cross(-a, e1);
          const double v = math::Dot(ray, q) / determinant, depth = math::Dot(e2, q) / determinant;
          const auto i = static_cast<std::size_t>(y * kWidth + x);
          if (u < 0 || v < 0 || u + v > 1 || depth < kNear || depth >= cast.depth[i]) continue;
          cast.depth[i] = depth;
          cast.label[i] = labelled.label;
          cast.normal[i] = math::Normalized(normal);
          cast.place[i] = {static_cast<std::size_t>(&labelled - meshes.data()), index, u, v};
        }
      }
    }
  }
  return cast;
}

class LabelsTest : public testing::Test {
 protected:
  void Show(std::shared_ptr<const scene::Scene> scene, int ticks) {
    auto made = simulation::Simulation::Make(scene);
    ASSERT_TRUE(made.ok()) << made.error().Text();
    simulation_.emplace(std::move(*made));
    auto& simulation = simulation_;
    auto surgeon = agent::MakeSurgeon("expert", scene, 1);
    ASSERT_TRUE(surgeon.ok()) << surgeon.error().Text();
    surgeon_ = std::move(*surgeon);
    Play(ticks);
    auto context = render::OffscreenContext::Make();
    ASSERT_TRUE(context.ok()) << context.error().Text();
    context_.emplace(std::move(*context));
    auto view = LaparoscopeView::Make(*scene, simulation->Surfaces(), simulation->GetSnapshot(),
                                      simulation->Strands());
    ASSERT_TRUE(view.ok()) << view.error().Text();
    view_.emplace(std::move(*view));
    view_->SetOptions({.has_mask = has_mask_});
    view_->Update(simulation->GetSnapshot());
    const auto drawn = view_->DrawGeometry(kWidth, kHeight, picture_);
    ASSERT_TRUE(drawn.ok()) << drawn.error().Text();
    for (const std::uint16_t label : picture_.labels) seen_.insert(ClassOf(label));
  }
  void Play(int ticks) {
    for (int i = 0; i < ticks; ++i) simulation_->Step(surgeon_->Act(simulation_->GetSnapshot()));
  }
  static std::shared_ptr<const scene::Scene> Operation() {
    auto scene = files::FindOperation("cholecystectomy", {}, 1);
    EXPECT_TRUE(scene.ok() && *scene);
    return std::make_shared<const scene::Scene>(std::move(**scene));
  }

  bool has_mask_ = false;
  std::optional<render::OffscreenContext> context_;
  std::optional<simulation::Simulation> simulation_;
  std::unique_ptr<agent::Surgeon> surgeon_;
  std::optional<LaparoscopeView> view_;
  render::GeometryPicture picture_;
  std::set<LabelClass> seen_;
};

TEST_F(LabelsTest, AgreeWithRaysOnEveryVisibleOrganPixelOfTheBuiltInPatient) {
  Show(Operation(), 360);
  const RayCast cast =
      CastRays(view_->ReadMeshes(), view_->GetFrame().camera.X_world_camera, view_->FocalLength(kHeight));
  std::size_t organ = 0, same = 0, same_depth = 0, same_side = 0;
  for (std::size_t i = 0; i < picture_.labels.size(); ++i) {
    const std::uint16_t drawn = picture_.labels[i], met = cast.label[i];
    // what fibres and drops hide is seen by no ray: they are no surfaces
    if (!IsOrgan(ClassOf(drawn)) && (!IsOrgan(ClassOf(met)) || IsFine(ClassOf(drawn)))) continue;
    ++organ;
    if (drawn != met) continue;
    ++same;
    if (std::abs(picture_.depth[i] - cast.depth[i]) < kDepthTolerance) ++same_depth;
    const Vec3 normal{picture_.normals[3 * i], picture_.normals[3 * i + 1], picture_.normals[3 * i + 2]};
    EXPECT_NEAR(math::Norm(normal), 1.0, 1e-4);
    if (math::Dot(normal, cast.normal[i]) > 0.5) ++same_side;
  }
  ASSERT_GT(organ, picture_.labels.size() / 5) << "the organs are in the picture";
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(organ);
  };
  RecordProperty("organ_pixels", static_cast<int>(organ));
  RecordProperty("wrong_labels", static_cast<int>(organ - same));
  EXPECT_GE(share(same), 0.999);
  EXPECT_GE(share(same_depth), 0.998);
  EXPECT_GE(share(same_side), 0.98);
}

// each pixel's surface point, carried back with its triangle and projected into the camera of then, lies where the flow says
TEST_F(LabelsTest, FlowIsWhereSurfacePointsCameFrom) {
  Show(Operation(), 24);
  ASSERT_TRUE(view_->DrawGeometryAndFlow(kWidth, kHeight, picture_).ok());
  EXPECT_TRUE(std::all_of(picture_.flow.begin(), picture_.flow.end(), [](float v) { return std::isnan(v); }))
      << "nothing is known of before";
  const std::vector<LabelledMesh> before = view_->ReadMeshes();
  render::Camera camera = view_->GetFrame().camera;
  Play(24);
  view_->Update(simulation_->GetSnapshot());
  ASSERT_TRUE(view_->DrawGeometryAndFlow(kWidth, kHeight, picture_).ok());
  const std::vector<LabelledMesh> now = view_->ReadMeshes();
  ASSERT_EQ(now.size(), before.size());
  const RayCast cast = CastRays(now, view_->GetFrame().camera.X_world_camera, view_->FocalLength(kHeight));
  std::size_t compared = 0, same = 0, moved = 0;
  for (std::size_t i = 0; i < picture_.labels.size(); ++i) {
    const LabelClass label = ClassOf(picture_.labels[i]);
    if (picture_.labels[i] != cast.label[i] || picture_.labels[i] == 0 || IsFine(label)) continue;
    const RayCast::Place& place = cast.place[i];
    const auto& mesh = before[place.mesh].mesh;
    const auto& t = mesh.triangles[place.triangle];
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3 p = a + place.u * (b - a) + place.v * (c - a);
    const math::Vec2 from = render::CalcPixel(camera, p, kWidth, kHeight);
    const double wanted[] = {static_cast<double>(i % kWidth) - from.x,
                             static_cast<double>(i / kWidth) - from.y};
    const double off = std::hypot(picture_.flow[2 * i] - wanted[0], picture_.flow[2 * i + 1] - wanted[1]);
    ++compared;
    if (off < 0.02) ++same;
    if (std::hypot(wanted[0], wanted[1]) > 0.5) ++moved;
  }
  ASSERT_GT(compared, picture_.labels.size() / 2);
  EXPECT_GT(moved, 200U) << "the laparoscope moves";
  EXPECT_GE(static_cast<double>(same) / static_cast<double>(compared), 0.998);
  // nothing moves any more
  ASSERT_TRUE(view_->DrawGeometryAndFlow(kWidth, kHeight, picture_).ok());
  for (const float v : picture_.flow) EXPECT_TRUE(std::isnan(v) || std::abs(v) < 1e-3F);
}

TEST_F(LabelsTest, NameOrgansAndScenery) {
  Show(Operation(), 24);
  for (const LabelClass label : {LabelClass::kLiver, LabelClass::kGallbladder, LabelClass::kOmentum,
                                 LabelClass::kAbdominalWall, LabelClass::kTriangleFat})
    EXPECT_EQ(seen_.count(label), 1U) << NameOf(label);
  EXPECT_EQ(seen_.count(LabelClass::kNothing), 0U) << "the wall encloses everything";
}

TEST_F(LabelsTest, AreNothingOutsideOfTheRoundPicture) {
  has_mask_ = true;
  Show(Operation(), 1);
  EXPECT_EQ(picture_.labels.front(), 0);
  EXPECT_EQ(picture_.depth.front(), 0.0f);
  EXPECT_NE(picture_.labels[kWidth * kHeight / 2 + kWidth / 2], 0);
}

TEST_F(LabelsTest, TellTheThingsOfATaskApart) {
  const auto path = files::FindTask("peg_transfer");
  ASSERT_TRUE(path.ok());
  auto scene = files::ReadTask(*path, {});
  ASSERT_TRUE(scene.ok());
  Show(std::make_shared<const scene::Scene>(std::move(*scene)), 1);
  std::set<std::uint8_t> objects;
  for (const std::uint16_t label : picture_.labels)
    if (ClassOf(label) == LabelClass::kObject) objects.insert(InstanceOf(label));
  EXPECT_GT(objects.size(), 6U) << "pegs and rings";
  EXPECT_EQ(seen_.count(LabelClass::kTrainerBox), 1U);
  EXPECT_EQ(seen_.count(LabelClass::kDissector), 1U);
}

TEST(LabelClass, NamesAreWholeAndDiffer) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kLabelClassCount; ++i) names.insert(NameOf(static_cast<LabelClass>(i)));
  EXPECT_EQ(names.size(), kLabelClassCount);
  EXPECT_EQ(names.count(""), 0U);
}

}  // namespace
}  // namespace trocar::view
