// SPDX-License-Identifier: Apache-2.0
#include "trocar/surgery/flow_network.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/state_archive.h"
#include "trocar/math/elementary.h"

namespace trocar::surgery {
namespace {

constexpr double kClipLength = 0.003;    // that a clip narrows: medium-large clips are 3 mm wide [m]
constexpr double kDischarge = 0.62;      // of a sharp-edged orifice [-]
constexpr double kSmoothPressure = 1.0;  // below which an orifice acts as a pipe [Pa]
constexpr int kOrificeRounds = 40;       // each at least halves what is wrong with an orifice's conductance
constexpr double kSettled = 1e-12;       // relative change of the pressures that ends the rounds
constexpr double kTight = 1.0 - 1e-9;    // closure that lets nothing through

/// Hagen and Poiseuille [m^3/(Pa s)].
double CalcPipeConductance(double radius, double length, double viscosity) noexcept {
  return std::numbers::pi * radius * radius * radius * radius / (8.0 * viscosity * length);
}

double CalcSection(double radius) noexcept {
  return std::numbers::pi * radius * radius;
}

}  // namespace

VesselActs::VesselActs() {
  clips.reserve(kMostClips);
  openings.reserve(kMostOpenings);
}

/// Part of a vessel between two nodes without an opening between them.
struct FlowNetwork::Piece {
  std::uint32_t a, b;  // nodes: junctions first, then the ends of cuts and the holes
  double conductance;
};

/// A node that is open to the abdomen.
struct FlowNetwork::Outlet {
  std::uint32_t node;
  double coefficient;  // flow over the square root of the pressure
  Leak leak;
};

base::Result<FlowNetwork> FlowNetwork::Make(std::vector<FlowVessel> vessels,
                                            std::vector<FlowJunction> junctions, const FluidTable& fluids) {
  const auto refuse = [](const std::string& why) {
    return base::Error{base::ErrorCode::kPatientInvalid, "ducts and vessels: " + why};
  };
  if (vessels.size() > kMostVessels || junctions.size() > kMostJunctions) {
    return refuse("more than " + std::to_string(kMostVessels) + " vessels or " +
                  std::to_string(kMostJunctions) + " junctions");
  }
  std::vector<int> fluid_at(junctions.size(), -1);
  for (std::size_t v = 0; v < vessels.size(); ++v) {
    const FlowVessel& vessel = vessels[v];
    const std::string name = "vessel " + std::to_string(v);
    if (vessel.from >= junctions.size() || vessel.to >= junctions.size() || vessel.from == vessel.to)
      return refuse(name + " does not run from one junction to another");
    if (!(vessel.length > 0) || !(vessel.radius > 0) || !std::isfinite(vessel.length) ||
        !std::isfinite(vessel.radius))
      return refuse(name + " has no length or radius");
    for (const std::uint32_t end : {vessel.from, vessel.to}) {
      if (fluid_at[end] >= 0 && fluid_at[end] != static_cast<int>(vessel.fluid))
        return refuse(name + " meets a vessel of another fluid");
      fluid_at[end] = static_cast<int>(vessel.fluid);
    }
  }
  for (const FlowJunction& junction : junctions) {
    if (!std::isfinite(junction.pressure) || !std::isfinite(junction.conductance) || junction.conductance < 0)
      return refuse("a supply is not finite, or its conductance is negative");
  }
  return FlowNetwork(std::move(vessels), std::move(junctions), fluids);
}

void FlowNetwork::SetPressure(std::size_t junction, double pressure) noexcept {
  TROCAR_ASSERT(junction < junctions_.size() && std::isfinite(pressure));
  junctions_[junction].pressure = pressure;
}

std::size_t FlowNetwork::CutIntoPieces(const VesselActs& acts, std::span<Piece> pieces,
                                       std::span<Outlet> outlets, std::size_t& piece_count,
                                       std::size_t& outlet_count) const noexcept {
  std::size_t nodes = junctions_.size();
  piece_count = outlet_count = 0;
  for (std::uint32_t v = 0; v < vessels_.size(); ++v) {
    const FlowVessel& vessel = vessels_[v];
    const FluidProperties& fluid = fluids_[static_cast<std::size_t>(vessel.fluid)];
    // openings of this vessel in the order of their places; of equal ones in that of the acts
    std::array<std::uint32_t, VesselActs::kMostOpenings> order{};
    std::size_t count = 0;
    for (std::uint32_t o = 0; o < acts.openings.size(); ++o) {
      const VesselOpening& opening = acts.openings[o];
      if (opening.vessel == v && opening.position >= 0 && opening.position <= vessel.length)
        order[count++] = o;
    }
    std::stable_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return acts.openings[a].position < acts.openings[b].position;
                     });
    const auto add_piece = [&](std::uint32_t a, std::uint32_t b, double begin, double end) {
      // resistances in series: the open part, and every clip
      double resistance = 0, open = end - begin;
      bool is_shut = false;
      for (const VesselClip& clip : acts.clips) {
        if (clip.vessel != v || clip.position < begin || clip.position > end || !(clip.closure > 0)) continue;
        const double narrow = vessel.radius * (1.0 - std::min(clip.closure, 1.0));
        is_shut = is_shut || clip.closure >= kTight;
        if (is_shut) break;
        resistance += 1.0 / CalcPipeConductance(narrow, kClipLength, fluid.viscosity);
        open -= kClipLength;
      }
      if (is_shut) return;
      constexpr double kShortest = 1e-5;  // a piece of no length would have no resistance [m]
      resistance += 1.0 / CalcPipeConductance(vessel.radius, std::max(open, kShortest), fluid.viscosity);
      pieces[piece_count++] = {a, b, 1.0 / resistance};
    };
    const auto add_outlet = [&](std::uint32_t node, std::uint32_t o, std::uint8_t end, double area) {
      double open = area * (1.0 - std::clamp(acts.openings[o].sealed[end], 0.0, 1.0));
      if (!(open > 0)) open = 0;
      outlets[outlet_count++] = {
          node, kDischarge * open * std::sqrt(2.0 / fluid.density), {o, end, vessel.fluid, 0.0}};
    };
    std::uint32_t last = vessel.from;
    double begin = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const VesselOpening& opening = acts.openings[order[k]];
      const auto near = static_cast<std::uint32_t>(nodes++);
      add_piece(last, near, begin, opening.position);
      add_outlet(near, order[k], 0, opening.is_cut ? CalcSection(vessel.radius) : opening.area);
      last = near;
      if (opening.is_cut) {
        const auto far = static_cast<std::uint32_t>(nodes++);
        add_outlet(far, order[k], 1, CalcSection(vessel.radius));
        last = far;
      }
      begin = opening.position;
    }
    add_piece(last, vessel.to, begin, vessel.length);
  }
  return nodes;
}

