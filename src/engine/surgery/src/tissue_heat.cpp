// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/tissue_heat.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"

namespace trocar::surgery {
namespace {

constexpr double kGasConstant = 8.314462618;  // [J/(mol K)]
constexpr double kKelvin = 273.15;
constexpr double kDryCapacity = 0.4;      // of a dry node, against a wet one [-]
constexpr double kPartedWater = 1.0 / 3;  // water left at which tissue parts [-]
constexpr double kCharSeconds = 0.5;      // at char_temperature + 100 K until black [s]
constexpr double kCold = 1e-9;            // above body temperature, below which a node counts as cold [K]
constexpr double kHarmless = 42.0;        // below it the Arrhenius rate is negligible [deg C]

}  // namespace

double CalcHeatConductance(const HeatConstants& constants, double width, double depth,
                           double length) noexcept {
  return constants.conductivity * width * depth / length;
}

TissueHeat::TissueHeat(std::span<const HeatNode> nodes, std::span<const HeatLink> links,
                       const HeatConstants& constants)
    : constants_(constants) {
  const std::size_t n = nodes.size();
  starts_.assign(n + 1, 0);
  for (const HeatNode& node : nodes) {
    TROCAR_ASSERT(node.mass > 0 && std::isfinite(node.mass) && node.perfusion_scale >= 0);
    capacity_.push_back(node.mass * constants.specific_heat);
    water_energy_.push_back(node.mass * constants.water_share * constants.latent_heat);
    blood_.push_back(capacity_.back() * constants.perfusion * node.perfusion_scale);
  }
  for (const HeatLink& link : links) {
    TROCAR_ASSERT(link.a < n && link.b < n && link.a != link.b && link.conductance >= 0 &&
                  std::isfinite(link.conductance));
    ++starts_[link.a + 1], ++starts_[link.b + 1];
  }
  for (std::size_t i = 0; i < n; ++i) starts_[i + 1] += starts_[i];
  others_.resize(2 * links.size());
  conductance_.resize(2 * links.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (const HeatLink& link : links) {
    for (const auto& [own, other] : {std::pair{link.a, link.b}, std::pair{link.b, link.a}}) {
      others_[next[own]] = other;
      conductance_[next[own]++] = link.conductance;
    }
  }
  gain_.assign(n, 0.0);
  is_warm_.assign(n, 0);
  longest_step_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    double sum = blood_[i];
    for (std::uint32_t k = starts_[i]; k < starts_[i + 1]; ++k) sum += conductance_[k];
    if (sum > 0) longest_step_ = std::min(longest_step_, 0.5 * kDryCapacity * capacity_[i] / sum);
  }
}

HeatState TissueHeat::MakeState() const {
  const std::size_t n = Size();
  return {std::vector<double>(n, kBodyTemperature), std::vector<double>(n, 1.0), std::vector<double>(n, 0.0),
          std::vector<double>(n, 0.0)};
}

double TissueHeat::Step(std::span<const Source> sources, double seconds, HeatState& state) noexcept {
  TROCAR_ASSERT(state.temperature.size() == Size() && seconds > 0);
  const std::size_t n = Size();
  const int steps = std::max(1, base::CeilTo<int>(seconds / longest_step_));
  const double dt = seconds / steps;
  double lost = 0;
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < n; ++i)
      is_warm_[i] = std::fabs(state.temperature[i] - kBodyTemperature) > kCold;
    for (std::size_t i = 0; i < n; ++i) {
      const double own = state.temperature[i];
      double gain = 0;
      bool is_touched = is_warm_[i] != 0;
      for (std::uint32_t k = starts_[i]; k < starts_[i + 1]; ++k) {
        if (is_warm_[others_[k]] == 0 && is_warm_[i] == 0) continue;
        gain += conductance_[k] * (state.temperature[others_[k]] - own);
        is_touched = true;
      }
      if (is_touched) {
        const double blood = state.damage[i] < 1 ? blood_[i] * (own - kBodyTemperature) : 0.0;
        lost += blood * dt;
        gain -= blood;
      }
      gain_[i] = gain;
    }
    for (const Source& source : sources) {
      if (source.node < n && source.power > 0) gain_[source.node] += source.power;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (gain_[i] == 0 && is_warm_[i] == 0) continue;
      double heat = gain_[i] * dt;
      double& temperature = state.temperature[i];
      double& water = state.water[i];
      const auto capacity = [&] { return capacity_[i] * (kDryCapacity + (1 - kDryCapacity) * water); };
      if (water > 0 && temperature + heat / capacity() > kBoilingTemperature) {
        // up to boiling first; the rest makes steam, which takes along what it was heated with
        heat -= capacity() * (kBoilingTemperature - temperature);
        temperature = kBoilingTemperature;
        const double hot = capacity_[i] * (1 - kDryCapacity) * (kBoilingTemperature - kBodyTemperature);
        const double boiled = std::min(heat / water_energy_[i], water);
        water -= boiled;
        lost += boiled * (water_energy_[i] + hot);
        heat = water > 0 ? 0.0 : heat - boiled * water_energy_[i];
      }
      temperature += heat / capacity();
      if (temperature > constants_.most_temperature) {
        lost += capacity() * (temperature - constants_.most_temperature);
        temperature = constants_.most_temperature;
      }
      if (temperature > kHarmless) {
        state.damage[i] += dt * constants_.damage_rate *
                           math::Exp(-constants_.damage_energy / (kGasConstant * (temperature + kKelvin)));
      }
      if (temperature > constants_.char_temperature) {
        state.charring[i] = std::min(
            1.0, state.charring[i] + dt / kCharSeconds * (temperature - constants_.char_temperature) / 100.0);
      }
    }
  }
  return lost;
}

double TissueHeat::CalcHeat(const HeatState& state) const noexcept {
  double heat = 0;
  for (std::size_t i = 0; i < Size(); ++i) {
    heat += capacity_[i] * (kDryCapacity + (1 - kDryCapacity) * state.water[i]) *
            (state.temperature[i] - kBodyTemperature);
  }
  return heat;
}

HeatInjury TissueHeat::InjuryOf(const HeatState& state, std::size_t node) noexcept {
  if (state.charring[node] >= 0.5) return HeatInjury::kCharred;
  if (state.water[node] <= kPartedWater) return HeatInjury::kParted;
  if (state.damage[node] >= 1) return HeatInjury::kBlanched;
  return HeatInjury::kNone;
}

void VisitState(base::StateArchive& archive, HeatState& state) {
  archive.FixedField("temperature", state.temperature);
  archive.FixedField("water", state.water);
  archive.FixedField("damage", state.damage);
  archive.FixedField("charring", state.charring);
}

}  // namespace trocar::surgery
