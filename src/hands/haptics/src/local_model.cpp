// SPDX-License-Identifier: Apache-2.0
#include "trocar/haptics/local_model.h"

#include <algorithm>
#include <array>

#include "segment_solver.h"
#include "trocar/base/assert.h"

namespace trocar::haptics {
namespace {

/// Of the linear model: most steps, shortest of them as a share, and the imbalance at which they end [N].
constexpr int kMaxLinearSteps = 30;
constexpr double kShortestStep = 1.0 / 64;
constexpr double kLinearBalance = 1e-9;

Matrix3 ToMatrix(const tissue::Matrix3Rows& rows) noexcept {
  Matrix3 m;
  for (int row = 0; row < 3; ++row) m.row(row) = ToEigen(rows[row]).transpose();
  return m;
}

tissue::Matrix3Rows ToRows(const Matrix3& m) noexcept {
  return {FromEigen(m.row(0).transpose()), FromEigen(m.row(1).transpose()), FromEigen(m.row(2).transpose())};
}

/// Force per metre of the coupling when the tool follows the hand by `derivative` [N/m].
tissue::Matrix3Rows CalcJacobian(double coupling_stiffness, const Matrix3& derivative) noexcept {
  return ToRows(coupling_stiffness * (derivative - Matrix3::Identity()));
}

}  // namespace

struct LocalModel::Content {
  explicit Content(const LocalModelSettings& given) : settings(given) {}

  LocalModelSettings settings;
  tissue::LocalPatch::Kind kind = tissue::LocalPatch::Kind::kNone;
  bool is_new = false;
  SegmentSolver segment;
  // linear
  math::Vec3 force, p_world_cut;  // force: without that of the presses
  Matrix3 jacobian = Matrix3::Zero();
  std::uint32_t press_count = 0;
  std::array<tissue::LocalPatch::Press, tissue::LocalPatch::kMaxPresses> presses;

  bool has_tool = false;
  math::Vec3 tool;        // [m]
  math::Vec3 last_force;  // that was answered in the tick before [N]
  math::Vec3 step;        // between the force before a new segment and its own [N]
  double step_share = 0;