FlowReport FlowNetwork::Solve(const VesselActs& acts) noexcept {
  TROCAR_ASSERT(acts.clips.size() <= VesselActs::kMostClips &&
                acts.openings.size() <= VesselActs::kMostOpenings);
  std::array<Piece, kMostPieces> pieces;
  std::array<Outlet, 2 * VesselActs::kMostOpenings> outlets;
  std::size_t piece_count = 0, outlet_count = 0;
  const std::size_t n = CutIntoPieces(acts, pieces, outlets, piece_count, outlet_count);

  // an orifice is a conductance that depends on the pressure before it: found by repeated substitution
  std::array<double, kMostNodes> next{};
  pressure_.fill(0.0);
  for (std::size_t o = 0; o < outlet_count; ++o) pressure_[outlets[o].node] = 1e3;
  const auto orifice = [&](const Outlet& outlet) {
    return outlet.coefficient / std::sqrt(math::Hypot(pressure_[outlet.node], kSmoothPressure));
  };
  std::array<std::array<double, kMostNodes>, kMostNodes> matrix;
  for (int round = 0; round < kOrificeRounds; ++round) {
    for (std::size_t i = 0; i < n; ++i) {
      std::fill_n(matrix[i].begin(), n, 0.0);
      next[i] = 0.0;
    }
    for (std::size_t j = 0; j < junctions_.size(); ++j) {
      matrix[j][j] += junctions_[j].conductance;
      next[j] += junctions_[j].conductance * junctions_[j].pressure;
    }
    for (const Piece& piece : std::span(pieces).first(piece_count)) {
      matrix[piece.a][piece.a] += piece.conductance;
      matrix[piece.b][piece.b] += piece.conductance;
      matrix[piece.a][piece.b] -= piece.conductance;
      matrix[piece.b][piece.a] -= piece.conductance;
    }
    for (const Outlet& outlet : std::span(outlets).first(outlet_count))
      matrix[outlet.node][outlet.node] += orifice(outlet);

    // Gauss without pivoting: symmetric and diagonally dominant. A part that nothing supplies has no pressure
    // of its own.
    std::array<bool, kMostNodes> is_floating{};
    std::array<double, kMostNodes> diagonal{};
    for (std::size_t i = 0; i < n; ++i) diagonal[i] = matrix[i][i];
    for (std::size_t k = 0; k < n; ++k) {
      constexpr double kRounding = 1e-13;
      if (!(matrix[k][k] > kRounding * diagonal[k])) {
        is_floating[k] = true;
        continue;
      }
      for (std::size_t i = k + 1; i < n; ++i) {
        const double factor = matrix[i][k] / matrix[k][k];
        if (factor == 0.0) continue;
        for (std::size_t j = k; j < n; ++j) matrix[i][j] -= factor * matrix[k][j];
        next[i] -= factor * next[k];
      }
    }
    for (std::size_t k = n; k-- > 0;) {
      if (is_floating[k]) {
        next[k] = 0.0;
        continue;
      }
      for (std::size_t j = k + 1; j < n; ++j) next[k] -= matrix[k][j] * next[j];
      next[k] /= matrix[k][k];
    }
    double change = 0, largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      change = std::max(change, std::fabs(next[i] - pressure_[i]));
      largest = std::max(largest, std::fabs(next[i]));
      pressure_[i] = next[i];
    }
    if (change <= kSettled * largest) break;
  }

  FlowReport report;
  for (const Outlet& outlet : std::span(outlets).first(outlet_count)) {
    // nothing flows in from the abdomen: what would is a collapsed vein or an empty duct
    const double rate = std::max(orifice(outlet) * pressure_[outlet.node], 0.0);
    if (rate == 0.0) continue;
    Leak& leak = report.leaks[report.leak_count++] = outlet.leak;
    leak.rate = rate;
    report.rate[static_cast<std::size_t>(leak.fluid)] += rate;
  }
  return report;
}

