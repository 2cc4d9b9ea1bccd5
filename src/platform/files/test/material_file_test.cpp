// SPDX-License-Identifier: Apache-2.0
#include "material_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "small_scene.h"
#include "trocar/host/threads.h"
#include "trocar/simulation/simulation.h"

namespace trocar::files {

using scene::CalcScriptInput;
using scene::OrganMaterial;
using scene::SmallScene;
using surgery::FactKind;
namespace {

class MaterialFile : public SmallScene {
 protected:
  static constexpr const char* kWall =
      R"({"format": "trocar-material", "version": 1, "young_modulus_pa": 255000, "wall_thickness_mm": 0.5,)"
      R"( "internal_pressure_pa": 300, "failure_force_n": 9, "sources": {"young_modulus_pa": "a table",)"
      R"( "wall_thickness_mm": "a tunable", "internal_pressure_pa": "hydrops", "failure_force_n": "a tunable"}})";

  base::Result<OrganMaterial> ReadOne(const std::string& text) {
    Write("wall.json", text);
    return ReadEntry();
  }
  base::Result<OrganMaterial> ReadEntry() {
    auto document = host::JsonDocument::Parse(
        R"({"materials": [{"organ": "gallbladder", "file": "wall.json"}]})", "test");
    auto materials = ReadMaterials(document->Root(), folder_);
    if (!materials.ok()) return materials.error();
    return std::move(materials->front());
  }
  static std::string Replace(std::string text, const std::string& what, const std::string& by) {
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), by);
  }
};

TEST_F(MaterialFile, IsReadWithItsSources) {
  const auto material = ReadOne(kWall);
  ASSERT_TRUE(material.ok()) << material.error().Text();
  EXPECT_EQ(material->organ, "gallbladder");
  EXPECT_DOUBLE_EQ(material->wall_thickness, 0.0005);
  EXPECT_DOUBLE_EQ(material->internal_pressure, 300.0);
  EXPECT_DOUBLE_EQ(material->failure_force, 9.0);
  EXPECT_TRUE(std::isinf(material->failure_strain)) << "not given: never tears";
  EXPECT_NE(material->source.find("a table"), std::string::npos);
}

TEST_F(MaterialFile, AFigureWithoutASourceIsRefused) {
  const auto missing = ReadOne(Replace(kWall, "\"young_modulus_pa\": \"a table\",", ""));
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, base::ErrorCode::kJsonField);
  EXPECT_NE(missing.error().message.find("young_modulus_pa"), std::string::npos) << missing.error().message;
  EXPECT_FALSE(
      ReadOne(Replace(kWall, "\"a table\"", "\"a table\", \"density_kg_m3\": \"nobody asked\"")).ok());
}

TEST_F(MaterialFile, RefusesWhatIsWrong) {
  EXPECT_FALSE(ReadOne(Replace(kWall, "trocar-material", "trocar-scene")).ok());
  EXPECT_FALSE(ReadOne(Replace(kWall, "\"version\": 1", "\"version\": 2")).ok());
  EXPECT_FALSE(ReadOne(Replace(kWall, "255000", "-1")).ok());
  EXPECT_FALSE(ReadOne(Replace(kWall, "\"failure_force_n\": 9", "\"failure_force_n\": 0")).ok());
  EXPECT_FALSE(ReadOne(Replace(kWall, "internal_pressure_pa\": 300", "internal_pressure_pa\": 1e6")).ok());
  const std::string text = kWall;
  for (std::size_t length = 0; length < text.size(); length += 7)
    EXPECT_FALSE(ReadOne(text.substr(0, length)).ok());
  std::filesystem::remove(folder_ / "wall.json");
  EXPECT_FALSE(ReadEntry().ok());
}

TEST_F(MaterialFile, ATenseGallbladderStartsUnderItsPressure) {
  Write("wall.json", Replace(kWall, "\"failure_force_n\": 9, ", ""));
  std::string wall = Replace(kWall, " \"failure_force_n\": 9,", "");
  wall = Replace(wall, ", \"failure_force_n\": \"a tunable\"", "");
  wall = Replace(wall, "\"sources\": {",
                 "\"foundation_modulus_pa\": 3000, \"sources\": {\"foundation_modulus_pa\": \"test\", ");
  Write("wall.json", wall);
  std::string scene = SceneText();
  const auto from = scene.find("{\"organ\": \"gallbladder\","), to = scene.find('}', from);
  scene.replace(from, to - from + 1, R"({"organ": "gallbladder", "file": "wall.json"})");
  Write("scene.json", scene);
  auto read = Read();
  ASSERT_TRUE(read.ok()) << read.error().Text();
  auto simulation = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*read)));
  ASSERT_TRUE(simulation.ok()) << simulation.error().Text();
  const auto& organs = simulation->GetSnapshot().organs;
  ASSERT_EQ(organs.size(), 2u);
  EXPECT_NEAR(organs[1].pressure, 300.0, 1.0);
  const double tense = organs[1].volume;
  Write("scene.json", SceneText());
  auto slack = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*Read())));
  ASSERT_TRUE(slack.ok());
  EXPECT_GT(tense, 1.001 * slack->GetSnapshot().organs[1].volume);
  // and stays so while nothing acts
  scene::Input input = CalcScriptInput(simulation->GetScene(), 0.0);
  for (int tick = 0; tick < 60; ++tick) simulation->Step(input);
  EXPECT_NEAR(simulation->GetSnapshot().organs[1].volume / tense, 1.0, 1e-6);
  EXPECT_NEAR(simulation->GetSnapshot().organs[1].pressure, 300.0, 15.0);
  simulation->Reset();
  EXPECT_NEAR(simulation->GetSnapshot().organs[1].volume / tense, 1.0, 1e-12);
}

