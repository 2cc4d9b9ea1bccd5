// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/intelligent_scissors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/contours/edge_field.h"
#include "trocar/math/elementary.h"

namespace trocar::contours {

using math::Vec2;

namespace {

constexpr std::array<int, 8> kStepX = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr std::array<int, 8> kStepY = {0, 1, 1, 1, 0, -1, -1, -1};
constexpr std::uint8_t kSeed = 8, kUnreached = 9;
constexpr float kCostUnits = 64.0f;  // whole-number costs for the bucket queue: units of a step's cost 1
constexpr float kDiagonal = 1.41421356f;
constexpr double kStrongShare = 0.98;  // gradients above this share of the picture all count as strongest

/// Colour gradient: the direction in which the colours change most, and how much (Di Zenzo, "A note on the
/// gradient of a multi-image", CVGIP 1986).
struct Gradient {
  float x, y, size;  // unit vector; change [grey levels / pixel]
};

Gradient CalcGradient(const EdgeField& field, int x, int y) {
  const int left = std::max(0, x - 1), right = std::min(field.Width() - 1, x + 1);
  const int up = std::max(0, y - 1), down = std::min(field.Height() - 1, y + 1);
  float xx = 0, xy = 0, yy = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float gx = (field.At(right, y)[c] - field.At(left, y)[c]) / static_cast<float>(right - left);
    const float gy = (field.At(x, down)[c] - field.At(x, up)[c]) / static_cast<float>(down - up);
    xx += gx * gx, xy += gx * gy, yy += gy * gy;
  }
  const float spread = std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy);
  const float largest = 0.5f * (xx + yy + spread);
  if (!(largest > 0)) return {0, 0, 0};
  const auto [sine, cosine] = math::SinCos(0.5 * math::Atan2(2 * xy, xx - yy));
  return {static_cast<float>(cosine), static_cast<float>(sine), std::sqrt(largest)};
}

}  // namespace

IntelligentScissors::IntelligentScissors(const images::ColorImage& image, const ScissorsSettings& settings)
    : settings_(settings), width_(image.width), height_(image.height) {
  TROCAR_ASSERT(width_ >= 3 && height_ >= 3);
  TROCAR_ASSERT(settings.blur_px > 0 && settings.reach_px >= 8 && settings.reach_px <= 1000);
  CalcCosts(image);
}

void IntelligentScissors::CalcCosts(const images::ColorImage& image) {
  const EdgeField field(image, settings_.blur_px);
  const std::size_t count = static_cast<std::size_t>(width_) * height_;
  std::vector<float> size(count);
  edge_x_.resize(count), edge_y_.resize(count);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width_ + x;
      const Gradient g = CalcGradient(field, x, y);
      size[i] = g.size;
      edge_x_[i] = -g.y, edge_y_[i] = g.x;
    }
  }
  std::vector<float> sorted = size;
  const auto strong =
      sorted.begin() + base::TruncateTo<std::ptrdiff_t>(kStrongShare * static_cast<double>(count - 1));
  std::nth_element(sorted.begin(), strong, sorted.end());
  const float strongest = std::max(*strong, 1e-6f);

  // ridges of the gradient are where the second derivative across the edge is zero
  static_cost_.resize(count);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width_ + x;
      const int dx = base::RoundTo<int>(edge_y_[i]), dy = base::RoundTo<int>(-edge_x_[i]);
      const auto size_at = [&](int u, int v) {
        return size[static_cast<std::size_t>(std::clamp(v, 0, height_ - 1)) * width_ +
                    std::clamp(u, 0, width_ - 1)];
      };
      const bool is_ridge =
          size[i] > 0 && size[i] >= size_at(x + dx, y + dy) && size[i] >= size_at(x - dx, y - dy);
      const float strength = std::min(1.0f, size[i] / strongest);
      // a ridge counts as much as it is strong, or noise in flat areas would be full of free paths
      static_cost_[i] = static_cast<float>(settings_.crossing_weight) * (is_ridge ? 1.0f - strength : 1.0f) +
                        static_cast<float>(settings_.gradient_weight) * (1.0f - strength);
    }
  }
}

