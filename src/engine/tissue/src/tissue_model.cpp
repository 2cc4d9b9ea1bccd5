// SPDX-License-Identifier: Apache-2.0
#include "trocar/tissue/tissue_model.h"

#include <algorithm>
#include <cmath>

#include "node_force.h"
#include "trocar/base/assert.h"
#include "trocar/math/state_fields.h"
#include "trocar/tissue/element_kinds.h"

namespace trocar::base {

template <>
inline constexpr bool kIsPlainState<tissue::Spring> = sizeof(tissue::Spring) ==
                                                      4 * sizeof(std::uint32_t) + 2 * sizeof(double);

}  // namespace trocar::base

namespace trocar::tissue {

using math::Vec3;

namespace {

bool IsMagnitude(double value) {
  return std::isfinite(value) && value >= 0.0;
}

/// Whether a model can be made of it.
bool IsUsable(const TissueDefinition& definition) {
  const std::size_t n = definition.rest.size();
  const auto is_spring = [&](const Spring& spring) {
    return spring.a < n && spring.b < n && spring.a != spring.b && IsMagnitude(spring.stiffness) &&
           IsMagnitude(spring.rest_length) && spring.law < definition.laws.size();
  };
  return std::all_of(definition.rest.begin(), definition.rest.end(),
                     [](const Vec3& p) { return math::IsFinite(p); }) &&
         std::all_of(definition.mass.begin(), definition.mass.end(), IsMagnitude) &&
         std::all_of(definition.shape_stiffness.begin(), definition.shape_stiffness.end(), IsMagnitude) &&
         std::all_of(definition.fixed.begin(), definition.fixed.end(),
                     [n](std::uint32_t node) { return node < n; }) &&
         std::all_of(definition.springs.begin(), definition.springs.end(), is_spring);
}

/// Starts of rows from how often each node occurs as an end.
template <typename Link>
std::vector<std::uint32_t> CountEnds(const std::vector<Link>& links, std::size_t node_count) {
  std::vector<std::uint32_t> starts(node_count + 1, 0);
  for (const Link& link : links) {
    TROCAR_ASSERT(link.a < node_count && link.b < node_count && link.a != link.b);
    TROCAR_ASSERT(std::isfinite(link.stiffness) && link.stiffness >= 0.0);
    ++starts[link.a + 1];
    ++starts[link.b + 1];
  }
  for (std::size_t i = 0; i < node_count; ++i) starts[i + 1] += starts[i];
  return starts;
}

}  // namespace

TissueModel MakeTissueModel(const TissueDefinition& definition) {
  const std::size_t n = definition.rest.size();
  TROCAR_ASSERT(definition.mass.size() == n && definition.shape_stiffness.size() == n);
  TissueModel model;
  model.rest = definition.rest;
  model.mass = definition.mass;
  model.shape_stiffness = definition.shape_stiffness;
  model.is_fixed.assign(n, 0);
  for (const auto node : definition.fixed) model.is_fixed.at(node) = 1;
  for (std::size_t i = 0; i < n; ++i) {
    TROCAR_ASSERT(math::IsFinite(model.rest[i]) && model.mass[i] >= 0.0 && model.shape_stiffness[i] >= 0.0);
  }

  model.spring_starts = CountEnds(definition.springs, n);
  model.half_springs.resize(2 * definition.springs.size());
  std::vector<std::uint32_t> next = model.spring_starts;
  for (const Spring& spring : definition.springs) {
    TROCAR_ASSERT(std::isfinite(spring.rest_length) && spring.rest_length >= 0.0);
    TROCAR_ASSERT(spring.law < definition.laws.size());
    const auto index = static_cast<std::uint32_t>(model.spring_law.size());
    model.half_springs[next[spring.a]++] = {spring.b, index, spring.stiffness, spring.rest_length};
    model.half_springs[next[spring.b]++] = {spring.a, index, spring.stiffness, spring.rest_length};
    model.spring_law.push_back(spring.law);
  }
  model.laws = definition.laws;
  for (std::size_t i = 0; i < n; ++i) {
    std::sort(model.half_springs.begin() + model.spring_starts[i],
              model.half_springs.begin() + model.spring_starts[i + 1], [](const auto& a, const auto& b) {
                return a.other != b.other ? a.other < b.other : a.spring < b.spring;
              });
  }

  model.strand_starts = CountEnds(definition.strands, n);
  model.half_strands.resize(2 * definition.strands.size());
  next = model.strand_starts;
  for (std::uint32_t index = 0; index < definition.strands.size(); ++index) {
    const Strand& strand = definition.strands[index];
    model.half_strands[next[strand.a]++] = {strand.b, index, strand.stiffness};
    model.half_strands[next[strand.b]++] = {strand.a, index, strand.stiffness};
  }
  model.strand_count = definition.strands.size();
  return model;
}

void VisitState(base::StateArchive& archive, TissueDefinition& definition) {
  archive.FixedField("rest", definition.rest);
  archive.FixedField("mass", definition.mass);
  archive.FixedField("shape_stiffness", definition.shape_stiffness);
  archive.Field("fixed", definition.fixed);
  archive.Field("springs", definition.springs);
  if (archive.IsRestoring() && archive.ok() && !IsUsable(definition))
    archive.Fail("has nodes or springs of which no model can be made");
}

void VisitState(base::StateArchive& archive, TissueState& state) {
  archive.FixedField("position", state.position);
  archive.FixedField("condition", state.condition);
  archive.FixedField("strand_is_intact", state.strand_is_intact);
  archive.FixedField("spring_factor", state.spring_factor);
  archive.FixedField("spring_damage", state.spring_damage);
  const auto is_condition = [](NodeCondition condition) { return condition <= NodeCondition::kPrescribed; };
  if (archive.IsRestoring() && !std::all_of(state.condition.begin(), state.condition.end(), is_condition))
    archive.Fail("has nodes with an unknown condition");
}

TissueState MakeRestState(const TissueModel& model) {
  TissueState state;
  state.position = model.rest;
  state.condition.assign(model.Size(), NodeCondition::kFree);
  for (std::size_t i = 0; i < model.Size(); ++i) {
    if (model.is_fixed[i]) state.condition[i] = NodeCondition::kPrescribed;
  }
  state.strand_is_intact.assign(model.strand_count, 1);
  state.spring_factor.assign(model.SpringCount(), 1.0);
  state.spring_damage.assign(model.SpringCount(), 0.0);
  return state;
}

double CalcContactDepth(const ContactSpring& contact, std::span<const Vec3> position) noexcept {
  double along = 0;
  for (int i = 0; i < 3; ++i)
    along += contact.weights[i] * math::Dot(contact.normal, position[contact.nodes[i]]);
  return contact.offset - along;
}

void CalcResidual(const TissueModel& model, const TissueState& state, const TissueLoad& load,
                  std::span<Vec3> residual) {
  TROCAR_ASSERT(residual.size() == model.Size() && state.position.size() == model.Size());
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    residual[i] = GatherLawForce(model, state, load, i);
  }
  AddContactForce(load.contacts, state.position, residual);
  if (HasElements(load)) AddElementForces(*load.elements, state.position, residual);
}

