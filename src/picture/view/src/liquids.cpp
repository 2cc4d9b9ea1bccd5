// SPDX-License-Identifier: Apache-2.0
#include "liquids.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/geometry/mesh_measures.h"
#include "trocar/surgery/flow_network.h"

namespace trocar::view {
namespace {

using math::Vec3;
using render::Material;

constexpr double kLeastRate = 1e-10;    // m^3/s; slower is not seen
constexpr double kJetRate = 4e-8;       // m^3/s; slower only drips
constexpr double kJetSpeed = 0.10;      // m/s, of the slowest jet
constexpr double kJetGain = 4.0e5;      // 1/m^2: a cystic artery's 1 mL/s leaves with 0.5 m/s
constexpr double kFastest = 1.2;        // m/s
constexpr double kFlight = 0.14;        // s that a jet is drawn
constexpr double kPulse = 1.2;          // 1/s, heart beats
constexpr double kDropRadius = 0.0011;  // m, of a drop of 6 uL
constexpr double kFall = 0.030;         // m that a drop is seen to run
constexpr int kJetPieces = 8;
constexpr double kThread = 0.00085;  // m, of a jet's threads
constexpr int kMostThreads = 7;
constexpr double kWidestRope = 0.0012;                    // m, half of a bundle of them
constexpr double kThreadTurn = 2.399963;                  // rad between turns of successive threads
constexpr double kLeastPool = 1e-8;                       // m^3; less than a drop is no pool
constexpr double kReach = 0.040;                          // m round the lowest place whose hollows fill
constexpr double kLeastSlope = 0.2;                       // cosine; a steeper piece holds no liquid
constexpr double kSpill = 0.014;                          // m, of a pool that overflows
constexpr double kHighest = 0.060;                        // m that a pool may rise
constexpr double kPoolChange = 0.00008;                   // m; less movement leaves the surface as it is
constexpr double kFlatness = 0.30;                        // depth of a pool in cube roots of its volume
constexpr double kShallowest = 0.0010, kDeepest = 0.012;  // m

/// A thick jet is a bundle of threads: one ribbon that faces the lens would look like a sheet.
void AddRope(render::Frame& frame, const Vec3& from, const Vec3& to, double width, Material liquid,
             std::uint32_t seed) {
  const Vec3 along = math::Normalized(to - from, {0, 0, 1});
  const Vec3 u = math::AnyPerpendicular(along), w = math::Cross(along, u);
  const int threads = std::clamp(static_cast<int>(std::ceil(width / kThread)), 1, kMostThreads);
  const double reach = std::min(0.35 * (width - kThread), kWidestRope);
  for (int k = 0; k < threads; ++k) {
    const double angle = kThreadTurn * k, far = reach * std::sqrt(static_cast<double>(k) / threads);
    const Vec3 aside = threads == 1 ? Vec3{} : far * (std::cos(angle) * u + std::sin(angle) * w);
    frame.fibres.push_back({from + aside, to + 1.3 * aside, std::min(width, kThread), 0.2 * reach * (k % 3),
                            liquid, seed + static_cast<std::uint32_t>(k)});
  }
}

void AddJet(render::Frame& frame, const surgery::LeakSnapshot& leak, const Vec3& gravity, double time,
            Material liquid, std::uint32_t seed) {
  double speed = std::min(kFastest, kJetSpeed + kJetGain * leak.rate);
  if (leak.fluid == surgery::Fluid::kBlood) {
    const double beat = 0.5 + 0.5 * std::sin(2.0 * M_PI * kPulse * time);
    speed *= 0.55 + 0.45 * beat * beat;
  }
  const Vec3 velocity = speed * leak.direction;
  const auto at = [&](double t) { return leak.position + t * velocity + (0.5 * t * t) * gravity; };
  // the same rate through every section: where it falls faster it is thinner
  const auto width = [&](double t) {
    return 2.0 * std::sqrt(leak.rate / (M_PI * std::max(0.05, math::Norm(velocity + t * gravity))));
  };
  for (int i = 0; i < kJetPieces; ++i) {
    const double t = kFlight * i / kJetPieces, next = kFlight * (i + 1) / kJetPieces;
    AddRope(frame, at(t), at(next), 1.4 * width(t), liquid, seed + static_cast<std::uint32_t>(16 * i));
    // beads that run along it, the more the farther it has flown
    const double phase = std::fmod(3.1 * time + 0.37 * i, 1.0), bead = t + phase * (next - t);
    frame.blobs.push_back({at(bead), (0.45 + 0.05 * i) * width(bead) * (1.0 + 0.4 * std::sin(2.4 * i)),
                           liquid, seed + static_cast<std::uint32_t>(i)});
  }
}

void AddDrip(render::Frame& frame, const surgery::LeakSnapshot& leak, const Vec3& down, double time,
             Material liquid, std::uint32_t seed) {
  // a bead that swells at the opening, then runs down
  const double volume = 4.0 / 3.0 * M_PI * kDropRadius * kDropRadius * kDropRadius;
  const double beat = std::fmod(time * std::clamp(leak.rate / volume, 0.2, 6.0), 1.0);
  frame.blobs.push_back({leak.position + (0.3 * kDropRadius) * leak.direction,
                         kDropRadius * (0.45 + 0.55 * std::cbrt(beat)), liquid, seed});
  const double fallen = kFall * beat * beat;
  frame.blobs.push_back({leak.position + (0.5 * kDropRadius) * leak.direction + fallen * down,
                         0.85 * kDropRadius, liquid, seed + 1});
}

}  // namespace

void AddStreams(render::Frame& frame, const simulation::Snapshot& snapshot) {
  const simulation::OperationSnapshot& operation = snapshot.operation;
  const Vec3 down = math::Normalized(snapshot.gravity, {0, 0, -1});
  for (std::size_t i = 0; i < std::min(operation.flow.leak_count, operation.flow.leaks.size()); ++i) {
    const surgery::LeakSnapshot& leak = operation.flow.leaks[i];
    if (!(leak.rate > kLeastRate)) continue;
    const Material liquid = leak.fluid == surgery::Fluid::kBlood ? Material::kBlood : Material::kBile;
    const auto seed = static_cast<std::uint32_t>(64 * i);
    if (leak.rate > kJetRate) AddJet(frame, leak, snapshot.gravity, snapshot.time, liquid, seed);
    AddDrip(frame, leak, down, snapshot.time, liquid, seed + 32);
  }
}

std::vector<GroundPiece> MakeGround(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size());
  geometry::CalcVertexNormals(mesh.positions, mesh.triangles, normals);
  const std::vector<double> areas = geometry::CalcVertexAreas(mesh.positions, mesh.triangles);
  std::vector<GroundPiece> ground;
  for (std::size_t v = 0; v < normals.size(); ++v)
    ground.push_back({mesh.positions[v], areas[v] * normals[v]});
  return ground;
}

