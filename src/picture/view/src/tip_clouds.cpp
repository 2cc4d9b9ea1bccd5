// SPDX-License-Identifier: Apache-2.0
#include "tip_clouds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "trocar/math/random.h"

namespace trocar::view {
namespace {

using math::Vec3;
using render::Material;

constexpr double kFlight = 0.09;      // m that a jet is drawn where it meets no tissue
constexpr double kHitWidth = 0.0065;  // m from the jet's middle to a node of the tissue that it meets
constexpr int kJetPieces = 9;
constexpr int kJetThreads = 16;
constexpr double kTurn = 2.399963;  // rad between successive threads
constexpr double kSpread = 0.10;    // of the way: how much wider the jet grows
constexpr double kStrand = 0.0013;  // m, wide enough to be clear at its edges
constexpr int kDrops = 26;
constexpr double kSplashLife = 0.11;   // s
constexpr double kSplashSpeed = 0.28;  // m/s
constexpr double kDrop = 0.00042;      // m
constexpr int kInflows = 6;
constexpr double kInflowReach = 0.0045;  // m round the tip from where liquid is drawn
constexpr int kPuffs = 16;
constexpr double kPuffLife = 0.9;                         // s
constexpr double kRise = 0.030;                           // m/s
constexpr double kPuffStart = 0.0012, kPuffEnd = 0.0120;  // m
constexpr double kPuffOpacity = 0.50;
constexpr double kNoSteamChar = 0.7;  // of tissue that is as good as dry
constexpr double kNear = 0.012;       // m round the source where tissue counts

double Radius(const instrument::Tool& tool) {
  return instrument::kSuctionBore * tool.shaft_radius;
}

/// How far along a line from a tip the first tissue lies [m].
std::optional<double> FindHit(const simulation::Snapshot& snapshot, const Vec3& from, const Vec3& way) {
  double first = kFlight;
  bool has_hit = false;
  for (const Vec3& p : snapshot.positions) {
    const double along = math::Dot(p - from, way);
    if (along <= 0.0 || along >= first) continue;
    if (math::SquaredNorm(p - from - along * way) > kHitWidth * kHitWidth) continue;
    first = along;
    has_hit = true;
  }
  return has_hit ? std::optional(first) : std::nullopt;
}

/// What most of the pool is.
Material LiquidOf(const surgery::FluidLedger& ledger) {
  const double blood = ledger.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].pooled;
  const double bile = ledger.fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].pooled;
  // a little blood colours much water
  if (blood > 0.05 * ledger.rinse_pooled && blood >= bile) return Material::kBlood;
  return bile > 0.2 * ledger.rinse_pooled ? Material::kBile : Material::kRinse;
}

}  // namespace

void AddRinse(render::Frame& frame, const simulation::Snapshot& snapshot, const instrument::Tool& tool,
              const math::Pose& X_world_tool, double rate) {
  const double bore = Radius(tool), speed = rate / (M_PI * bore * bore);
  const Vec3 from = X_world_tool.translation, way = math::Rotate(X_world_tool.rotation, {0, 0, -1});
  const std::optional<double> hit = FindHit(snapshot, from, way);
  const double length = hit.value_or(kFlight);
  const Vec3 u = math::AnyPerpendicular(way), w = math::Cross(way, u);
  const auto at = [&](double far) {
    const double t = far / speed;
    return from + far * way + (0.5 * t * t) * snapshot.gravity;
  };
  for (int i = 0; i < kJetPieces; ++i) {
    const double near = length * i / kJetPieces, far = length * (i + 1) / kJetPieces;
    for (int k = 0; k < kJetThreads; ++k) {
      const double angle = kTurn * k + 0.9 * i, out = 0.62 * std::sqrt((k + 0.5) / kJetThreads);
      const Vec3 aside = std::cos(angle) * u + std::sin(angle) * w;
      frame.fibres.push_back({at(near) + (out * (bore + kSpread * near)) * aside,
                              at(far) + (out * (bore + kSpread * far)) * aside, kStrand, 0.0004,
                              Material::kRinse,
                              static_cast<std::uint32_t>(snapshot.tick / 4 + 97 * i + 13 * k)});
    }
  }
  if (!hit) return;
  // drops that leave the place one after the other
  const Vec3 place = at(length);
  for (std::uint32_t i = 0; i < kDrops; ++i) {
    const double turns = snapshot.time / kSplashLife + static_cast<double>(i) / kDrops,
                 round = std::floor(turns);
    math::Random random(1000 * static_cast<std::uint64_t>(std::max(0.0, round)) + i);
    const double age = kSplashLife * (turns - round);
    const Vec3 out = math::Normalized(random.Uniform(-1, 1) * u + random.Uniform(-1, 1) * w -
                                      random.Uniform(0.25, 0.9) * way);
    const double fast = kSplashSpeed * random.Uniform(0.3, 1.0);
    frame.blobs.push_back({place + (fast * age) * out + (0.5 * age * age) * snapshot.gravity,
                           kDrop * random.Uniform(0.5, 1.3), Material::kRinse, i});
  }
  // mist over the place
  for (int i = 0; i < 3; ++i)
    frame.puffs.push_back({place - (0.003 * (i + 1)) * way, 0.005 + 0.002 * i, 0.10});
}

