// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/model_check.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "trocar/tissue/equilibrium.h"

namespace trocar::tissue {
namespace {

/// Of model, state, the layouts of all solvers and the multigrid levels, measured on grids of 40,000 and
/// 160,000 nodes and rounded up [bytes].
constexpr std::size_t kBytesPerNode = 1600, kBytesPerLink = 900;

base::Error Invalid(const std::string& what) {
  return {base::ErrorCode::kTissueInvalid, what};
}

bool IsAmount(double value) {
  return std::isfinite(value) && value >= 0.0;
}

/// What is wrong with a link's ends and stiffness, or nothing.
template <typename Link>
std::string FindFault(const Link& link, std::size_t node_count) {
  if (link.a >= node_count || link.b >= node_count) return "joins a node that does not exist";
  if (link.a == link.b) return "joins node " + std::to_string(link.a) + " to itself; leave it out";
  if (!IsAmount(link.stiffness)) return "has a stiffness that is negative or not a number";
  return {};
}

/// Joins springs between the same two nodes; the first keeps its place and its law.
std::size_t MergeDuplicates(std::vector<Spring>& springs) {
  std::vector<std::size_t> order(springs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto ends = [&](std::size_t i) { return std::minmax(springs[i].a, springs[i].b); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_tuple(ends(a).first, ends(a).second, a) <
           std::make_tuple(ends(b).first, ends(b).second, b);
  });
  std::vector<std::uint8_t> is_gone(springs.size(), 0);
  for (std::size_t i = 0, first = 0; i < order.size(); ++i) {
    if (i == 0 || ends(order[i]) != ends(order[first])) {
      first = i;
      continue;
    }
    Spring& kept = springs[order[first]];
    const Spring& other = springs[order[i]];
    const double sum = kept.stiffness + other.stiffness;
    if (sum > 0.0) {
      kept.rest_length = (kept.stiffness * kept.rest_length + other.stiffness * other.rest_length) / sum;
    }
    kept.stiffness = sum;
    is_gone[order[i]] = 1;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    if (!is_gone[i]) springs[count++] = springs[i];
  }
  const std::size_t merged = springs.size() - count;
  springs.resize(count);
  return merged;
}

std::size_t HoldIsolatedNodes(TissueDefinition& definition) {
  std::vector<std::uint8_t> is_held(definition.rest.size(), 0);
  for (std::size_t i = 0; i < is_held.size(); ++i) is_held[i] = definition.shape_stiffness[i] > 0.0;
  const auto hold = [&](const auto& links) {
    for (const auto& link : links) {
      if (link.stiffness > 0.0) is_held[link.a] = is_held[link.b] = 1;
    }
  };
  hold(definition.springs);
  hold(definition.strands);
  for (const std::uint32_t node : definition.fixed) is_held[node] = 1;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < is_held.size(); ++i) {
    if (is_held[i]) continue;
    definition.fixed.push_back(i);
    ++count;
  }
  return count;
}

}  // namespace

std::string TissueRepairs::Text() const {
  std::string text;
  if (merged_springs > 0)
    text = std::to_string(merged_springs) + " duplicate springs were joined with the first";
  if (held_nodes > 0) {
    text += std::string(text.empty() ? "" : "; ") + std::to_string(held_nodes) +
            " nodes that nothing holds were fixed where they are";
  }
  return text;
}

std::size_t CalcTissueMemory(const TissueDefinition& definition) noexcept {
  return definition.rest.size() * kBytesPerNode +
         (definition.springs.size() + definition.strands.size()) * kBytesPerLink;
}

base::Result<TissueRepairs> CheckTissue(TissueDefinition& definition, std::size_t memory_bytes) {
  const std::size_t n = definition.rest.size();
  if (definition.mass.size() != n || definition.shape_stiffness.size() != n)
    return Invalid("there must be one mass and one virtual spring for each of the " + std::to_string(n) +
                   " nodes");
  const std::size_t needed = CalcTissueMemory(definition);
  if (needed > memory_bytes || n >= UINT32_MAX / 64) {
    return base::Error{base::ErrorCode::kOutOfMemory,
                       "a model of " + std::to_string(n) + " nodes needs about " +
                           std::to_string(needed >> 20) + " MiB and may take " +
                           std::to_string(memory_bytes >> 20) + "; decimate the mesh"};
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!math::IsFinite(definition.rest[i]))
      return Invalid("the rest position of node " + std::to_string(i) + " is not finite");
    if (!IsAmount(definition.mass[i]) || !IsAmount(definition.shape_stiffness[i]))
      return Invalid("mass or virtual spring of node " + std::to_string(i) + " is negative or not a number");
  }
  for (std::size_t i = 0; i < definition.laws.size(); ++i) {
    const SpringLaw& law = definition.laws[i];
    if (!IsAmount(law.stiffening) || !IsAmount(law.stiffening_strain) || !IsAmount(law.damage_rate) ||
        !(law.failure_strain > 0.0) || !(law.damage_exponent >= 1.0 && std::isfinite(law.damage_exponent)))
      return Invalid("spring law " + std::to_string(i) +
                     " has a number that is negative, not finite, or an exponent below one");
  }
  for (const std::uint32_t node : definition.fixed) {
    if (node >= n) return Invalid("fixed node " + std::to_string(node) + " does not exist");
  }
  for (std::size_t i = 0; i < definition.springs.size(); ++i) {
    const Spring& spring = definition.springs[i];
    std::string fault = FindFault(spring, n);
    if (fault.empty() && !IsAmount(spring.rest_length))
      fault = "has a rest length that is negative or not a number";
    if (fault.empty() && spring.rest_length > 0.0 && definition.rest[spring.a] == definition.rest[spring.b])
      fault = "has no direction: its ends lie in one point at rest; merge the two nodes";
    if (fault.empty() && spring.law >= definition.laws.size())
      fault = "follows law " + std::to_string(spring.law) + ", which does not exist";
    if (!fault.empty()) return Invalid("spring " + std::to_string(i) + " " + fault);
  }
  for (std::size_t i = 0; i < definition.strands.size(); ++i) {
    const std::string fault = FindFault(definition.strands[i], n);
    if (!fault.empty()) return Invalid("strand " + std::to_string(i) + " " + fault);
  }
  TissueRepairs repairs;
  repairs.merged_springs = MergeDuplicates(definition.springs);
  repairs.held_nodes = HoldIsolatedNodes(definition);
  return repairs;
}

base::Status CheckSolverSettings(const SolverSettings& settings, const TissueModel& model,
                                 const TissueLoad& load) {
  const double largest = CalcLargestAlpha(model, load);
  if (settings.kind != SolverKind::kRelaxationPaper || settings.relaxation.alpha <= largest) return {};
  return base::Error{base::ErrorCode::kUnstableStep, "alpha " + std::to_string(settings.relaxation.alpha) +
                                                         " m/N would blow the tissue up; at most " +
                                                         std::to_string(largest) +
                                                         " is stable here, or 0 to take half of that"};
}

}  // namespace trocar::tissue
