// SPDX-License-Identifier: Apache-2.0
#include "local_solve.h"

#include <algorithm>
#include <cmath>

#include "trust_region.h"

namespace trocar::tissue {
namespace {

/// Nodes that went farther than this part of the longest move are taken, and so many rings around them [-].
constexpr double kFarShare = 0.2;
constexpr int kRings = 2;
constexpr int kMaxSteps = 8;
constexpr int kMaxLinearIterations = 60;
/// A step is solved until the preconditioned residual is this part of what it was [-].
constexpr double kForcing = 0.03;
/// The part of the error that the preconditioned residual shows [-], for nodes so few that a wave crosses them in a
/// dozen iterations.
constexpr double kSeenShare = 0.1;

}  // namespace

LocalSolve::LocalSolve(const OrderedModel& whole, const OrderedSprings& springs)
    : whole_(&whole), whole_springs_(&springs), linearisation_(springs_) {
  const std::size_t n = std::min<std::size_t>(whole.layout.PaddedNodes(), kMaxNodes), links = n * kMaxRow;
  local_of_.assign(whole.Size(), kNone);
  nodes_.reserve(n);
  whole_entries_.reserve(links);
  for (auto* list : {&model_.graph.starts, &model_.layout.starts}) list->reserve(n + 1);
  for (auto* list : {&model_.graph.others, &model_.layout.others}) list->reserve(links);
  for (auto* values : {&springs_.stiffness, &springs_.rest_length}) values->reserve(links);
  model_.rest.reserve(n), model_.shape.reserve(n), model_.strands.reserve(links);
  load_.constant.reserve(n), load_.is_free.reserve(n), load_.contacts.reserve(kMaxContacts);
  load_.elements.Reserve();
  level_.link_floats = kSpringLinkFloats;
  level_.Reserve({n, links / kSliceNodes});
  linearisation_.Reserve(n, n);
  balance_.residual.reserve(n), balance_.is_pressing.resize(kMaxContacts);
  for (auto* vector : {&position_, &start_, &first_}) vector->reserve(n);
  for (auto* vector : {&step_, &r_, &z_, &p_, &q_}) vector->reserve(n);
}

bool LocalSolve::AddNode(std::uint32_t node) noexcept {
  if (local_of_[node] != kNone) return true;
  if (nodes_.size() == nodes_.capacity()) return false;
  local_of_[node] = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(node);
  return true;
}

/// The nodes that move, in the whole's order, and those that hold them.
bool LocalSolve::FindNodes(const OrderedLoad& load, std::span<const Float4> step, double longest) noexcept {
  const OrderedModel& whole = *whole_;
  for (const std::uint32_t node : nodes_) local_of_[node] = kNone;
  nodes_.clear();
  const auto far = static_cast<float>(kFarShare * longest);
  for (std::uint32_t i = 0; i < whole.Size(); ++i) {
    const Float4& v = step[i];
    if (!(v.x * v.x + v.y * v.y + v.z * v.z > far * far) || !load.is_free[i]) continue;
    if (nodes_.size() == kMaxFree || !AddNode(i)) return false;
  }
  std::size_t ring = 0;
  for (int rings = 0; rings < kRings; ++rings) {
    for (const std::size_t end = nodes_.size(); ring < end; ++ring) {
      const std::uint32_t i = nodes_[ring];
      for (auto h = whole.graph.starts[i]; h < whole.graph.starts[i + 1]; ++h) {
        const std::uint32_t other = whole.graph.others[h];
        if (!load.is_free[other]) continue;
        if (!AddNode(other) || nodes_.size() > kMaxFree) return false;
      }
    }
  }
  std::sort(nodes_.begin(), nodes_.end());
  free_count_ = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t a = 0; a < free_count_; ++a) local_of_[nodes_[a]] = a;
  for (std::uint32_t a = 0; a < free_count_; ++a) {
    const std::uint32_t i = nodes_[a];
    for (auto h = whole.graph.starts[i]; h < whole.graph.starts[i + 1]; ++h) {
      if (!AddNode(whole.graph.others[h])) return false;
    }
  }
  const auto moves = [&](std::uint32_t node) { return local_of_[node] < free_count_; };
  bool fits = true;
  const auto add_nodes = [&](const auto& element) {
    if (!std::any_of(element.nodes.begin(), element.nodes.end(), moves)) return;
    for (const std::uint32_t node : element.nodes) fits = fits && AddNode(node);
  };
  for (const ContactSpring& contact : load.contacts) add_nodes(contact);
  load.elements.ForEach(add_nodes);
  return fits && free_count_ > 0;
}

