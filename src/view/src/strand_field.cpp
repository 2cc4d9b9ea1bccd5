// SPDX-License-Identifier: Apache-2.0
#include "strand_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "trocar/core/assert.h"
#include "trocar/math/random.h"

namespace trocar::view {
namespace {

using Kind = scene::StrandInfo::Kind;
using math::Vec3;
using render::Material;

constexpr double kFibreWidth = 0.00022;                    // m, of areolar tissue
constexpr double kAdhesionWidth = 0.0007;                  // m
constexpr double kEndSpread = 0.0007;                      // m, of a fibre's root about its node
constexpr double kFatSpread = 0.0016;                      // m, from the strand
constexpr double kFilmOverlap = 1.6;                       // breadth of a film in distances to its neighbour
constexpr double kLeastFilm = 0.0010, kMostFilm = 0.0045;  // m
constexpr double kWave = 0.07;                             // of a strand's length, at rest

Vec3 PickOffset(math::Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

/// How far a strand hangs sideways that is shorter than at rest: half of what an arc of its length would.
double CalcWave(double rest_length, double length) {
  const double slack = std::max(0.0, rest_length * rest_length - length * length);
  return kWave * std::min(rest_length, length) + 0.25 * std::sqrt(slack);
}

}  // namespace

StrandField::StrandField(std::span<const scene::StrandInfo> strands, std::span<const Vec3> start) {
  std::vector<Vec3> middles;  // of the peritoneum's strands
  const auto middle_of = [&start](const scene::StrandInfo& info) {
    return 0.5 * (start[info.a] + start[info.b]);
  };
  for (const scene::StrandInfo& info : strands) {
    TROCAR_ASSERT(info.a < start.size() && info.b < start.size());
    if (info.kind == Kind::kPeritoneum) middles.push_back(middle_of(info));
  }
  for (const scene::StrandInfo& info : strands) {
    double breadth = 0;
    if (info.kind == Kind::kPeritoneum) {
      // once, at the start; the square of some hundreds
      double nearest = std::numeric_limits<double>::infinity();
      const Vec3 middle = middle_of(info);
      for (const Vec3& other : middles) {
        const double distance = math::Distance(other, middle);
        if (distance > 0.0) nearest = std::min(nearest, distance);
      }
      breadth = std::clamp(kFilmOverlap * nearest, kLeastFilm, kMostFilm);
    }
    strands_.push_back({info, math::Distance(start[info.a], start[info.b]), breadth});
  }
}

void StrandField::AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const {
  const std::vector<std::uint8_t>& intact = snapshot.operation.strand_is_intact;
  // a lobule is as full as its strands are whole: balls overlap so much that a tenth of them would look like all
  std::vector<std::array<std::uint16_t, 2>> fat(snapshot.positions.size());  // all, intact
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    if (strands_[i].info.kind != Kind::kTriangle) continue;
    const bool is_intact = i >= intact.size() || intact[i] != 0;
    for (const std::uint32_t node : {strands_[i].info.a, strands_[i].info.b}) {
      ++fat[node][0];
      fat[node][1] += is_intact ? 1 : 0;
    }
  }
  const auto filling = [&fat](std::uint32_t node) {
    return static_cast<double>(fat[node][1]) / static_cast<double>(std::max<std::uint16_t>(1, fat[node][0]));
  };
  for (std::size_t i = 0; i < strands_.size(); ++i) {
    if (i < intact.size() && intact[i] == 0) continue;
    const Strand& strand = strands_[i];
    const Vec3 a = snapshot.positions[strand.info.a], b = snapshot.positions[strand.info.b];
    const double wave = CalcWave(strand.rest_length, math::Distance(a, b));
    const auto seed = static_cast<std::uint32_t>(i);
    math::Random random(i);
    const auto add_fibre = [&](double width) {
      frame.fibres.push_back({a + PickOffset(random, kEndSpread), b + PickOffset(random, kEndSpread), width,
                              wave, Material::kFibre, 3 * seed});
    };
    switch (strand.info.kind) {
      case Kind::kBed:
        add_fibre(kFibreWidth * random.Uniform(0.7, 1.5));
        break;
      case Kind::kAdhesion:
        add_fibre(kAdhesionWidth);
        break;
      case Kind::kTriangle: {
        add_fibre(kFibreWidth);
        const double radius =
            scene::kLobuleRadius * std::cbrt(std::min(filling(strand.info.a), filling(strand.info.b)));
        for (const double along : {0.3, 0.7}) {
          const Vec3 centre =
              math::Lerp(a, b, along + random.Uniform(-0.15, 0.15)) + PickOffset(random, kFatSpread);
          // 0.7 to 1.3 times a lobule
          frame.blobs.push_back({centre, radius * random.Uniform(0.7, 1.3), Material::kFat,
                                 3 * seed + (along < 0.5 ? 0U : 1U)});
        }
        break;
      }
      case Kind::kPeritoneum:
        frame.fibres.push_back({a, b, strand.breadth, 0.3 * wave, Material::kFilm, 3 * seed});
        break;
      case Kind::kBand:
        break;  // a BandView shows it
      case Kind::kEnd:
        break;  // the tube itself shows it
    }
  }
}

}  // namespace trocar::view