double FlowNetwork::SupplyAt(std::size_t junction) const noexcept {
  const FlowJunction& supply = junctions_[junction];
  return supply.conductance * (supply.pressure - pressure_[junction]);
}

bool FlowNetwork::AreConnected(const VesselActs& acts, std::size_t a, std::size_t b) const noexcept {
  std::array<std::size_t, kMostJunctions> component{};
  for (std::size_t j = 0; j < junctions_.size(); ++j) component[j] = j;
  for (std::uint32_t v = 0; v < vessels_.size(); ++v) {
    const auto is_inside = [&](std::uint32_t vessel, double position) {
      return vessel == v && position >= 0 && position <= vessels_[v].length;
    };
    const bool is_shut =
        std::any_of(acts.clips.begin(), acts.clips.end(),
                    [&](const VesselClip& clip) {
                      return is_inside(clip.vessel, clip.position) && clip.closure >= kTight;
                    }) ||
        std::any_of(acts.openings.begin(), acts.openings.end(), [&](const VesselOpening& opening) {
          return opening.is_cut && is_inside(opening.vessel, opening.position);
        });
    if (is_shut) continue;
    const std::size_t from = component[vessels_[v].from], to = component[vessels_[v].to];
    for (std::size_t& c : component) {
      if (c == to) c = from;
    }
  }
  return component[a] == component[b];
}

void FluidLedger::Leak(Fluid fluid, double volume) noexcept {
  TROCAR_ASSERT(volume >= 0);
  Account& account = fluids[static_cast<std::size_t>(fluid)];
  account.left += volume;
  account.pooled += volume;
}

void FluidLedger::Rinse(double volume) noexcept {
  TROCAR_ASSERT(volume >= 0);
  rinse_pooled += volume;
}

double FluidLedger::Pooled() const noexcept {
  double sum = rinse_pooled;
  for (const Account& account : fluids) sum += account.pooled;
  return sum;
}

double FluidLedger::Aspirate(double volume) noexcept {
  TROCAR_ASSERT(volume >= 0);
  const double pooled = Pooled();
  if (!(pooled > 0)) return 0;
  const double share = std::min(volume / pooled, 1.0);
  const auto take = [share](double& from, double& to) {
    const double part = share * from;
    from -= part;
    to += part;
    return part;
  };
  double taken = take(rinse_pooled, rinse_aspirated);
  for (Account& account : fluids) taken += take(account.pooled, account.aspirated);
  return taken;
}

void VisitState(base::StateArchive& archive, VesselClip& clip) {
  archive.Field("vessel", clip.vessel);
  archive.Field("position", clip.position);
  archive.Field("closure", clip.closure);
}

void VisitState(base::StateArchive& archive, VesselOpening& opening) {
  archive.Field("vessel", opening.vessel);
  archive.Field("position", opening.position);
  archive.Field("is_cut", opening.is_cut);
  archive.Field("area", opening.area);
  archive.Field("sealed", opening.sealed);
}

void VisitState(base::StateArchive& archive, VesselActs& acts) {
  archive.Field("clips", acts.clips);
  archive.Field("openings", acts.openings);
  if (archive.IsRestoring() &&
      (acts.clips.size() > VesselActs::kMostClips || acts.openings.size() > VesselActs::kMostOpenings)) {
    acts.clips.clear();
    acts.openings.clear();
    archive.Fail("has more clips or openings than its capacity");
  }
}

void FlowNetwork::VisitState(base::StateArchive& archive) {
  for (FlowJunction& junction : junctions_) archive.Field("supply", junction.pressure);
  archive.Field("pressure", pressure_);
}

void VisitState(base::StateArchive& archive, FlowReport& report) {
  archive.Field("leak_count", report.leak_count);
  if (archive.IsRestoring() && report.leak_count > report.leaks.size()) {
    report.leak_count = 0;
    archive.Fail("has more leaks than its capacity");
  }
  for (std::size_t i = 0; i < report.leak_count; ++i) {
    Leak& leak = report.leaks[i];
    archive.Field("opening", leak.opening);
    archive.Field("end", leak.end);
    archive.Field("fluid", leak.fluid);
    archive.Field("leak_rate", leak.rate);
  }
  archive.Field("rate", report.rate);
}

void VisitState(base::StateArchive& archive, FluidLedger& ledger) {
  for (FluidLedger::Account& account : ledger.fluids) {
    archive.Field("left", account.left);
    archive.Field("pooled", account.pooled);
    archive.Field("aspirated", account.aspirated);
  }
  archive.Field("rinse_pooled", ledger.rinse_pooled);
  archive.Field("rinse_aspirated", ledger.rinse_aspirated);
}

}  // namespace trocar::surgery
