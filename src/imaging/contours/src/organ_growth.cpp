// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/organ_growth.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::contours {
namespace {

using base::Error;
using base::ErrorCode;
using Flags = std::vector<std::uint8_t>;

constexpr float kNowhere = 1e12f;           // square of a distance to nothing [mm^2]
constexpr double kToDeviation = 1.4826;     // of a median deviation, for normal noise
constexpr double kReachDeviations = 3.0;    // a grey this far from the median may be the organ's
constexpr double kMostOthers = 0.3;         // share of a neighbourhood that may be something else
constexpr double kLeastReach = 6.0;         // [grey levels]
constexpr double kEdgeDeviations = 3.0;     // steps above this much of the noise are edges
constexpr int kSmoothings = 6;              // steps of diffusion
constexpr double kBlack = 3, kWhite = 252;  // [grey levels]
constexpr double kVesselReaches = 5.0;      // vessels differ from the organ by at most so many reaches
constexpr int kRounds = 12;                 // of the border
constexpr double kBorderMm = 1.2;           // deviation of the Gaussian that keeps the border short
constexpr double kBesideMm = 1.5;    // deviation of the window in which a border's outer greys are taken
constexpr double kDataWeight = 0.6;  // of the greys against the border's length
constexpr double kCubicMmPerMl = 1000.0;

Error Refused(std::string why) {
  return {ErrorCode::kEditRefused, std::move(why)};
}

/// A volume's lattice with what walks over it.
struct Lattice {
  std::array<int, 3> size;
  std::array<double, 3> step;

  std::size_t Count() const { return static_cast<std::size_t>(size[0]) * size[1] * size[2]; }
  std::size_t Stride(int axis) const {
    return axis == 0 ? 1 : axis == 1 ? size[0] : static_cast<std::size_t>(size[0]) * size[1];
  }
  /// Calls act(first index of the line) for every line along the axis, in parallel.
  template <typename Act>
  void ForLines(int axis, const Act& act) const {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    oneapi::tbb::parallel_for(0, size[b], [&](int j) {
      for (int i = 0; i < size[a]; ++i) act(i * Stride(a) + j * Stride(b));
    });
  }
  template <typename Act>
  void ForVoxels(const Act& act) const {
    const std::size_t plane = Stride(2);
    oneapi::tbb::parallel_for(0, size[2], [&](int k) {
      for (std::size_t i = k * plane; i < (k + 1) * plane; ++i) act(i);
    });
  }
  /// Calls act(index of the neighbour) for the voxels that share a face.
  template <typename Act>
  void ForNeighbours(std::size_t at, const Act& act) const {
    const std::array<int, 3> place = Place(at);
    for (int axis = 0; axis < 3; ++axis) {
      if (place[axis] > 0) act(at - Stride(axis));
      if (place[axis] + 1 < size[axis]) act(at + Stride(axis));
    }
  }
  std::array<int, 3> Place(std::size_t at) const {
    const std::size_t row = at / size[0];
    return {static_cast<int>(at % size[0]), static_cast<int>(row % size[1]), static_cast<int>(row / size[1])};
  }
  double Ml(std::size_t voxels) const {
    return static_cast<double>(voxels) * step[0] * step[1] * step[2] / kCubicMmPerMl;
  }
};

/// Gaussian along all axes.
void Blur(std::vector<float>& values, const Lattice& at, double deviation_mm) {
  for (int axis = 0; axis < 3; ++axis) {
    const double deviation = deviation_mm / at.step[axis];
    if (deviation < 0.15) continue;
    const int reach = base::CeilTo<int>(2.5 * deviation), n = at.size[axis];
    std::vector<float> kernel;
    for (int i = 0; i <= reach; ++i)
      kernel.push_back(static_cast<float>(math::Exp(-0.5 * i * i / (deviation * deviation))));
    float total = kernel[0];
    for (int i = 1; i <= reach; ++i) total += 2 * kernel[i];
    for (float& weight : kernel) weight /= total;
    const std::size_t stride = at.Stride(axis);
    at.ForLines(axis, [&](std::size_t first) {
      thread_local std::vector<float> line;
      line.resize(n + 2 * reach);
      for (int i = -reach; i < n + reach; ++i)
        line[i + reach] = values[first + std::clamp(i, 0, n - 1) * stride];
      for (int i = 0; i < n; ++i) {
        float sum = kernel[0] * line[i + reach];
        for (int k = 1; k <= reach; ++k) sum += kernel[k] * (line[i + reach - k] + line[i + reach + k]);
        values[first + i * stride] = sum;
      }
    });
  }
}

/// Diffusion that stops at steps above `edge`.
std::vector<float> Smooth(const GreyVolume& volume, const Lattice& at, double edge) {
  std::vector<float> now = volume.values, next = now;
  const double least = std::min({at.step[0], at.step[1], at.step[2]});
  std::array<float, 3> weight;
  for (int axis = 0; axis < 3; ++axis)
    weight[axis] = static_cast<float>(0.15 * least * least / (at.step[axis] * at.step[axis]));
  const float scale = static_cast<float>(1 / edge);
  for (int round = 0; round < kSmoothings; ++round) {
    at.ForVoxels([&](std::size_t i) {
      const std::array<int, 3> place = at.Place(i);
      float sum = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t stride = at.Stride(axis);
        const auto flow = [&](std::size_t j) {
          const float step = now[j] - now[i], part = step * scale;
          return step / (1 + part * part);
        };
        if (place[axis] > 0) sum += weight[axis] * flow(i - stride);
        if (place[axis] + 1 < at.size[axis]) sum += weight[axis] * flow(i + stride);
      }
      next[i] = now[i] + sum;
    });
    now.swap(next);
  }
  return now;
}

