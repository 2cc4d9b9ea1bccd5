// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/operation_parameters_file.h"

#include <initializer_list>
#include <string_view>

#include "patched_json.h"
#include "trocar/host/json.h"

namespace trocar::files {
namespace {

using host::JsonView;
using host::NumberRange;
using surgery::Fluid;

// In which ranges the figures mean something; schemas/operation.schema.json says the same.
constexpr NumberRange kViscosity{1e-05, 1};
constexpr NumberRange kFluidDensity{100, 20000};
constexpr NumberRange kPressure{-50000, 50000};
constexpr NumberRange kConductance{1e-15, 1e-06};
constexpr NumberRange kLeastShare{0.01, 1};
constexpr NumberRange kRadius{1e-05, 0.02};
constexpr NumberRange kShare{0, 1};
constexpr NumberRange kClipPressure{1, 1000000.0};
constexpr NumberRange kClipPull{0.01, 100};
constexpr NumberRange kPower{1, 100};
constexpr NumberRange kSlipSpeed{0, 0.1};
constexpr NumberRange kVolume{0, 0.001};
constexpr NumberRange kClotSeconds{0.1, 36000};
constexpr NumberRange kSpecificHeat{100, 100000};
constexpr NumberRange kConductivity{0.001, 100};
constexpr NumberRange kLatentHeat{10000, 100000000.0};
constexpr NumberRange kRate{0, 100};
constexpr NumberRange kDamageRate{0, 1e+60};
constexpr NumberRange kDamageEnergy{0, 10000000.0};
constexpr NumberRange kTemperature{100, 3000};
constexpr NumberRange kLength{1e-06, 0.05};
constexpr NumberRange kTissueDensity{1, 20000};
constexpr NumberRange kMass{1e-09, 0.01};
constexpr NumberRange kWatts{0, 500};
constexpr NumberRange kJoules{0.001, 100000};
constexpr NumberRange kArea{0, 0.001};
constexpr NumberRange kSmoke{0, 1};
constexpr NumberRange kFlowRate{0, 0.01};
constexpr NumberRange kSpeed{0, 1};
constexpr NumberRange kJawAngle{0, 1};
constexpr NumberRange kDepth{0, 0.3};
constexpr NumberRange kAllowedSeconds{0, 600};

std::size_t Index(Fluid fluid) {
  return static_cast<std::size_t>(fluid);
}

/// A group of figures, which says where they come from.
JsonView OpenGroup(const JsonView& root, std::string_view name,
                   std::initializer_list<std::string_view> keys) {
  const JsonView group = root.Object(name);
  group.AllowOnly(keys);
  (void)group.Text("source");
  return group;
}

void ReadFluid(const JsonView& view, surgery::FluidProperties& fluid) {
  view.AllowOnly({"viscosity_pa_s", "density_kg_m3"});
  fluid.viscosity = view.Number("viscosity_pa_s", kViscosity);
  fluid.density = view.Number("density_kg_m3", kFluidDensity);
}

void ReadJunction(const JsonView& view, surgery::FlowJunction& junction) {
  view.AllowOnly({"pressure_pa", "conductance_m3_per_pa_s"});
  junction.pressure = view.Number("pressure_pa", kPressure);
  junction.conductance = view.Number("conductance_m3_per_pa_s", kConductance);
}

void ReadFluids(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group = OpenGroup(root, "fluids", {"bile", "blood", "source"});
  ReadFluid(group.Object("bile"), made.fluids[Index(Fluid::kBile)]);
  ReadFluid(group.Object("blood"), made.fluids[Index(Fluid::kBlood)]);
}

void ReadSupplies(const JsonView& root, scene::OperationParameters& made) {
  const char* const organ =
      roles::NameOf(roles::kOrganBeds[0].organ);  // the hollow one whose bile comes back
  const JsonView group =
      OpenGroup(root, "supplies", {"aorta", "artery_bed", "liver", "bowel", organ, "lumen_share", "source"});
  ReadJunction(group.Object("aorta"), made.supplies.aorta);
  ReadJunction(group.Object("artery_bed"), made.supplies.artery_bed);
  ReadJunction(group.Object("liver"), made.supplies.liver);
  ReadJunction(group.Object("bowel"), made.supplies.bowel);
  ReadJunction(group.Object(organ), made.supplies.hollow_organ);
  made.supplies.lumen_share = group.Number("lumen_share", kLeastShare);
}

void ReadVessels(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group = OpenGroup(root, "vessels", {"most_sealed_radius_m", "least_filling", "source"});
  made.vessels.most_sealed_radius = group.Number("most_sealed_radius_m", kRadius);
  made.vessels.least_filling = group.Number("least_filling", kShare);
}

void ReadClips(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group =
      OpenGroup(root, "clips",
                {"pressure_pa", "pull_n", "crossed_share", "thick_radius_m", "partial_power",
                 "slip_speed_m_s", "fastest_slip_m_s", "width_m", "height_m", "gap_m", "catch_beside_m",
                 "drawn_away_m", "pulled_before_m", "source"});
  made.vessels.clips.pressure = group.Number("pressure_pa", kClipPressure);
  made.vessels.clips.pull = group.Number("pull_n", kClipPull);
  made.vessels.clips.crossed_share = group.Number("crossed_share", kShare);
  made.vessels.clips.thick_radius = group.Number("thick_radius_m", kRadius);
  made.vessels.clips.partial_power = group.Number("partial_power", kPower);
  made.vessels.clips.slip_speed = group.Number("slip_speed_m_s", kSlipSpeed);
  made.vessels.clips.fastest_slip = group.Number("fastest_slip_m_s", kSlipSpeed);
  surgery::ClipShape& shape = made.vessels.clip_shape;
  shape.width = group.Number("width_m", kLength);
  shape.height = group.Number("height_m", kLength);
  shape.gap = group.Number("gap_m", kLength);
  shape.catch_beside = group.Number("catch_beside_m", kLength);
  shape.drawn_away = group.Number("drawn_away_m", kLength);
  shape.pulled_before = group.Number("pulled_before_m", kLength);
}

void ReadStones(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group =
      OpenGroup(root, "stones",
                {"out_speed_m_s", "out_gap_m", "suction_reach_m", "closed_share", "open_share", "let_go_rad",
                 "near_hinge_share", "jaw_reach_share", "source"});
  made.stones.out_speed = group.Number("out_speed_m_s", kSpeed);
  made.stones.out_gap = group.Number("out_gap_m", kLength);
  made.stones.suction_reach = group.Number("suction_reach_m", kLength);
  made.stones.closed_share = group.Number("closed_share", kShare);
  made.stones.open_share = group.Number("open_share", kShare);
  made.stones.let_go = group.Number("let_go_rad", kJawAngle);
  made.stones.near_hinge = group.Number("near_hinge_share", kShare);
  made.stones.jaw_reach = group.Number("jaw_reach_share", kShare);
}

void ReadJudgement(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group = OpenGroup(root, "judgement",
                                   {"much_blood_m3", "near_duct_m", "kept_fat_m", "kept_sheath_m", "idle_s",
                                    "tip_in_m", "blind_s", "source"});
  made.judgement.much_blood = group.Number("much_blood_m3", kVolume);
  made.judgement.near_duct = group.Number("near_duct_m", kLength);
  made.judgement.kept_fat = group.Number("kept_fat_m", kLength);
  made.judgement.kept_sheath = group.Number("kept_sheath_m", kLength);
  made.judgement.idle_seconds = group.Number("idle_s", kAllowedSeconds);
  made.judgement.tip_in = group.Number("tip_in_m", kDepth);
  made.judgement.blind_seconds = group.Number("blind_s", kAllowedSeconds);
}

void ReadBed(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group = OpenGroup(root, "bed", {"volume_m3", "clot_s", "source"});
  made.bed.bed_volume = group.Number("volume_m3", kVolume);
  made.bed.clot_seconds = group.Number("clot_s", kClotSeconds);
}

void ReadHeat(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group =
      OpenGroup(root, "heat",
                {"specific_heat_j_kg_k", "conductivity_w_m_k", "water_share", "latent_heat_j_kg",
                 "perfusion_per_s", "damage_rate_per_s", "damage_energy_j_mol", "char_temperature_c",
                 "most_temperature_c", "layer_depth_m", "fibre_width_m", "fibre_density_kg_m3",
                 "least_strand_mass_kg", "least_node_mass_kg", "quarter_power_m", "source"});
  made.heat.tissue.specific_heat = group.Number("specific_heat_j_kg_k", kSpecificHeat);
  made.heat.tissue.conductivity = group.Number("conductivity_w_m_k", kConductivity);
  made.heat.tissue.water_share = group.Number("water_share", kLeastShare);
  made.heat.tissue.latent_heat = group.Number("latent_heat_j_kg", kLatentHeat);
  made.heat.tissue.perfusion = group.Number("perfusion_per_s", kRate);
  made.heat.tissue.damage_rate = group.Number("damage_rate_per_s", kDamageRate);
  made.heat.tissue.damage_energy = group.Number("damage_energy_j_mol", kDamageEnergy);
  made.heat.tissue.char_temperature = group.Number("char_temperature_c", kTemperature);
  made.heat.tissue.most_temperature = group.Number("most_temperature_c", kTemperature);
  made.heat.layer_depth = group.Number("layer_depth_m", kLength);
  made.heat.fibre_width = group.Number("fibre_width_m", kLength);
  made.heat.fibre_density = group.Number("fibre_density_kg_m3", kTissueDensity);
  made.heat.least_strand_mass = group.Number("least_strand_mass_kg", kMass);
  made.heat.least_node_mass = group.Number("least_node_mass_kg", kMass);
  made.heat.quarter_power = group.Number("quarter_power_m", kLength);
}

void ReadElectrode(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group =
      OpenGroup(root, "electrode",
                {"cut_power_w", "cut_reach_m", "coagulate_power_w", "coagulate_reach_m", "seal_reach_m",
                 "seal_heat_j", "burnt_hole_m2", "burnt_rim_m", "smoke_by_heat_per_j", "source"});
  made.electrode.cut.power = group.Number("cut_power_w", kWatts);
  made.electrode.cut.reach = group.Number("cut_reach_m", kLength);
  made.electrode.coagulate.power = group.Number("coagulate_power_w", kWatts);
  made.electrode.coagulate.reach = group.Number("coagulate_reach_m", kLength);
  made.electrode.seal_reach = group.Number("seal_reach_m", kLength);
  made.electrode.seal_heat = group.Number("seal_heat_j", kJoules);
  made.electrode.burnt_hole = group.Number("burnt_hole_m2", kArea);
  made.electrode.burnt_rim = group.Number("burnt_rim_m", kLength);
  made.electrode.smoke_by_heat = group.Number("smoke_by_heat_per_j", kSmoke);
}

void ReadSuction(const JsonView& root, scene::OperationParameters& made) {
  const JsonView group = OpenGroup(root, "suction",
                                   {"rinse_rate_m3_s", "aspirate_rate_m3_s", "pool_reach_m",
                                    "smoke_rate_per_s", "smoke_fade_per_s", "source"});
  made.suction.rinse_rate = group.Number("rinse_rate_m3_s", kFlowRate);
  made.suction.aspirate_rate = group.Number("aspirate_rate_m3_s", kFlowRate);
  made.suction.pool_reach = group.Number("pool_reach_m", kLength);
  made.suction.smoke_rate = group.Number("smoke_rate_per_s", kRate);
  made.suction.smoke_fade = group.Number("smoke_fade_per_s", kRate);
}

}  // namespace

base::Result<scene::OperationParameters> ReadOperationParameters(const std::filesystem::path& path,
                                                                 const std::string& patch) {
  auto document = ReadPatched(path, patch);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "fluids", "supplies", "vessels", "clips", "stones", "bed",
                  "heat", "electrode", "suction", "judgement"});
  if (root.Text("format") != "trocar-operation") root.Complain("format must be \"trocar-operation\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  scene::OperationParameters made;
  ReadFluids(root, made);
  ReadSupplies(root, made);
  ReadVessels(root, made);
  ReadClips(root, made);
  ReadStones(root, made);
  ReadBed(root, made);
  ReadHeat(root, made);
  ReadElectrode(root, made);
  ReadSuction(root, made);
  ReadJudgement(root, made);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return made;
}

}  // namespace trocar::files