/// Links with an end that moves, from both ends, as the energy counts them.
bool LocalSolve::SetLinks() noexcept {
  const OrderedModel& whole = *whole_;
  NodeGraph& graph = model_.graph;
  graph.Clear();
  whole_entries_.clear();
  std::uint32_t longest = 0;  // of the rows of a slice
  std::size_t padded = 0;
  for (std::uint32_t a = 0; a < nodes_.size(); ++a) {
    const std::uint32_t i = nodes_[a];
    for (auto h = whole.graph.starts[i]; h < whole.graph.starts[i + 1]; ++h) {
      const std::uint32_t b = local_of_[whole.graph.others[h]];
      if (b == kNone || (!IsFree(a) && !IsFree(b))) continue;
      if (graph.others.size() == graph.others.capacity()) return false;
      graph.others.push_back(b);
      whole_entries_.push_back(whole.layout.Entry(i, h - whole.graph.starts[i]));
    }
    longest = std::max(longest, static_cast<std::uint32_t>(graph.others.size()) - graph.starts.back());
    graph.starts.push_back(static_cast<std::uint32_t>(graph.others.size()));
    if (a % kSliceNodes + 1 < kSliceNodes && a + 1 < nodes_.size()) continue;
    padded += std::size_t{longest} * kSliceNodes;
    longest = 0;
  }
  if (padded > model_.layout.others.capacity()) return false;
  SetSliceLayout(graph, model_.layout);
  level_.SetLayout(model_.layout);
  springs_.stiffness.assign(padded, 0.0), springs_.rest_length.assign(padded, 0.0);
  for (std::uint32_t a = 0; a < nodes_.size(); ++a) {
    for (auto h = graph.starts[a]; h < graph.starts[a + 1]; ++h) {
      const std::size_t entry = model_.layout.Entry(a, h - graph.starts[a]);
      springs_.stiffness[entry] = whole_springs_->stiffness[whole_entries_[h]];
      springs_.rest_length[entry] = whole_springs_->rest_length[whole_entries_[h]];
    }
  }
  return true;
}

void LocalSolve::SetStrands(std::span<const std::uint8_t> strand_is_intact) noexcept {
  strand_is_intact_ = strand_is_intact;
  model_.strands.clear();
  for (const auto& strand : whole_->strands) {
    const std::uint32_t a = local_of_[strand.node], b = local_of_[strand.other];
    if (a == kNone || b == kNone || (!IsFree(a) && !IsFree(b))) continue;
    const auto row = whole_entries_.begin() + model_.graph.starts[a];
    const auto place = static_cast<std::uint32_t>(
        std::find(row, whole_entries_.begin() + model_.graph.starts[a + 1], strand.entry) - row);
    model_.strands.push_back({a, b, strand.strand, model_.layout.Entry(a, place), strand.stiffness});
  }
}

void LocalSolve::SetLoad(const OrderedLoad& load) noexcept {
  load_.constant.clear(), load_.is_free.clear(), load_.contacts.clear(), load_.elements.Clear();
  for (std::uint32_t a = 0; a < nodes_.size(); ++a) {
    load_.constant.push_back(load.constant[nodes_[a]]);
    load_.is_free.push_back(IsFree(a));
  }
  const auto take = [&](const auto& element, auto& to) {
    auto here = element;
    bool is_known = true, moves = false;
    for (std::uint32_t& node : here.nodes) {
      node = local_of_[node];
      is_known = is_known && node != kNone;
      moves = moves || IsFree(node);
    }
    if (is_known && moves) to.push_back(here);
  };
  for (const ContactSpring& contact : load.contacts) take(contact, load_.contacts);
  load.elements.ForEach([&](const auto& element) {
    take(element, load_.elements.Of<std::remove_cvref_t<decltype(element)>>());
  });
  load_.stiffness_scale = load.stiffness_scale, load_.shape_scale = load.shape_scale;
}