  LocalAnswer Solve(const math::Pose& X_world_hand) noexcept;
  LocalAnswer SolveLinear(const math::Vec3& hand) const noexcept;
  double CalcLinearEnergy(const math::Vec3& hand, const math::Vec3& moved) const noexcept;
  /// Gradient [N] and stiffness [N/m] of that energy.
  void CalcLinearSlope(const math::Vec3& hand, const math::Vec3& moved, math::Vec3& gradient,
                       Matrix3& stiffness) const noexcept;
};

/// Of coupling, tissue and what is pressed, where the tool has gone by `moved` since the cut [J].
double LocalModel::Content::CalcLinearEnergy(const math::Vec3& hand, const math::Vec3& moved) const noexcept {
  const Eigen::Vector3d u = ToEigen(moved);
  double energy = 0.5 * settings.coupling_stiffness * math::SquaredDistance(p_world_cut + moved, hand) -
                  math::Dot(force, moved) - 0.5 * u.dot(jacobian * u);
  for (std::uint32_t i = 0; i < press_count; ++i) {
    const tissue::LocalPatch::Press& press = presses[i];
    const double push = std::max(0.0, press.force + press.stiffness * math::Dot(press.normal, moved));
    energy += 0.5 * push * push / press.stiffness;
  }
  return energy;
}

void LocalModel::Content::CalcLinearSlope(const math::Vec3& hand, const math::Vec3& moved,
                                          math::Vec3& gradient, Matrix3& stiffness) const noexcept {
  const double k = settings.coupling_stiffness;
  stiffness = k * Matrix3::Identity() - jacobian;
  gradient = k * (p_world_cut + moved - hand) - force - FromEigen(jacobian * ToEigen(moved));
  for (std::uint32_t i = 0; i < press_count; ++i) {
    const tissue::LocalPatch::Press& press = presses[i];
    const double push = press.force + press.stiffness * math::Dot(press.normal, moved);
    if (!(push > 0.0)) continue;
    gradient += push * press.normal;
    AddAxial(stiffness, press.normal, press.stiffness);
  }
}

LocalAnswer LocalModel::Content::SolveLinear(const math::Vec3& hand) const noexcept {
  const double k = settings.coupling_stiffness;
  math::Vec3 moved = (has_tool ? tool : hand) - p_world_cut, gradient;
  Matrix3 stiffness;
  CalcLinearSlope(hand, moved, gradient, stiffness);
  // Newton's method; within one set of pressing springs a step is exact
  for (int i = 0; i < kMaxLinearSteps; ++i) {
    const math::Vec3 whole = -FromEigen(stiffness.inverse() * ToEigen(gradient));
    const double before = CalcLinearEnergy(hand, moved), slope = math::Dot(gradient, whole);
    double share = 1.0;
    while (press_count > 0 && share > kShortestStep &&
           CalcLinearEnergy(hand, moved + share * whole) > before + 1e-4 * share * slope)
      share *= 0.5;
    moved += share * whole;
    CalcLinearSlope(hand, moved, gradient, stiffness);
    if (press_count == 0 || math::Norm(gradient) < kLinearBalance) break;
  }
  LocalAnswer answer;
  answer.p_world_tool = p_world_cut + moved;
  answer.force = k * (answer.p_world_tool - hand);
  // nothing presses any more: none at all, not what rounding leaves
  if (math::Norm(answer.force) < kLinearBalance) answer.force = {}, answer.p_world_tool = hand;
  answer.jacobian = CalcJacobian(k, k * stiffness.inverse());
  return answer;
}

LocalAnswer LocalModel::Content::Solve(const math::Pose& X_world_hand) noexcept {
  const math::Vec3& hand = X_world_hand.translation;
  if (kind == tissue::LocalPatch::Kind::kLinear) return SolveLinear(hand);
  LocalAnswer answer;
  answer.p_world_tool = hand;
  if (kind == tissue::LocalPatch::Kind::kNone) return answer;
  segment.SetDirection(X_world_hand.rotation);
  const int sweeps = is_new ? settings.first_sweeps : settings.sweeps;
  // the last one runs inwards: what the hand feels comes last
  for (int i = sweeps; i > 0; --i) segment.Sweep(hand, settings.coupling_stiffness, i % 2 == 0, i == sweeps);
  segment.SweepDerivative(settings.coupling_stiffness);
  answer.p_world_tool = segment.GetTool();
  answer.force = settings.coupling_stiffness * (answer.p_world_tool - hand);
  answer.jacobian = CalcJacobian(settings.coupling_stiffness, segment.GetToolDerivative());
  return answer;
}

LocalModel::LocalModel(const LocalModelSettings& settings) : content_(std::make_unique<Content>(settings)) {
  TROCAR_ASSERT(settings.coupling_stiffness > 0.0 && settings.sweeps >= 1 && settings.first_sweeps >= 1);
  TROCAR_ASSERT(settings.blend_time > 0.0 && settings.tick > 0.0);
}
LocalModel::~LocalModel() = default;
LocalModel::LocalModel(LocalModel&&) noexcept = default;
LocalModel& LocalModel::operator=(LocalModel&&) noexcept = default;

void LocalModel::Take(const tissue::LocalPatch& patch) noexcept {
  Content& c = *content_;
  c.kind = patch.kind;
  c.is_new = true;
  c.force = patch.force;
  c.p_world_cut = patch.X_world_tool.translation;
  if (patch.kind == tissue::LocalPatch::Kind::kLinear) {
    c.jacobian = ToMatrix(patch.jacobian);
    c.press_count = patch.press_count;
    std::copy_n(patch.presses.begin(), patch.press_count, c.presses.begin());
    for (std::uint32_t i = 0; i < c.press_count; ++i) c.force += c.presses[i].force * c.presses[i].normal;
    if (c.press_count > 0 && math::Norm(c.force) < kLinearBalance) c.force = {};
  }
  if (patch.kind == tissue::LocalPatch::Kind::kSegment)
    c.segment.Load(patch, c.has_tool ? c.tool : patch.X_world_tool.translation);
}

LocalAnswer LocalModel::Step(const math::Pose& X_world_hand) noexcept {
  Content& c = *content_;
  LocalAnswer answer = c.Solve(X_world_hand);
  c.tool = answer.p_world_tool;
  c.has_tool = true;
  if (c.is_new) {
    c.step = c.last_force - answer.force;
    c.step_share = 1.0;
    c.is_new = false;
  } else {
    c.step_share = std::max(0.0, c.step_share - c.settings.tick / c.settings.blend_time);
  }
  answer.force += c.step_share * c.step;
  answer.is_in_contact = math::SquaredNorm(answer.force) > 0.0;
  c.last_force = answer.force;
  return answer;
}

void LocalModel::Clear() noexcept {
  Content& c = *content_;
  c.kind = tissue::LocalPatch::Kind::kNone;
  c.is_new = false;
  c.has_tool = false;
  c.last_force = {};
  c.step = {};
  c.step_share = 0;
}

}  // namespace trocar::haptics
