// SPDX-License-Identifier: Apache-2.0
#include "trocar/render/looks.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "single_precision.h"
#include "trocar/host/json.h"

namespace trocar::render {
namespace {

using host::JsonView;
using host::NumberRange;

constexpr NumberRange kShare{0, 1}, kTile{1e-4, 10};

/// Numbers that must all lie in a range.
std::vector<double> ReadNumbers(const JsonView& view, std::string_view key, const NumberRange& range) {
  const std::vector<double> numbers = view.Numbers(key, 3);
  for (const double number : numbers) {
    if (!(number >= range.min && number <= range.max))
      view.Complain(std::string(key) + " must have numbers from " + std::to_string(range.min) + " to " +
                    std::to_string(range.max));
  }
  return numbers;
}

/// Linear reflectance of an sRGB byte triple, as a colour picker on a photograph shows it.
Colour ReadColour(const JsonView& view, std::string_view key) {
  const std::vector<double> bytes = ReadNumbers(view, key, {0, 255});
  Colour colour{};
  for (std::size_t i = 0; i < std::min(bytes.size(), colour.size()); ++i) {
    const double value = bytes[i] / 255.0;
    colour[i] = static_cast<float>(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
  }
  return colour;
}

MaterialLook ReadLook(const JsonView& view) {
  view.AllowOnly({"is_tissue",   "low_srgb",      "high_srgb",    "cell_srgb",     "vessel_srgb",
                  "cell_amount", "vessel_amount", "vessel_width", "detail_tile_m", "broad_tile_m",
                  "bump_tile_m", "bump",          "wet",          "wet_exponent",  "sheen",
                  "wrap",        "glow",          "grooves",      "wear",          "opacity",
                  "emission",    "line_tile_m",   "lines"});
  MaterialLook look;
  const auto number = [&view](std::string_view key, float& value, const NumberRange& range) {
    value = ToFloat(view.NumberOr(key, double{value}, range));
  };
  const auto triple = [&view](std::string_view key, Colour& value, const NumberRange& range) {
    if (!view.Has(key)) return;
    const std::vector<double> numbers = ReadNumbers(view, key, range);
    for (std::size_t i = 0; i < std::min(numbers.size(), value.size()); ++i) value[i] = ToFloat(numbers[i]);
  };
  look.is_tissue = view.BooleanOr("is_tissue", look.is_tissue);
  look.low = ReadColour(view, "low_srgb");
  look.high = ReadColour(view, "high_srgb");
  if (view.Has("cell_srgb")) look.cell = ReadColour(view, "cell_srgb");
  if (view.Has("vessel_srgb")) look.vessel = ReadColour(view, "vessel_srgb");
  number("cell_amount", look.cell_amount, kShare);
  number("vessel_amount", look.vessel_amount, kShare);
  number("vessel_width", look.vessel_width, kShare);
  triple("detail_tile_m", look.detail_tile, kTile);
  number("broad_tile_m", look.broad_tile, kTile);
  number("bump_tile_m", look.bump_tile, kTile);
  number("bump", look.bump, kShare);
  number("wet", look.wet, kShare);
  number("wet_exponent", look.wet_exponent, {1, 10000});
  number("sheen", look.sheen, kShare);
  triple("wrap", look.wrap, kShare);
  number("glow", look.glow, kShare);
  number("grooves", look.grooves, kShare);
  number("wear", look.wear, kShare);
  number("line_tile_m", look.line_tile, {0, 10});
  number("lines", look.lines, kShare);
  number("opacity", look.opacity, kShare);
  number("emission", look.emission, {0, 100});
  return look;
}

void ReadEffects(const JsonView& view, Looks& looks) {
  for (const std::string& name : view.Keys()) {
    bool is_known = false;
    for (std::size_t i = 0; i < looks.effects.size(); ++i)
      is_known = is_known || EffectName(static_cast<Effect>(i)) == name;
    if (!is_known) view.Complain("there is no effect \"" + name + "\"");
  }
  for (std::size_t i = 0; i < looks.effects.size(); ++i) {
    const std::vector<double> numbers = ReadNumbers(view, EffectName(static_cast<Effect>(i)), kShare);
    if (numbers.size() == 3) std::copy(numbers.begin(), numbers.end(), looks.effects[i].begin());
  }
}

}  // namespace

std::string_view EffectName(Effect effect) noexcept {
  static constexpr std::string_view kNames[] = {"smoke",         "blanched",         "scorched",
                                                "charred",       "blood_film",       "bile_film",
                                                "pallor",        "thin_rim",         "shade",
                                                "bounce",        "tissue_highlight", "metal_highlight",
                                                "mirrored_lens", "mirrored_tissue",  "mirrored_wall",
                                                "mirrored_box",  "strand_shade"};
  static_assert(std::size(kNames) == static_cast<std::size_t>(Effect::kCount));
  return kNames[static_cast<std::size_t>(effect)];
}

base::Result<Looks> ReadLooks(const std::filesystem::path& path) {
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "about", "light_offset_m", "smoke_per_m", "pigment", "trainer_light",
                  "trainer_lid", "effects_linear", "materials"});
  if (root.Text("format") != "trocar-looks") root.Complain("format must be \"trocar-looks\"");
  if (root.Integer("version") != 1) root.Complain("version must be 1");
  Looks looks;
  if (const auto offset = ReadNumbers(root, "light_offset_m", {-0.1, 0.1}); offset.size() == 3)
    looks.light_offset = {offset[0], offset[1], offset[2]};
  looks.smoke = root.Number("smoke_per_m", {0, 10000});
  looks.trainer_light = root.Number("trainer_light", {0, 100});
  looks.trainer_lid = root.Number("trainer_lid", {0, 100});
  ReadEffects(root.Object("effects_linear"), looks);
  const JsonView pigment = root.Object("pigment");
  pigment.AllowOnly({"blood", "bile", "rinse"});
  constexpr NumberRange kPigment{1e-4, 1000};
  looks.pigment = {pigment.Number("blood", kPigment), pigment.Number("bile", kPigment),
                   pigment.Number("rinse", kPigment)};
  const JsonView materials = root.Object("materials");
  for (const std::string& name : materials.Keys()) {
    if (!FindMaterial(name)) materials.Complain("there is no material \"" + name + "\"");
  }
  for (std::size_t i = 0; i < looks.materials.size(); ++i)
    looks.materials[i] = ReadLook(materials.Object(MaterialName(static_cast<Material>(i))));
  if (const auto status = document->Check(); !status.ok()) return status.error();
  return looks;
}

}  // namespace trocar::render