TEST_F(MaterialFile, AWeakBedTearsUnderTractionAndTheEventSaysSo) {
  std::string scene = SceneText();
  const std::string bed = "\"wall_thickness_mm\": 1.5,";
  const auto at = scene.find(bed);
  ASSERT_NE(at, std::string::npos);
  scene.insert(at, "\"failure_strain\": 0.02, ");
  Write("scene.json", scene);
  auto read = Read();
  ASSERT_TRUE(read.ok()) << read.error().Text();
  auto simulation = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*read)));
  ASSERT_TRUE(simulation.ok());
  std::set<FactKind> seen;
  std::uint64_t events = 0;
  for (int tick = 0; tick < 150; ++tick) {
    simulation->Step(CalcScriptInput(simulation->GetScene(), simulation->GetSnapshot().time));
    const simulation::Snapshot& now = simulation->GetSnapshot();
    for (; events < now.event_count; ++events) seen.insert(now.events[events % now.events.size()].kind);
  }
  EXPECT_TRUE(seen.count(FactKind::kTear));
}

TEST_F(MaterialFile, AWallThatStiffensAndTearsIsRead) {
  const auto with = [&](const std::string& figures) {
    return ReadOne(Replace(kWall, "\"sources\": {", figures));
  };
  const auto material = with(R"("stiffening": 10, "stiffening_strain": 0.25, "wall_failure_strain": 0.43, )"
                             R"("wall_damage_per_s": 0.5, "wall_damage_exponent": 3, "sources": {)"
                             R"("stiffening": "a", "stiffening_strain": "b", "wall_failure_strain": "c", )"
                             R"("wall_damage_per_s": "d", "wall_damage_exponent": "e", )");
  ASSERT_TRUE(material.ok()) << material.error().Text();
  EXPECT_EQ(material->wall_law, (tissue::SpringLaw{10, 0.25, 0.43, 0.5, 3}));
  EXPECT_EQ(ReadOne(kWall)->wall_law, tissue::SpringLaw{}) << "not given: Hooke's law, and nothing tears";
  const auto alone = with(R"("wall_damage_per_s": 0.5, "sources": {"wall_damage_per_s": "d", )");
  ASSERT_FALSE(alone.ok());
  EXPECT_NE(alone.error().message.find("needs wall_failure_strain"), std::string::npos);
  EXPECT_FALSE(with(R"("stiffening": -1, "sources": {"stiffening": "a", )").ok());
}

TEST_F(MaterialFile, AWeakWallTearsUnderTractionAndLeaks) {
  std::string text = SceneText();
  const auto at = text.find("\"young_modulus_pa\"", text.find("{\"organ\": \"gallbladder\","));
  ASSERT_NE(at, std::string::npos);
  text.insert(at, R"("stiffening": 10, "wall_failure_strain": 0.05, )");
  Write("scene.json", text);
  auto read = Read();
  ASSERT_TRUE(read.ok()) << read.error().Text();
  const auto scene = std::make_shared<const scene::Scene>(std::move(*read));
  std::uint64_t hash = 0;
  for (const int threads : {1, 3}) {
    auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(threads)});
    ASSERT_TRUE(simulation.ok());
    int tears = 0;
    std::uint64_t events = 0;
    for (int tick = 0; tick < 150; ++tick) {
      simulation->Step(CalcScriptInput(*scene, simulation->GetSnapshot().time));
      const simulation::Snapshot& now = simulation->GetSnapshot();
      EXPECT_TRUE(std::isfinite(now.residual));
      for (; events < now.event_count; ++events) {
        const scene::Event& event = now.events[events % now.events.size()];
        if (event.kind != FactKind::kTear) continue;
        EXPECT_EQ(event.organ, 1) << "the gallbladder";
        ++tears;
      }
    }
    EXPECT_GT(tears, 0);
    const auto& organs = simulation->GetSnapshot().organs;
    EXPECT_EQ(organs[0].leaked, 0.0) << "a liver is not hollow";
    EXPECT_GE(organs[1].leaked, 0.0);
    if (threads == 1) hash = simulation->Hash();
    EXPECT_EQ(simulation->Hash(), hash);
    simulation->Reset();
    for (int tick = 0; tick < 150; ++tick)
      simulation->Step(CalcScriptInput(*scene, simulation->GetSnapshot().time));
    EXPECT_EQ(simulation->Hash(), hash) << "what tore is whole again after a reset";
  }
}

}  // namespace
}  // namespace trocar::files
