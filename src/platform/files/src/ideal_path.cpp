// SPDX-License-Identifier: Apache-2.0
#include "ideal_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "field_ranges.h"
#include "scene_objects.h"
#include "task_names.h"
#include "trocar/instrument/trocar_kinematics.h"
#include "trocar/math/elementary.h"

namespace trocar::files {
namespace {

using base::ErrorCode;
using host::JsonView;
using math::Vec3;

/// Of a circle: its polygon is shorter than itself by less than a hundred-thousandth.
constexpr int kCircleSides = 720;
constexpr std::size_t kMostStops = 1024;

class PathReader {
 public:
  PathReader(const scene::Scene& scene, const scene::Task& task, const Vec3& start)
      : scene_(scene), task_(task), path_{start} {}

  void ReadStop(const JsonView& view, const std::string& item) {
    view.AllowOnly({"about", "region", "object", "grip", "at_mm", "band", "circle", "offset_mm"});
    int kinds = 0;
    for (const char* kind : {"region", "object", "at_mm", "band", "circle"}) kinds += view.Has(kind);
    if (kinds != 1) {
      view.Complain("a stop names one of region, object, at_mm, band and circle", ErrorCode::kSceneInvalid);
      return;
    }
    offset_ = view.Has("offset_mm") ? ReadPointMm(view, "offset_mm", range::kOffsetMm) : Vec3{};
    if (view.Has("region")) {
      const int region = FindName(view, task_.regions, Fill(view.Text("region"), item), "region");
      if (region >= 0) Add(task_.regions[static_cast<std::size_t>(region)].centre);
    } else if (view.Has("object")) {
      AddObject(view, item);
    } else if (view.Has("at_mm")) {
      Add(ReadPointMm(view, "at_mm"));
    } else if (view.Has("band")) {
      const auto bands = scene_.model ? scene_.model->bands : std::vector<scene::ModelBand>();
      const int band = FindName(view, bands, Fill(view.Text("band"), item), "band");
      if (band >= 0) AddNearest(bands[static_cast<std::size_t>(band)]);
    } else {
      const auto sheets = scene_.model ? scene_.model->sheets : std::vector<scene::ModelSheet>();
      const int sheet = FindName(view, sheets, Fill(view.Text("circle"), item), "sheet");
      if (sheet >= 0) AddCircle(sheets[static_cast<std::size_t>(sheet)]);
    }
  }

  std::vector<Vec3> Take() { return std::move(path_); }

 private:
  void Add(const Vec3& point) { path_.push_back(point + offset_); }

  /// Where it lies at the start, or where a person would take it then.
  void AddObject(const JsonView& view, const std::string& item) {
    const int index = FindName(view, scene_.objects, Fill(view.Text("object"), item), "object");
    if (index < 0) return;
    const scene::SceneObject& object = scene_.objects[static_cast<std::size_t>(index)];
    Vec3 point;
    if (view.Has("grip")) {
      const auto grip = static_cast<std::size_t>(view.Integer("grip", range::kGrip));
      if (grip >= object.grips.size()) {
        view.Complain(object.name + " has " + std::to_string(object.grips.size()) + " grips, counted from 0",
                      ErrorCode::kSceneInvalid);
        return;
      }
      point = object.grips[grip].point;
    }
    Add(object.body.X_world_body * point);
  }

  void AddNearest(const scene::ModelBand& band) {
    const Vec3 along = band.to - band.from;
    const double length2 = math::Dot(along, along);
    const double share = length2 > 0 ? math::Dot(path_.back() - band.from, along) / length2 : 0.0;
    Add(band.from + std::clamp(share, 0.0, 1.0) * along);
  }

  /// From the point of the circle that lies nearest, once round.
  void AddCircle(const scene::ModelSheet& sheet) {
    const Vec3 from = path_.back() - sheet.centre;
    const double first = math::Atan2(from.y, from.x);
    for (int side = 0; side <= kCircleSides; ++side) {
      const double angle = first + 2.0 * M_PI * side / kCircleSides;
      Add(sheet.centre + sheet.circle * Vec3{math::Cos(angle), math::Sin(angle), 0.0});
    }
  }

  const scene::Scene& scene_;
  const scene::Task& task_;
  std::vector<Vec3> path_;
  Vec3 offset_;
};

/// Stops, and groups of them that are repeated for each of some items.
std::vector<Vec3> ReadHandPath(const std::vector<JsonView>& entries, const scene::Scene& scene,
                               const scene::Task& task, std::size_t hand) {
  const scene::InstrumentSetup& setup = scene.instruments[hand];
  PathReader reader(scene, task, instrument::CalcToolPose(setup.p_world_port, setup.home).translation);
  for (const JsonView& entry : entries) {
    if (!entry.Has("stops")) {
      reader.ReadStop(entry, "");
      continue;
    }
    entry.AllowOnly({"about", "for_each", "stops"});
    for (const std::string& item : ReadItems(entry)) {
      for (const JsonView& stop : entry.Array("stops")) reader.ReadStop(stop, item);
    }
  }
  return reader.Take();
}

}  // namespace

void ReadIdealPath(const JsonView& root, const scene::Scene& scene, scene::Task& task) {
  if (!root.Has("ideal_path")) return;
  const JsonView view = root.Object("ideal_path");
  view.AllowOnly({"about", "left", "right"});
  constexpr std::array<const char*, instrument::kHandCount> kHands = {"left", "right"};
  for (std::size_t hand = 0; hand < kHands.size(); ++hand) {
    if (!view.Has(kHands[hand])) continue;
    std::vector<Vec3> path = ReadHandPath(view.Array(kHands[hand]), scene, task, hand);
    if (path.size() > kMostStops + kCircleSides)
      view.Complain("an ideal path has at most " + std::to_string(kMostStops) + " stops",
                    ErrorCode::kSceneInvalid);
    task.ideal_path[hand] = std::move(path);
    if (!(scene::CalcIdealPathLength(task, hand) > 0.0))
      view.Complain(std::string("the ideal path of the ") + kHands[hand] + " hand has no length",
                    ErrorCode::kSceneInvalid);
  }
}

}  // namespace trocar::files
