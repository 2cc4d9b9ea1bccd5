// SPDX-License-Identifier: Apache-2.0
#include "trocar/view/critical_view_picture.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "trocar/cholecystectomy/operation_judge.h"
#include "trocar/cholecystectomy/triangle_description.h"
#include "trocar/collision/triangle_tree.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/simulation/model_description.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::view {
namespace {

using math::Vec3;
using scene::SurfaceInfo;
using simulation::Snapshot;

/// Turns about the cystic duct that are tried, the best first [rad]; tilts along it; distances of the lens [m].
constexpr double kTurns[] = {0.7, 0.9, 0.5, 1.1, 0.35, 1.4, 1.7, 2.0};
constexpr double kTilts[] = {0.0, 0.35, -0.35, 0.7, -0.7};
constexpr double kDistances[] = {0.055, 0.045, 0.065};

/// Where ducts are now, from where they meet on.
struct Ducts {
  std::vector<Vec3> cystic, hepatic;

  Vec3 Middle() const { return 0.5 * (cystic[(cystic.size() - 1) / 2] + hepatic[(hepatic.size() - 1) / 2]); }
};

std::vector<Vec3> LineOf(std::span<const SurfaceInfo> surfaces, const Snapshot& now, roles::TubeRole role) {
  const std::int32_t found = scene::FindSurface(surfaces, role);
  if (found < 0) return {};
  const SurfaceInfo& surface = surfaces[static_cast<std::size_t>(found)];
  const auto first = now.positions.begin() + surface.first_node;
  return {first, first + surface.node_count};
}

/// The cystic duct from the hepatic one to the gallbladder, which it `joins`; the hepatic one away from it.
base::Result<Ducts> FindDucts(const simulation::Simulation& simulation) {
  const auto surfaces = simulation.Surfaces();
  const Snapshot& now = simulation.GetSnapshot();
  Ducts ducts{LineOf(surfaces, now, roles::TubeRole::kCysticDuct),
              LineOf(surfaces, now, roles::TubeRole::kCommonHepaticDuct)};
  if (ducts.cystic.size() < 2 || ducts.hepatic.size() < 2)
    return base::Error{base::ErrorCode::kUsage,
                       "the critical view needs a cystic and a common hepatic duct, which \"" +
                           simulation.GetScene().name + "\" has not"};
  const auto& cystic =
      surfaces[static_cast<std::size_t>(scene::FindSurface(surfaces, roles::TubeRole::kCysticDuct))];
  const std::int32_t gallbladder = scene::FindSurface(surfaces, roles::OrganRole::kGallbladder);
  if (gallbladder >= 0 && cystic.ends[0] == gallbladder)
    std::reverse(ducts.cystic.begin(), ducts.cystic.end());
  if (math::Distance(ducts.hepatic.back(), ducts.cystic.front()) <
      math::Distance(ducts.hepatic.front(), ducts.cystic.front()))
    std::reverse(ducts.hepatic.begin(), ducts.hepatic.end());
  return ducts;
}

/// Organs and fat as they are now, asked for what hides a point.
class Occluders {
 public:
  Occluders(const simulation::Simulation& simulation, const cholecystectomy::TriangleSight& sight)
      : now_(simulation.GetSnapshot()), sight_(sight) {
    const std::size_t organ_count = simulation.GetScene().patient.organs.size();
    sight_.Update(now_.operation.strand_is_intact, [&](std::uint32_t tube) {
      return now_.operation.topology.IsDivided(simulation.Surfaces(), organ_count + tube);
    });
    for (const SurfaceInfo& surface : simulation.Surfaces()) {
      if (surface.triangles.empty()) continue;
      auto tree = collision::TriangleTree::Make(Nodes(surface), surface.triangles);
      if (tree.ok()) organs_.push_back({&surface, std::move(*tree)});
    }
  }
  /// What has to be seen.
  std::span<const Vec3> FindPoints() { return sight_.FindPoints(now_.positions); }
  bool Hide(const Vec3& p, const Vec3& eye) const {
    const bool do_organs = std::any_of(organs_.begin(), organs_.end(), [&](const Organ& organ) {
      return organ.tree
          .FindNearestToSegment(Nodes(*organ.surface), cholecystectomy::TriangleSight::LineTo(p, eye),
                                {.max_distance = 1e-6})
          .Found();
    });
    return do_organs || sight_.DoesFatHide(now_.positions, p, eye);
  }

