// SPDX-License-Identifier: Apache-2.0
#include "image_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "trocar/math/elementary.h"

namespace trocar::images {
namespace {

using base::Error;
using base::ErrorCode;
using math::Vec3;

constexpr double kDegrees = 180.0 / M_PI;
constexpr double kMostShearDeg = 0.5;  // 1 mm over the length of a gallbladder

struct Word {
  const char* name;
  int world;  // L, P, S
  double sign;
};
constexpr Word kWords[] = {{"left", 0, 1.0},      {"right", 0, -1.0},   {"posterior", 1, 1.0},
                           {"anterior", 1, -1.0}, {"superior", 2, 1.0}, {"inferior", 2, -1.0}};

}  // namespace

base::Result<NamedAxes> NameAxes(const std::array<Vec3, 3>& direction) {
  for (int i = 0; i < 3; ++i) {
    const double cosine = Dot(direction[i], direction[(i + 1) % 3]);
    if (std::fabs(cosine) > math::Sin(kMostShearDeg / kDegrees)) {
      return Error{
          ErrorCode::kImageGeometryInvalid,
          "its axes are not at right angles (a tilted gantry?); resample it, for instance with 3D Slicer"};
    }
  }
  NamedAxes named;
  for (int i = 0; i < 3; ++i) {
    const Word* best = &kWords[0];
    for (const Word& word : kWords) {
      if (word.sign * direction[i][word.world] > best->sign * direction[i][best->world]) best = &word;
    }
    named.axes[i] = best->name;
    const double cosine = std::min(1.0, best->sign * direction[i][best->world]);
    named.tilt_deg = std::max(named.tilt_deg, math::Acos(cosine) * kDegrees);
  }
  // axes at right angles that get one word twice are at least 44 degrees off it
  if (named.tilt_deg > kMostTiltDeg) {
    char text[200];
    std::snprintf(
        text, sizeof(text),
        "its slices are oblique, %.0f degrees off the body's axes (%.0f are accepted); resample it along "
        "them, for instance with 3D Slicer",
        named.tilt_deg, kMostTiltDeg);
    return Error{ErrorCode::kImageGeometryInvalid, text};
  }
  return named;
}

base::Result<std::array<Vec3, 3>> FindDirections(const std::array<std::string, 3>& axes) {
  std::array<Vec3, 3> direction;
  std::array<bool, 3> is_used = {};
  for (int i = 0; i < 3; ++i) {
    const auto* word =
        std::find_if(std::begin(kWords), std::end(kWords), [&](const Word& w) { return axes[i] == w.name; });
    if (word == std::end(kWords) || is_used[word->world]) {
      return Error{
          ErrorCode::kUsage,
          "the axes of columns, rows and slices must be one each of left/right, anterior/posterior and "
          "superior/inferior, for example left,posterior,superior"};
    }
    is_used[word->world] = true;
    direction[i][word->world] = word->sign;
  }
  return direction;
}

}  // namespace trocar::images