double Median(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Indices of the voxels within a radius of the click.
std::vector<std::size_t> FindBall(const Lattice& at, const std::array<int, 3>& seed, double radius) {
  std::vector<std::size_t> ball;
  std::array<int, 3> reach, d;
  for (int axis = 0; axis < 3; ++axis) reach[axis] = base::TruncateTo<int>(radius / at.step[axis]);
  for (d[2] = -reach[2]; d[2] <= reach[2]; ++d[2]) {
    for (d[1] = -reach[1]; d[1] <= reach[1]; ++d[1]) {
      for (d[0] = -reach[0]; d[0] <= reach[0]; ++d[0]) {
        double away = 0;
        bool is_there = true;
        std::size_t index = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const int p = seed[axis] + d[axis];
          is_there = is_there && p >= 0 && p < at.size[axis];
          const double aside = d[axis] * at.step[axis];
          away += aside * aside;
          index += static_cast<std::size_t>(std::max(p, 0)) * at.Stride(axis);
        }
        if (is_there && away <= radius * radius) ball.push_back(index);
      }
    }
  }
  return ball;
}

/// Standard deviation of the noise, from steps between voxels two apart along a row.
double FindNoise(const GreyVolume& volume, const std::vector<std::size_t>& ball) {
  std::vector<float> steps;
  for (const std::size_t i : ball) {
    if (i % volume.size[0] + 2 < static_cast<std::size_t>(volume.size[0]))
      steps.push_back(std::fabs(volume.values[i + 2] - volume.values[i]));
  }
  return std::max(1.0, kToDeviation * Median(steps) / std::sqrt(2.0));
}

/// The part of `flags` that holds the voxel, connected by faces; empty when it is not set there.
Flags FindPart(const Flags& flags, const Lattice& at, std::size_t from) {
  Flags part(flags.size(), 0);
  if (flags[from] == 0) return part;
  std::vector<std::size_t> waiting = {from};
  part[from] = 1;
  while (!waiting.empty()) {
    const std::size_t i = waiting.back();
    waiting.pop_back();
    at.ForNeighbours(i, [&](std::size_t j) {
      if (flags[j] != 0 && part[j] == 0) part[j] = 1, waiting.push_back(j);
    });
  }
  return part;
}

Flags Where(const std::vector<float>& values, const Lattice& at, const auto& is_in) {
  Flags flags(values.size());
  at.ForVoxels([&](std::size_t i) { flags[i] = is_in(values[i]) ? 1 : 0; });
  return flags;
}

Flags Invert(Flags flags) {
  for (std::uint8_t& each : flags) each = each == 0 ? 1 : 0;
  return flags;
}

