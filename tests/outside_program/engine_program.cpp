// SPDX-License-Identifier: Apache-2.0
// The engine alone, without a file: a sphere of liver on its diaphragm, which a grasper presses from the front for half a second.
// Prints how far its front gives way, and the hash of the state.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "trocar/geometry/primitives.h"
#include "trocar/simulation/simulation.h"

namespace {

using namespace trocar;

patient::Patient MakePatient() {
  patient::Organ liver{"liver", geometry::MakeSphere({0, 0.1, -0.12}, 0.03, 3), {}};
  patient::Region face{patient::kDiaphragmaticFace, {}};
  for (std::uint32_t i = 0; i < liver.mesh.positions.size(); ++i) {
    if (liver.mesh.positions[i].y > 0.115) face.vertices.push_back(i);
  }
  liver.regions.push_back(face);
  patient::Patient patient;
  patient.name = "one sphere";
  patient.provenance = "made by a program";
  patient.organs = {liver};
  return patient;
}

scene::Scene MakeScene() {
  scene::Scene scene;
  scene.name = "one sphere";
  scene.patient = MakePatient();
  scene::OrganMaterial liver;
  liver.organ = "liver";
  liver.young_modulus = 1e6, liver.wall_thickness = 4e-5;
  liver.foundation_modulus = 5400, liver.depth = 0.08;
  liver.density = 1060;
  liver.tissue = roles::TissueRole::kLiver;
  scene.materials = {liver};
  const math::Vec3 front{0, 0.1, -0.085};
  for (std::size_t hand = 0; hand < scene.instruments.size(); ++hand) {
    scene::InstrumentSetup& setup = scene.instruments[hand];
    setup.tool = *instrument::FindTool("grasper");
    setup.tray = {setup.tool};
    setup.p_world_port = {hand == 0 ? -0.03 : 0.03, 0.1, 0};
    setup.home =
        instrument::FindJoints(setup.p_world_port, front + math::Vec3{hand == 0 ? 0.0 : 0.04, 0, 0}, 0, 0);
  }
  scene.laparoscope.p_world_port = {0, 0, 0};
  scene.laparoscope.home = instrument::FindJoints({0, 0, 0}, {0, 0.05, -0.05}, 0, 0);
  return scene;
}

/// The foremost node [m].
double FrontOf(const simulation::Snapshot& now) {
  double front = -1;
  for (const math::Vec3& p : now.positions) front = std::max(front, p.z);
  return front;
}

}  // namespace

int main() {
  const auto scene = std::make_shared<const scene::Scene>(MakeScene());
  auto simulation = simulation::Simulation::Make(scene);
  if (!simulation.ok()) {
    std::fprintf(stderr, "%s\n", simulation.error().Text().c_str());
    return 1;
  }
  const double before = FrontOf(simulation->GetSnapshot());
  scene::Input input = scene::CalcScriptInput(*scene, 0.0);
  for (int tick = 0; tick < 60; ++tick) {
    input.hands[0].depth += 0.010 / 60;
    simulation->Step(input);
  }
  const double given_way = before - FrontOf(simulation->GetSnapshot());
  std::printf("%.1f mm, state %016llx\n", 1e3 * given_way,
              static_cast<unsigned long long>(simulation->Hash()));
  return given_way > 0 ? 0 : 1;
}