 private:
  struct Organ {
    const SurfaceInfo* surface;
    collision::TriangleTree tree;
  };
  std::span<const Vec3> Nodes(const SurfaceInfo& surface) const {
    return std::span(now_.positions).subspan(surface.first_node, surface.node_count);
  }
  const Snapshot& now_;
  cholecystectomy::TriangleSight sight_;
  std::vector<Organ> organs_;
};

struct Sight {
  math::Pose X_world_camera;
  double azimuth = 0;
  bool shows_triangle = false;
};

math::Pose LookAt(const Vec3& eye, const Vec3& at, const Vec3& up) {
  const Vec3 back = math::Normalized(eye - at);
  const Vec3 right = math::Normalized(math::Cross(up, back), {1, 0, 0});
  return {math::RotationFromAxes(right, math::Cross(back, right), back), eye};
}

/// \param side  -1 front, +1 behind
Sight FindSight(const Ducts& ducts, Occluders& occluders, const math::Pose& X_world_laparoscope,
                double field_of_view, double azimuth_now, int side) {
  const Vec3 middle = ducts.Middle();
  const std::span<const Vec3> points = occluders.FindPoints();
  const Vec3 along = math::Normalized(ducts.cystic.back() - ducts.cystic.front());
  const Vec3 to_eye = math::Normalized(X_world_laparoscope.translation - middle);
  const Vec3 across = math::Normalized(math::Cross(along, to_eye), {1, 0, 0});
  const Vec3 up = math::Rotate(X_world_laparoscope.rotation, {0, 1, 0});
  const auto sight_at = [&](double turn, double tilt, double distance) {
    const double azimuth = side * turn;
    const math::Quaternion turned =
        math::RotationAbout(along, azimuth - azimuth_now) * math::RotationAbout(across, tilt);
    return Sight{LookAt(middle + distance * math::Rotate(turned, to_eye), middle, up), azimuth, false};
  };
  for (const double turn : kTurns) {
    for (const double tilt : kTilts) {
      for (const double distance : kDistances) {
        Sight sight = sight_at(turn, tilt, distance);
        sight.shows_triangle = std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
          return instrument::IsInView(sight.X_world_camera, field_of_view, p) &&
                 !occluders.Hide(p, sight.X_world_camera.translation);
        });
        if (sight.shows_triangle) return sight;
      }
    }
  }
  return sight_at(kTurns[0], kTilts[0], kDistances[0]);
}

}  // namespace

base::Result<CriticalViewDoublet> RenderCriticalViewDoublet(const simulation::Simulation& simulation,
                                                            int width, int height) {
  return RenderCriticalViewDoublet(simulation, simulation, width, height);
}

base::Result<CriticalViewDoublet> RenderCriticalViewDoublet(const simulation::Simulation& front,
                                                            const simulation::Simulation& back, int width,
                                                            int height) {
  if (width < 16 || width > 4096 || height < 16 || height > 4096)
    return base::Error{base::ErrorCode::kUsage, "a picture must have 16 to 4096 pixels a side"};
  for (const simulation::Simulation* side : {&front, &back}) {
    if (const auto ducts = FindDucts(*side); !ducts.ok()) return ducts.error();
  }
  // patterns stick to the rest shapes: those of a simulation that has not begun; the scene outlives it
  const std::shared_ptr<const scene::Scene> scene(std::shared_ptr<const scene::Scene>(), &front.GetScene());
  auto fresh = simulation::Simulation::Make(scene);
  if (!fresh.ok()) return fresh.error();
  const auto model = simulation::DescribeModel(*scene);
  if (!model.ok()) return model.error();
  const cholecystectomy::TriangleDescription triangle = cholecystectomy::DescribeTriangle(*scene, *model);
  auto context = render::OffscreenContext::Make();
  if (!context.ok()) return context.error();
  auto target = render::OffscreenTarget::Make(width, height);
  if (!target.ok()) return target.error();
  auto view = LaparoscopeView::Make(*scene, fresh->Surfaces(), fresh->GetSnapshot(), fresh->Strands());
  if (!view.ok()) return view.error();
  ViewOptions options;
  options.has_force_arrows = false;
  options.has_background = false;  // the lens may stand in it
  view->SetOptions(options);

  const auto draw = [&](const simulation::Simulation& simulation, int side) {
    const auto ducts = FindDucts(simulation);
    Occluders occluders(simulation, triangle.sight);
    Snapshot shown = ClearField(simulation.GetSnapshot());
    const auto result = simulation.GetOperationResult();
    const cholecystectomy::OperationDetail* const detail =
        result ? cholecystectomy::FindDetail(result->procedure) : nullptr;
    const double azimuth =
        detail != nullptr && std::isfinite(detail->facts.view_azimuth) ? detail->facts.view_azimuth : 0.0;
    const Sight sight = FindSight(*ducts, occluders, shown.X_world_laparoscope,
                                  scene->laparoscope.field_of_view, azimuth, side);
    shown.X_world_laparoscope = sight.X_world_camera;
    view->Update(shown);
    target->Bind();
    view->Draw(width, height);
    CriticalViewPicture picture;
    target->Read(picture.image);
    picture.azimuth = sight.azimuth;
    picture.shows_triangle = sight.shows_triangle;
    return picture;
  };
  CriticalViewDoublet doublet;
  doublet.front = draw(front, -1);
  doublet.back = draw(back, +1);
  return doublet;
}

simulation::Snapshot ClearField(simulation::Snapshot snapshot) {
  snapshot.operation.smoke = 0;
  surgery::FluidLedger& fluids = snapshot.operation.flow.ledger;
  fluids.Aspirate(fluids.Pooled());
  return snapshot;
}

void CriticalViewMoments::AfterStep(const scene::ViewScore& score, double time,
                                    const std::function<void(std::vector<std::byte>&)>& save) {
  if (is_achieved_) return;
  for (std::size_t side = 0; side < moments_.size(); ++side) {
    Moment& moment = moments_[side];
    if (!score.IsSeen(side)) {
      moment.state.clear();
    } else if (moment.state.empty()) {
      moment.time = time;
      save(moment.state);
    }
  }
  is_achieved_ = score.IsAchieved();
}

}  // namespace trocar::view