/// Sets what the region encloses.
void FillHoles(Flags& region, const Lattice& at) {
  // the outside is reached from the volume's faces
  Flags outside(region.size(), 0);
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < region.size(); ++i) {
    const auto place = at.Place(i);
    bool is_face = false;
    for (int axis = 0; axis < 3; ++axis)
      is_face = is_face || place[axis] == 0 || place[axis] + 1 == at.size[axis];
    if (is_face && region[i] == 0) outside[i] = 1, waiting.push_back(i);
  }
  while (!waiting.empty()) {
    const std::size_t i = waiting.back();
    waiting.pop_back();
    at.ForNeighbours(i, [&](std::size_t j) {
      if (region[j] == 0 && outside[j] == 0) outside[j] = 1, waiting.push_back(j);
    });
  }
  for (std::size_t i = 0; i < region.size(); ++i) region[i] = outside[i] == 0 ? 1 : 0;
}

/// What the click says of the organ's greys.
struct Greys {
  double median = 0, reach = 0;
};

class Growth {
 public:
  Growth(const GreyVolume& volume, const std::array<int, 3>& seed, const GrowthSettings& settings,
         const Flags& blocked, const images::Progress& progress)
      : volume_(volume),
        at_{volume.size, volume.step_mm},
        seed_(volume.Index(seed[0], seed[1], seed[2])),
        place_(seed),
        settings_(settings),
        blocked_(blocked),
        progress_(progress) {}

  base::Result<GrownRegion> Run() {
    if (auto status = FindGreys(); !status) return status.error();
    auto region = FindCore();
    if (!region) return region.error();
    if (!Report("moving the border to the edges", 0.45)) return GivenUp();
    if (!MoveBorder(*region)) return GivenUp();
    Finish(*region);
    GrownRegion grown;
    grown.volume_ml = at_.Ml(static_cast<std::size_t>(std::count(region->begin(), region->end(), 1)));
    grown.grey = greys_.median, grown.reach = greys_.reach;
    grown.inside = std::move(*region);
    if (settings_.uses_prior) {
      if (auto status = CheckSize(grown); !status) return status.error();
    }
    return grown;
  }

 private:
  static Error GivenUp() { return {ErrorCode::kCancelled, "growing was given up; nothing has changed"}; }
  bool Report(std::string_view what, double part) {
    if (progress_) progress_(what, part);
    return !settings_.stop.stop_requested();
  }

  base::Status FindGreys() {
    const auto ball = FindBall(at_, place_, settings_.prior.click_mm);
    std::vector<float> raw;
    for (const std::size_t i : ball) raw.push_back(volume_.values[i]);
    const double there = Median(raw);
    if (there <= kBlack || there >= kWhite) {
      return Refused(there <= kBlack
                         ? "the click lies in air; click into the middle of the organ"
                         : "the click lies in bone, or in gas or contrast that is white; click into the "
                           "middle of the organ");
    }
    if (settings_.uses_prior && (there < settings_.greys[0] || there > settings_.greys[1])) {
      return Refused(std::string("the greys around the click are ") +
                     (there < settings_.greys[0] ? "too dark" : "too bright") +
                     " for this organ; choose the organ that is meant, or click into it");
    }
    const double noise = FindNoise(volume_, ball);
    if (!Report("smoothing", 0.0)) return GivenUp();
    smooth_ = Smooth(volume_, at_, kEdgeDeviations * noise);
    std::vector<float> greys, away;
    for (const std::size_t i : ball) greys.push_back(smooth_[i]);
    greys_.median = Median(greys);
    for (const std::size_t i : ball)
      away.push_back(static_cast<float>(std::fabs(smooth_[i] - greys_.median)));
    const double deviation = std::max(kToDeviation * Median(away), 0.4 * noise);
    // what is smooth has hardly any noise left; steps much above it are borders
    if (deviation > std::max(2.5 * noise, 12.0)) {
      return Refused(
          "the click lies on a border: the greys around it differ too much; click into the middle of the "
          "organ");
    }
    greys_.reach = std::max(kLeastReach, kReachDeviations * deviation);
    const auto others = std::count_if(away.begin(), away.end(), [&](float a) { return a > greys_.reach; });
    if (settings_.uses_prior &&
        static_cast<double>(others) > kMostOthers * static_cast<double>(away.size())) {
      return Refused(
          "the click lies on a border, or the organ is too thin there; click into the middle, where it is "
          "thick");
    }
    return {};
  }