void AddSuction(render::Frame& frame, const simulation::Snapshot& snapshot, const instrument::Tool& tool,
                const math::Pose& X_world_tool, double pool_reach) {
  const surgery::FluidLedger& ledger = snapshot.operation.flow.ledger;
  const double pooled = ledger.Pooled();
  const Vec3 tip = X_world_tool.translation;
  // the pool as a half sphere, as suction reckons with it
  const double radius = std::cbrt(pooled * 3.0 / (2.0 * M_PI));
  if (!(pooled > 0.0) || math::Distance(tip, snapshot.operation.flow.p_world_pool) > radius + pool_reach)
    return;
  const Material liquid = LiquidOf(ledger);
  const Vec3 way = math::Rotate(X_world_tool.rotation, {0, 0, -1}), u = math::AnyPerpendicular(way),
             w = math::Cross(way, u);
  const double bore = Radius(tool);
  for (int i = 0; i < kInflows; ++i) {
    const double angle = kTurn * i + 1.3 * snapshot.time;
    const Vec3 aside = std::cos(angle) * u + std::sin(angle) * w;
    const Vec3 start = tip + kInflowReach * (0.45 + 0.06 * i) * aside + (0.35 * kInflowReach) * way;
    const Vec3 end = tip + (0.5 * bore) * aside;
    frame.fibres.push_back({start, end, kStrand, 0.0008, liquid, static_cast<std::uint32_t>(31 * i)});
  }
}

void AddSteam(render::Frame& frame, const simulation::Snapshot& snapshot, const Vec3& p_world_source) {
  // wet is what has not been charred
  const std::vector<float>& charring = snapshot.operation.charring;
  double nearest = kNear, dry = 0;
  bool has_tissue = false;
  for (std::size_t i = 0; i < std::min(charring.size(), snapshot.positions.size()); ++i) {
    const double distance = math::Distance(snapshot.positions[i], p_world_source);
    if (distance >= nearest) continue;
    nearest = distance;
    dry = charring[i];
    has_tissue = true;
  }
  const double wet = has_tissue ? std::clamp(1.0 - dry / kNoSteamChar, 0.0, 1.0) : 0.0;
  if (wet <= 0.0) return;
  const Vec3 up = -math::Normalized(snapshot.gravity, {0, 0, -1}), u = math::AnyPerpendicular(up),
             w = math::Cross(up, u);
  for (std::uint32_t i = 0; i < kPuffs; ++i) {
    const double turns = snapshot.time / kPuffLife + static_cast<double>(i) / kPuffs,
                 round = std::floor(turns);
    math::Random random(7919 * static_cast<std::uint64_t>(std::max(0.0, round)) + i);
    const double age = turns - round;  // in lives
    const double sway = 0.006 * age, a = random.Uniform(-1, 1), b = random.Uniform(-1, 1);
    const Vec3 centre =
        p_world_source + (kRise * kPuffLife * age * random.Uniform(0.6, 1.2)) * up + sway * (a * u + b * w);
    // born within a tenth of its life, then thinner the wider it is
    const double fresh = std::min(1.0, 10.0 * age) * (1.0 - age) * (1.0 - age);
    frame.puffs.push_back(
        {centre, kPuffStart + (kPuffEnd - kPuffStart) * std::sqrt(age), kPuffOpacity * wet * fresh});
  }
}

}  // namespace trocar::view