bool LocalSolve::Gather(const OrderedLoad& load, std::span<const std::uint8_t> strand_is_intact,
                        std::span<const Float4> step, double longest) noexcept {
  if (!FindNodes(load, step, longest) || !SetLinks()) {
    free_count_ = 0;
    return false;
  }
  SetStrands(strand_is_intact);
  model_.rest.clear(), model_.shape.clear();
  for (const std::uint32_t node : nodes_) {
    model_.rest.push_back(whole_->rest[node]);
    model_.shape.push_back(whole_->shape[node]);
  }
  linearisation_.SetModel(model_);
  SetLoad(load);
  const std::size_t padded = model_.layout.PaddedNodes();
  for (auto* vector : {&position_, &start_, &first_}) vector->resize(padded);
  for (auto* vector : {&balance_.residual, &step_, &r_, &z_, &p_, &q_}) vector->resize(padded);
  return true;
}

void LocalSolve::AddForce(std::span<const Float4> force, double factor) noexcept {
  for (std::uint32_t a = 0; a < free_count_; ++a) load_.constant[a] += factor * ToDouble(force[nodes_[a]]);
}

LocalSolve::Report LocalSolve::Solve(const Kernels& kernels, Workers& workers, double tolerance,
                                     double edge_length, std::span<Double4> position) noexcept {
  Report report;
  linearisation_.SetLoad(load_, strand_is_intact_, level_);
  for (std::uint32_t a = 0; a < nodes_.size(); ++a) position_[a] = position[nodes_[a]];
  std::copy(position_.begin(), position_.end(), first_.begin());
  const auto linearise = [&] { linearisation_.Linearise(kernels, workers, position_, level_, balance_); };
  const auto precondition = [&] {
    RunPass(kernels, workers, level_, LinkPass::kStart, nullptr, r_.data(), 1.0f, z_.data());
    return CalcDotAndLongest(kernels, workers, r_, z_);
  };
  const auto multiply = [&] {
    RunPass(kernels, workers, level_, LinkPass::kProduct, p_.data(), nullptr, 0.0f, q_.data());
    AddContactLinks(load_, balance_, p_.data(), q_.data());
    linearisation_.CompleteProduct(level_, p_.data(), q_.data());
  };
  TrustRegion region(edge_length);
  linearise();
  while (report.steps < kMaxSteps && balance_.is_finite) {
    std::copy(balance_.residual.begin(), balance_.residual.end(), r_.begin());
    const double seen = precondition().longest;
    if (!(seen > kSeenShare * tolerance)) break;
    const TruncatedReport linear = SolveTruncated(
        kernels, workers, kMaxLinearIterations, region.Radius(), {step_, r_, z_, p_, q_}, multiply,
        precondition,
        [&](double left, double) { return left <= math::Max(kForcing * seen, kSeenShare * tolerance); });
    report.smallest_ritz = math::Min(report.smallest_ritz, linear.smallest_ritz);
    const double length = FindLongest(kernels, workers, step_);
    if (!(length > 0.0 && length < INFINITY)) break;
    const double before = balance_.energy, slope = -CalcDot(kernels, workers, balance_.residual, step_);
    std::copy(position_.begin(), position_.end(), start_.begin());
    double share = 1.0;
    bool is_lower = false;
    for (int halving = 0; halving <= TrustRegion::kMaxHalvings && !is_lower; ++halving, share *= 0.5) {
      for (std::uint32_t a = 0; a < free_count_; ++a) position_[a] = Advance(start_[a], share, step_[a]);
      linearise();
      is_lower = balance_.is_finite && TrustRegion::IsLower(before, balance_.energy, slope, share);
    }
    ++report.steps;
    share *= 2.0;  // the one that was tried last
    region.Update(share, length, linear.reached_radius);
    if (!is_lower) {
      std::copy(start_.begin(), start_.end(), position_.begin());
      break;
    }
  }
  double longest2 = 0;
  for (std::uint32_t a = 0; a < free_count_; ++a) {
    const Double4 &to = position_[a], &from = first_[a];
    position[nodes_[a]] = to;
    longest2 =
        math::Max(longest2, math::SquaredNorm(math::Vec3{to.x - from.x, to.y - from.y, to.z - from.z}));
  }
  report.longest = std::sqrt(longest2);
  return report;
}

void LocalSolve::TakeBack(std::span<Double4> position) const noexcept {
  for (std::uint32_t a = 0; a < free_count_; ++a) position[nodes_[a]] = first_[a];
}

}  // namespace trocar::tissue