  /// What hangs together by its grey, opened and closed.
  base::Result<Flags> FindCore() {
    if (!Report("growing", 0.2)) return GivenUp();
    std::vector<float> share(smooth_.size());
    at_.ForVoxels([&](std::size_t i) {
      const bool is_free = blocked_.empty() || blocked_[i] == 0;
      share[i] = is_free && std::fabs(smooth_[i] - greys_.median) <= greys_.reach ? 1.0f : 0.0f;
    });
    // single voxels that noise took out or in
    Blur(share, at_, 0.6 * std::max(at_.step[0], at_.step[1]));
    const Flags alike = Where(share, at_, [](float part) { return part > 0.5f; });
    if (!settings_.uses_prior) {
      Flags region = FindPart(alike, at_, seed_);
      if (region[seed_] == 0)
        return Refused("the click lies on a border; click into the middle of the organ");
      return region;
    }
    const ShapePrior& prior = settings_.prior;
    const auto depth = CalcDistances(Invert(alike), at_.size, at_.step);
    const float opening = static_cast<float>(prior.opening_mm);
    const Flags cores = Where(depth, at_, [&](float d) { return d > opening; });
    const std::size_t start = FindStart(cores);
    if (start == cores.size()) {
      return Refused("the organ is too thin where the click lies; click where it is thicker");
    }
    if (!Report("cutting bridges", 0.3)) return GivenUp();
    const auto to_core = CalcDistances(FindPart(cores, at_, start), at_.size, at_.step);
    // thin tips that the opening took come back as far as the border may move
    const float back = static_cast<float>(prior.opening_mm + prior.band_mm);
    Flags region(alike.size());
    at_.ForVoxels([&](std::size_t i) { region[i] = alike[i] != 0 && to_core[i] <= back ? 1 : 0; });
    region = FindPart(region, at_, start);
    if (!Report("closing over vessels", 0.4)) return GivenUp();
    CloseOverVessels(region);
    return region;
  }

