// SPDX-License-Identifier: Apache-2.0
#include "surround_patient.h"

#include <cmath>
#include <utility>

#include "neighbour_template.h"
#include "port_placement.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {

void SurroundPatient(const BodyShape& body, BuildReport& report) {
  patient::Patient& patient = report.patient;
  for (patient::Neighbour& one : MakeTemplateNeighbours(patient, FindMidline(patient, body))) {
    report.neighbours.push_back({one.name, false});
    patient.neighbours.push_back(std::move(one));
  }
  PlacePorts(body, patient);
  report.sinking = SinkUnderGas(patient);
  for (std::size_t i = 0; i < report.neighbours.size(); ++i) {
    NeighbourReport& one = report.neighbours[i];
    const auto inspected = geometry::InspectMesh(patient.neighbours[i].mesh);
    one.triangles = inspected.triangles;
    one.volume_ml = 1e6 * inspected.volume;
    one.min_angle_deg = inspected.min_angle * 180.0 / M_PI;
  }
}

}  // namespace trocar::anatomy