void IntelligentScissors::SetSeed(const Vec2& seed) {
  seed_x_ = base::RoundTo<int>(std::clamp(seed.x, 0.0, width_ - 1.0));
  seed_y_ = base::RoundTo<int>(std::clamp(seed.y, 0.0, height_ - 1.0));
  x0_ = std::max(0, seed_x_ - settings_.reach_px), y0_ = std::max(0, seed_y_ - settings_.reach_px);
  window_width_ = std::min(width_ - 1, seed_x_ + settings_.reach_px) - x0_ + 1;
  window_height_ = std::min(height_ - 1, seed_y_ + settings_.reach_px) - y0_ + 1;
  const std::size_t count = static_cast<std::size_t>(window_width_) * window_height_;
  came_from_.assign(count, kUnreached);

  // Dial's algorithm: Dijkstra with one bucket a cost, used round and round
  const double dearest = settings_.crossing_weight + settings_.gradient_weight + settings_.direction_weight;
  const auto span = base::CeilTo<std::size_t>(kDiagonal * kCostUnits * (dearest + 0.1)) + 2;
  std::vector<std::vector<std::uint32_t>> buckets(span);
  std::vector<std::uint32_t> reached(count, ~0u);
  std::vector<std::uint8_t> is_done(count, 0);
  const auto start = static_cast<std::uint32_t>((seed_y_ - y0_) * window_width_ + seed_x_ - x0_);
  reached[start] = 0, came_from_[start] = kSeed;
  buckets[0].push_back(start);
  std::size_t waiting = 1;
  const auto direction_weight = static_cast<float>(settings_.direction_weight);
  for (std::uint32_t cost = 0; waiting > 0; ++cost) {
    auto& bucket = buckets[cost % span];
    for (std::size_t b = 0; b < bucket.size(); ++b) {  // grows while it is read when a step costs nothing
      const std::uint32_t here = bucket[b];
      --waiting;
      if (is_done[here]) continue;
      is_done[here] = 1;
      const int wx = static_cast<int>(here % window_width_), wy = static_cast<int>(here / window_width_);
      const std::size_t p = static_cast<std::size_t>(y0_ + wy) * width_ + x0_ + wx;
      for (std::uint8_t s = 0; s < 8; ++s) {
        const int tx = wx + kStepX[s], ty = wy + kStepY[s];
        if (tx < 0 || ty < 0 || tx >= window_width_ || ty >= window_height_) continue;
        const auto to = static_cast<std::uint32_t>(ty * window_width_ + tx);
        if (is_done[to]) continue;
        const std::size_t q = static_cast<std::size_t>(y0_ + ty) * width_ + x0_ + tx;
        const float length = s % 2 == 1 ? kDiagonal : 1.0f;
        const float ux = static_cast<float>(kStepX[s]) / length, uy = static_cast<float>(kStepY[s]) / length;
        // how far the step turns away from the edges at both of its ends
        const float across = 1.0f - 0.5f * (std::fabs(ux * edge_x_[p] + uy * edge_y_[p]) +
                                            std::fabs(ux * edge_x_[q] + uy * edge_y_[q]));
        const float step = length * (static_cost_[q] + direction_weight * across + 0.02f);
        const std::uint32_t total = cost + base::TruncateTo<std::uint32_t>(step * kCostUnits + 0.5f);
        if (total >= reached[to]) continue;
        reached[to] = total;
        came_from_[to] = s;
        buckets[total % span].push_back(to);
        ++waiting;
      }
    }
    bucket.clear();
  }
}

std::vector<Vec2> IntelligentScissors::PathTo(const Vec2& target) const {
  std::vector<Vec2> path;
  if (came_from_.empty()) return path;
  const int target_x = base::RoundTo<int>(std::clamp(target.x, 0.0, width_ - 1.0));
  const int target_y = base::RoundTo<int>(std::clamp(target.y, 0.0, height_ - 1.0));
  int x = std::clamp(target_x, x0_, x0_ + window_width_ - 1);
  int y = std::clamp(target_y, y0_, y0_ + window_height_ - 1);
  // beyond reach: straight on
  const int beyond = std::max(std::abs(target_x - x), std::abs(target_y - y));
  for (int i = beyond; i > 0; --i) {
    path.push_back({std::round(x + (target_x - x) * static_cast<double>(i) / beyond),
                    std::round(y + (target_y - y) * static_cast<double>(i) / beyond)});
  }
  while (true) {
    path.push_back({static_cast<double>(x), static_cast<double>(y)});
    const std::uint8_t step = came_from_[static_cast<std::size_t>(y - y0_) * window_width_ + x - x0_];
    if (step >= kSeed) break;
    x -= kStepX[step], y -= kStepY[step];
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<Vec2> SimplifyPath(std::span<const Vec2> path, double tolerance_px) {
  if (path.size() < 3) return {path.begin(), path.end()};
  std::vector<std::uint8_t> is_kept(path.size(), 0);
  is_kept.front() = is_kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> parts = {{0, path.size() - 1}};
  while (!parts.empty()) {
    const auto [first, last] = parts.back();
    parts.pop_back();
    const Vec2 chord = path[last] - path[first];
    const double squared = Dot(chord, chord);
    double furthest = tolerance_px;
    std::size_t at = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const Vec2 away = path[i] - path[first];
      const double t = squared > 0 ? std::clamp(Dot(away, chord) / squared, 0.0, 1.0) : 0.0;
      if (const double distance = Norm(away - t * chord); distance > furthest) furthest = distance, at = i;
    }
    if (at == 0) continue;
    is_kept[at] = 1;
    parts.push_back({first, at});
    parts.push_back({at, last});
  }
  std::vector<Vec2> kept;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (is_kept[i]) kept.push_back(path[i]);
  }
  return kept;
}

}  // namespace trocar::contours