  /// The core's voxel nearest to the click, within the opening's width of it.
  std::size_t FindStart(const Flags& cores) const {
    const double width = 2.5 * settings_.prior.opening_mm + 2.0;
    std::size_t best = cores.size();
    double least = 1e300;
    for (const std::size_t i : FindBall(at_, place_, width)) {
      if (cores[i] == 0) continue;
      const auto p = at_.Place(i);
      double away = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double aside = (p[axis] - place_[axis]) * at_.step[axis];
        away += aside * aside;
      }
      if (away < least) least = away, best = i;
    }
    return best;
  }

  void CloseOverVessels(Flags& region) const {
    const float closing = static_cast<float>(settings_.prior.closing_mm);
    if (closing > 0) {
      const auto away = CalcDistances(region, at_.size, at_.step);
      const Flags wide = Where(away, at_, [&](float d) { return d <= closing; });
      const auto inside = CalcDistances(Invert(wide), at_.size, at_.step);
      at_.ForVoxels([&](std::size_t i) {
        const bool is_free = blocked_.empty() || blocked_[i] == 0;
        const bool is_vessel = std::fabs(smooth_[i] - greys_.median) < kVesselReaches * greys_.reach;
        if (inside[i] > closing && is_vessel && is_free) region[i] = 1;
      });
    }
    FillHoles(region, at_);
  }

  /// Threshold dynamics within the band around where the border is.
  bool MoveBorder(Flags& region) {
    const auto out = CalcDistances(region, at_.size, at_.step);
    const auto in = CalcDistances(Invert(region), at_.size, at_.step);
    const float band = static_cast<float>(settings_.prior.band_mm);
    const double least = 2 * greys_.reach;
    std::vector<float> contrast[2];  // of what lies beside the border: darker, brighter
    for (int round = 0; round < kRounds; ++round) {
      if (!Report("moving the border to the edges", 0.45 + 0.5 * round / kRounds)) return false;
      if (round % 4 == 0) {
        for (const bool is_brighter : {false, true})
          contrast[is_brighter] = FindContrast(region, is_brighter);
      }
      std::vector<float> share(region.begin(), region.end());
      Blur(share, at_, kBorderMm);
      bool has_changed = false;
      Flags next = region;
      at_.ForVoxels([&](std::size_t i) {
        if (out[i] > band || in[i] > band) return;
        if (!blocked_.empty() && blocked_[i] != 0) {
          next[i] = 0;
          return;
        }
        const double away = smooth_[i] - greys_.median;
        const double half = 0.5 * std::max<double>(contrast[away > 0][i], least);
        const double data = std::clamp(std::fabs(away) / half - 1, -1.0, 1.0);
        next[i] = share[i] - 0.5 - kDataWeight * data > 0 ? 1 : 0;
      });
      has_changed = next != region;
      region.swap(next);
      if (!has_changed) break;
    }
    return true;
  }

  /// By how much the greys outside of the region differ from the organ's, near each voxel; those that differ most
  /// count most, as a voxel that both share says little.
  std::vector<float> FindContrast(const Flags& region, bool is_brighter) const {
    std::vector<float> first(region.size(), 0.0f), second(region.size(), 0.0f);
    at_.ForVoxels([&](std::size_t i) {
      const double away = smooth_[i] - greys_.median;
      if (region[i] != 0 || (away > 0) != is_brighter || std::fabs(away) < greys_.reach) return;
      first[i] = static_cast<float>(std::fabs(away));
      second[i] = first[i] * first[i];
    });
    Blur(first, at_, kBesideMm);
    Blur(second, at_, kBesideMm);
    at_.ForVoxels([&](std::size_t i) { first[i] = first[i] > 1e-3f ? second[i] / first[i] : 0.0f; });
    return first;
  }

  /// One part without holes, with its wall.
  void Finish(Flags& region) const {
    std::size_t start = seed_;
    if (region[start] == 0) {
      for (const std::size_t i : FindBall(at_, place_, 3 * settings_.prior.opening_mm + 3)) {
        if (region[i] != 0) start = i;
      }
    }
    region = FindPart(region, at_, start);
    if (!settings_.uses_prior) return;
    FillHoles(region, at_);
    TakeTipsOff(region, start);
    if (settings_.prior.wall_mm <= 0) return;
    // the border lies half a voxel beyond the centres
    const float wall = static_cast<float>(settings_.prior.wall_mm + 0.25 * (at_.step[0] + at_.step[1]));
    const auto away = CalcDistances(region, at_.size, at_.step);
    at_.ForVoxels([&](std::size_t i) {
      if (away[i] <= wall && (blocked_.empty() || blocked_[i] == 0)) region[i] = 1;
    });
  }

  /// What partial volume made alike: between bright and dark it has the grey of what lies in between.
  void TakeTipsOff(Flags& region, std::size_t start) const {
    const float tip = static_cast<float>(settings_.prior.tip_mm);
    if (tip <= 0) return;
    const auto depth = CalcDistances(Invert(region), at_.size, at_.step);
    const Flags thick = Where(depth, at_, [tip](float d) { return d > tip; });
    const auto away = CalcDistances(thick, at_.size, at_.step);
    Flags blunt(region.size());
    at_.ForVoxels([&](std::size_t i) { blunt[i] = region[i] != 0 && away[i] <= tip ? 1 : 0; });
    // an organ that is thin all over stays as it is
    Flags part = FindPart(blunt, at_, start);
    if (part[start] != 0) region = std::move(part);
  }

  base::Status CheckSize(const GrownRegion& grown) const {
    const ShapePrior& prior = settings_.prior;
    const std::string ml = std::to_string(base::RoundTo<std::int64_t>(grown.volume_ml)) + " mL";
    const std::string remedy = "; click elsewhere in it, or draw it by hand";
    if (grown.volume_ml < prior.least_ml)
      return Refused("what grew from the click measures " + ml + ", too little for the organ" + remedy);
    if (grown.volume_ml > prior.most_ml)
      return Refused("what grew from the click measures " + ml +
                     ", too much for the organ: it ran over into a "
                     "neighbour of the same grey" +
                     remedy);
    std::array<int, 3> low = at_.size, high = {-1, -1, -1};
    for (std::size_t i = 0; i < grown.inside.size(); ++i) {
      if (grown.inside[i] == 0) continue;
      const auto p = at_.Place(i);
      for (int axis = 0; axis < 3; ++axis)
        low[axis] = std::min(low[axis], p[axis]), high[axis] = std::max(high[axis], p[axis]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = (high[axis] - low[axis] + 1) * at_.step[axis];
      if (extent > prior.most_mm[axis])
        return Refused("what grew from the click is " + std::to_string(base::RoundTo<std::int64_t>(extent)) +
                       " mm long, too long for the organ: it ran over into a neighbour of the same grey" +
                       remedy);
    }
    return {};
  }

  const GreyVolume& volume_;
  Lattice at_;
  std::size_t seed_;
  std::array<int, 3> place_;
  const GrowthSettings& settings_;
  const Flags& blocked_;
  const images::Progress& progress_;
  std::vector<float> smooth_;
  Greys greys_;
};