double CalcEnergy(const TissueModel& model, const TissueState& state, const TissueLoad& load) {
  const auto& x = state.position;
  double energy = 0;
  for (std::uint32_t i = 0; i < model.Size(); ++i) {
    // each pair is met from both of its ends, so each end counts half
    for (auto h = model.spring_starts[i]; h < model.spring_starts[i + 1]; ++h) {
      const auto& half = model.half_springs[h];
      energy += 0.5 * load.stiffness_scale * state.spring_factor[half.spring] *
                CalcSpringEnergy(model.laws[model.spring_law[half.spring]], half.stiffness, half.rest_length,
                                 math::Distance(x[i], x[half.other]));
    }
    for (auto h = model.strand_starts[i]; h < model.strand_starts[i + 1]; ++h) {
      const auto& half = model.half_strands[h];
      if (!state.strand_is_intact[half.strand]) continue;
      const Vec3 offset = (x[half.other] - x[i]) - (model.rest[half.other] - model.rest[i]);
      energy += 0.25 * load.stiffness_scale * half.stiffness * math::SquaredNorm(offset);
    }
    energy += 0.5 * load.shape_scale * model.shape_stiffness[i] * math::SquaredDistance(x[i], model.rest[i]);
    energy -= model.mass[i] * math::Dot(load.gravity, x[i]);
    if (!load.external_force.empty()) energy -= math::Dot(load.external_force[i], x[i]);
  }
  for (const ContactSpring& contact : load.contacts) {
    const double depth = std::max(0.0, CalcContactDepth(contact, x));
    energy += 0.5 * contact.stiffness * depth * depth;
  }
  if (HasElements(load)) energy += CalcElementEnergy(*load.elements, x);
  return energy;
}

}  // namespace trocar::tissue
