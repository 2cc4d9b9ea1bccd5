// SPDX-License-Identifier: Apache-2.0
/// \file harsh_labels.h  Label maps of a liver as atlases and networks have them at their worst.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "trocar/images/image_stack.h"
#include "trocar/math/random.h"
#include "trocar/math/vector.h"

namespace trocar::meshing::test {

/// What is wrong with a label map.
struct LabelFaults {
  std::string name;
  std::array<double, 3> voxel_mm = {1.5, 1.5, 1.5};
  int vessel_generations = 0;  ///< of a carved-out tree of vessels; 0: none
  int sheets = 0;              ///< thin clefts through the right lobe
  int lumps = 0;               ///< balls, some of them on necks of a voxel
  int repeated_slices = 1;     ///< each slice comes so often: stairs
  double noise = 0;            ///< share of border voxels that take a neighbour's label
  double cut_above_mm = std::numeric_limits<double>::max();  ///< where the field of view ends
  double tilt_rad = 0;                                       ///< of the axes against the body's
  std::uint64_t seed = 1;
};

/// The body before it is sampled: large right lobe, thin left lobe that ends in an edge. Frame: right, anterior, superior [mm].
class HarshLiver {
 public:
  explicit HarshLiver(const LabelFaults& faults) : random_(faults.seed) {
    if (faults.vessel_generations > 0)
      Branch({20, -10, -60}, math::Normalized(math::Vec3{0.2, 0.2, 0.95}), random_.Uniform(4, 8),
             faults.vessel_generations - 1);
    for (int i = 0; i < faults.sheets; ++i) {
      const math::Vec3 normal = {random_.Uniform(-1, 1), random_.Uniform(-1, 1), random_.Uniform(-1, 1)};
      sheets_.push_back({math::Normalized(normal), random_.Uniform(-40, 40), random_.Uniform(0.8, 2.5)});
    }
    for (int i = 0; i < faults.lumps; ++i)
      lumps_.push_back({{random_.Uniform(-90, 60), random_.Uniform(-60, 60), random_.Uniform(-45, 45)},
                        random_.Uniform(4, 22)});
  }

  bool Holds(const math::Vec3& p) const {
    const double x = (p.x - 25) / 70, y = p.y / 65, z = (p.z - 5) / 55;
    bool inside = x * x + y * y + z * z < 1;
    inside |= p.x > -110 && p.x < 30 && std::fabs(p.y - 10) < 45 - 0.2 * std::fabs(p.x) &&
              std::fabs(p.z - (25 - 0.15 * p.x)) < (5 + 0.18 * (p.x + 110)) / 2;
    for (const Ball& ball : lumps_) inside |= Norm(p - ball.centre) < ball.radius;
    if (!inside) return false;
    for (const Vessel& vessel : vessels_) {
      const math::Vec3 along = vessel.to - vessel.from;
      const double part = std::clamp(Dot(p - vessel.from, along) / Dot(along, along), 0.0, 1.0);
      if (Norm(p - vessel.from - part * along) < vessel.radius) return false;
    }
    return std::none_of(sheets_.begin(), sheets_.end(), [&](const Sheet& sheet) {
      return std::fabs(Dot(sheet.normal, p) - sheet.offset) < sheet.half_thickness &&
             p.x * sheet.normal.x > -10;
    });
  }

 private:
  struct Vessel {
    math::Vec3 from, to;
    double radius;
  };
  struct Sheet {
    math::Vec3 normal;
    double offset, half_thickness;
  };
  struct Ball {
    math::Vec3 centre;
    double radius;
  };

  void Branch(const math::Vec3& from, const math::Vec3& direction, double radius, int generations) {
    const math::Vec3 to = from + random_.Uniform(20, 35) * direction;
    vessels_.push_back({from, to, radius});
    for (int child = 0; child < 2 && generations > 0; ++child) {
      const math::Vec3 turned = {direction.x + random_.Uniform(-0.8, 0.8),
                                 direction.y + random_.Uniform(-0.8, 0.8),
                                 direction.z + random_.Uniform(-0.8, 0.8)};
      Branch(to, math::Normalized(turned), 0.75 * radius, generations - 1);
    }
  }

  math::Random random_;
  std::vector<Vessel> vessels_;
  std::vector<Sheet> sheets_;
  std::vector<Ball> lumps_;
};

/// Label 1 inside the body, 0 elsewhere.
inline images::LabelVolume MakeHarshLabels(const LabelFaults& faults) {
  const HarshLiver body(faults);
  constexpr std::array<double, 3> kExtentMm = {250, 170, 150};
  images::LabelVolume map;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    map.size[axis] = static_cast<int>(kExtentMm[axis] / faults.voxel_mm[axis]);
    map.direction[axis][axis] = faults.voxel_mm[axis];
  }
  const double c = std::cos(faults.tilt_rad), s = std::sin(faults.tilt_rad);
  for (int k = 0; k < map.size[2]; ++k) {
    const int sampled = k / faults.repeated_slices * faults.repeated_slices;
    for (int j = 0; j < map.size[1]; ++j) {
      for (int i = 0; i < map.size[0]; ++i) {
        const double u = faults.voxel_mm[0] * (i - 0.5 * (map.size[0] - 1));
        const double v = faults.voxel_mm[1] * (j - 0.5 * (map.size[1] - 1));
        const double w = faults.voxel_mm[2] * (sampled - 0.5 * (map.size[2] - 1));
        const math::Vec3 p = {c * u - s * v, c * (s * u + c * v) - s * w, s * (s * u + c * v) + c * w};
        map.labels.push_back(body.Holds(p) && p.z <= faults.cut_above_mm ? 1 : 0);
      }
    }
  }
  if (faults.noise > 0) {
    math::Random random(faults.seed + 1000);
    const auto before = map.labels;
    const auto row = static_cast<std::ptrdiff_t>(map.size[0]), plane = row * map.size[1];
    const std::array<std::ptrdiff_t, 6> steps = {1, -1, row, -row, plane, -plane};
    const auto count = static_cast<std::ptrdiff_t>(before.size());
    for (std::ptrdiff_t v = plane; v < count - plane; ++v) {
      const auto at = [&](std::ptrdiff_t voxel) { return before[static_cast<std::size_t>(voxel)]; };
      const bool is_border =
          std::any_of(steps.begin(), steps.end(), [&](auto step) { return at(v + step) != at(v); });
      if (is_border && random.Uniform() < faults.noise)
        map.labels[static_cast<std::size_t>(v)] =
            at(v + steps[static_cast<std::size_t>(random.Uniform(0, 5.999))]);
    }
  }
  return map;
}

}  // namespace trocar::meshing::test