/// Squares of the distances along one line, from those across it: the lower envelope of parabolas.
void TransformLine(std::vector<float>& f, double step, std::vector<int>& at, std::vector<double>& from,
                   std::vector<float>& out) {
  const int n = static_cast<int>(f.size());
  at.resize(n), from.resize(n + 1), out.resize(n);
  const double square = step * step;
  int last = -1;
  for (int q = 0; q < n; ++q) {
    if (f[q] >= kNowhere) continue;
    double meets = -std::numeric_limits<double>::infinity();
    while (last >= 0) {
      const int p = at[last];
      meets = ((f[q] + square * q * q) - (f[p] + square * p * p)) / (2 * square * (q - p));
      if (meets > from[last]) break;
      --last;
    }
    if (last < 0) meets = -std::numeric_limits<double>::infinity();
    ++last;
    at[last] = q, from[last] = meets;
  }
  if (last < 0) return out.assign(n, kNowhere);
  from[last + 1] = std::numeric_limits<double>::infinity();
  for (int q = 0, k = 0; q < n; ++q) {
    while (from[k + 1] < q) ++k;
    const double d = step * (q - at[k]);
    out[q] = static_cast<float>(d * d + f[at[k]]);
  }
}

}  // namespace

std::optional<ShapePrior> FindShapePrior(roles::OrganRole organ) {
  ShapePrior prior;
  if (organ == roles::OrganRole::kLiver) {
    // a liver measures 1.0 to 2.5 L; diseased ones are larger or smaller
    prior = {6.0, 5.0, 6.0, 5.0, 2.0, 0.0, 400, 4500, {320, 260, 320}, {-20, 260}};
    return prior;
  }
  if (organ == roles::OrganRole::kGallbladder) {
    // 7 to 10 cm long, 3 to 4 cm across, 30 to 50 mL; a hydrops is several times that. The wall measures 2 to 3 mm.
    prior = {3.0, 2.2, 2.0, 3.0, 2.2, 2.0, 3, 400, {170, 170, 170}, {-30, 75}};
    return prior;
  }
  return std::nullopt;
}

std::vector<float> CalcDistances(const std::vector<std::uint8_t>& set, const std::array<int, 3>& size,
                                 const std::array<double, 3>& step_mm) {
  const Lattice at{size, step_mm};
  TROCAR_ASSERT(set.size() == at.Count());
  std::vector<float> squares(set.size());
  at.ForVoxels([&](std::size_t i) { squares[i] = set[i] != 0 ? 0.0f : kNowhere; });
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t stride = at.Stride(axis);
    at.ForLines(axis, [&](std::size_t first) {
      thread_local std::vector<float> line, out;
      thread_local std::vector<int> places;
      thread_local std::vector<double> from;
      line.resize(size[axis]);
      for (int i = 0; i < size[axis]; ++i) line[i] = squares[first + i * stride];
      TransformLine(line, step_mm[axis], places, from, out);
      for (int i = 0; i < size[axis]; ++i) squares[first + i * stride] = out[i];
    });
  }
  at.ForVoxels([&](std::size_t i) { squares[i] = std::sqrt(squares[i]); });
  return squares;
}

base::Result<GrownRegion> GrowRegion(const GreyVolume& volume, const std::array<int, 3>& seed,
                                     const GrowthSettings& settings, const std::vector<std::uint8_t>& blocked,
                                     const images::Progress& progress) {
  for (int axis = 0; axis < 3; ++axis) TROCAR_ASSERT(seed[axis] >= 0 && seed[axis] < volume.size[axis]);
  TROCAR_ASSERT(blocked.empty() || blocked.size() == volume.values.size());
  return Growth(volume, seed, settings, blocked, progress).Run();
}

}  // namespace trocar::contours