Pool::Pool(std::vector<geometry::TriangleMesh> scenery) : scenery_(std::move(scenery)) {
  for (const geometry::TriangleMesh& mesh : scenery_) {
    const std::vector<GroundPiece> pieces = MakeGround(mesh);
    ground_.insert(ground_.end(), pieces.begin(), pieces.end());
  }
}

void Pool::Shape(render::Renderer& renderer, render::Frame& frame, const simulation::Snapshot& snapshot,
                 std::vector<GroundShape> organs, std::span<const FatLobule> lobules) {
  if (frame.puddles.empty()) return;
  render::Puddle& puddle = frame.puddles.back();
  for (const geometry::TriangleMesh& mesh : scenery_) organs.push_back({mesh.positions, mesh.triangles});
  shape_.Make(puddle, snapshot.operation.flow.p_world_pool, organs, lobules);
  const std::vector<Vec3>& positions = shape_.Mesh().positions;
  const bool is_same = std::equal(
      positions.begin(), positions.end(), shown_.begin(), shown_.end(),
      [](const Vec3& a, const Vec3& b) { return math::SquaredNorm(a - b) < kPoolChange * kPoolChange; });
  if (!is_same) {
    renderer.RemoveSurface(surface_);
    surface_ = renderer.AddSurface(shape_.Mesh().triangles, shape_.Rest(), Material::kBlood, shape_.Shares());
    std::vector<Vec3> normals(positions.size());
    geometry::CalcVertexNormals(positions, shape_.Mesh().triangles, normals);
    renderer.UpdateSurface(surface_, positions, normals);
    shown_ = positions;
  }
  puddle.surface = surface_;
}

void Pool::AddTo(render::Frame& frame, const simulation::Snapshot& snapshot) const {
  const surgery::FluidLedger& fluids = snapshot.operation.flow.ledger;
  const double volume = fluids.Pooled();
  if (!(volume > kLeastPool)) return;
  const Vec3 up = -math::Normalized(snapshot.gravity, {0, 0, -1});
  const Vec3 lowest = snapshot.operation.flow.p_world_pool;
  struct Column {
    double height, area, side;
  };
  std::vector<Column> columns;
  // a little does not spread: surface tension keeps it about a millimetre thick
  const double reach = std::min(kReach, std::sqrt(volume / (M_PI * kShallowest)));
  double bottom = kHighest, bed = 0;
  for (const GroundPiece& piece : ground_) {
    const Vec3 from = piece.p_world - lowest;
    const double height = math::Dot(from, up), side = math::Norm(from - height * up);
    const double area = math::Dot(piece.area, up);
    // what lies below the lowest place is filled by what nobody sees
    if (side > reach || height < 0.0 || area < kLeastSlope * math::Norm(piece.area)) continue;
    columns.push_back({height, area, side});
    bottom = std::min(bottom, height);
    bed += area;
  }
  render::Puddle puddle{surface_, lowest, up, 0, 0, 0, fluids.rinse_pooled};
  if (bed < 0.1 * M_PI * reach * reach) {
    // no ground: a lens, half as much as a cylinder of its radius and depth
    const double depth = std::clamp(kFlatness * std::cbrt(volume), kShallowest, kDeepest);
    puddle.radius = std::sqrt(2.0 * volume / (M_PI * depth));
    puddle.centre = lowest + depth * up;
  } else {
    double low = bottom, high = bottom + kHighest;
    for (int i = 0; i < 40; ++i) {
      const double level = 0.5 * (low + high);
      double held = 0;
      for (const Column& column : columns) held += column.area * std::max(0.0, level - column.height);
      (held < volume ? low : high) = level;
    }
    // the fuller it is the more runs off sideways, to where nobody sees it
    low = bottom + kSpill * (1.0 - std::exp(-(low - bottom) / kSpill));
    for (const Column& column : columns)
      if (column.height < low) puddle.radius = std::max(puddle.radius, column.side);
    puddle.centre = lowest + low * up;
  }
  puddle.blood = fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBlood)].pooled;
  puddle.bile = fluids.fluids[static_cast<std::size_t>(surgery::Fluid::kBile)].pooled;
  frame.puddles.push_back(puddle);
}

}  // namespace trocar::view
