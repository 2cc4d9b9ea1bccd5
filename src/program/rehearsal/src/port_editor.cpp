// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/port_editor.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "trocar/anatomy/move_port.h"
#include "trocar/host/translate.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"

namespace trocar::rehearsal {
namespace {

constexpr double kSameTilt = 0.01 * math::kDegree;
constexpr std::size_t kMostUndo = 200;

PortPlan PlanOf(const patient::Patient& patient) {
  return {patient.ports, patient.table};
}

}  // namespace

void PortEditor::Begin(const patient::Patient& patient) {
  Forget();
  proposal_ = PlanOf(patient);
}

void PortEditor::Remember(PortPlan before, const patient::Patient& patient) {
  if (PlanOf(patient) == before) return;
  undo_.push_back(std::move(before));
  if (undo_.size() > kMostUndo) undo_.erase(undo_.begin());
  redo_.clear();
}

base::Status PortEditor::Move(patient::Patient& patient, std::size_t port, double x, double y) {
  auto moved = anatomy::MovePort(patient, patient.ports[port].use, x, y);
  if (!moved.ok()) return moved.error();
  PortPlan before = PlanOf(patient);
  patient.ports[port] = std::move(*moved);
  if (!grabbed_) Remember(std::move(before), patient);
  return {};
}

void PortEditor::Grab(const patient::Patient& patient) {
  grabbed_ = PlanOf(patient);
}

void PortEditor::Release(const patient::Patient& patient) {
  if (grabbed_) Remember(*std::exchange(grabbed_, std::nullopt), patient);
}

bool PortEditor::Tilt(patient::Patient& patient, double head_up_deg, double right_up_deg) {
  const auto tilt = [](double degrees) {
    return std::clamp(degrees, -kMostTiltDeg, kMostTiltDeg) * math::kDegree;
  };
  const patient::Table table = patient.table.value_or(patient::Table{});
  if (std::fabs(tilt(head_up_deg) - table.head_up) < kSameTilt &&
      std::fabs(tilt(right_up_deg) - table.right_up) < kSameTilt)
    return false;
  PortPlan before = PlanOf(patient);
  patient.table =
      patient::Table{tilt(head_up_deg), tilt(right_up_deg), std::string(host::Mark("Tilted by hand")) + "."};
  Remember(std::move(before), patient);
  return true;
}

bool PortEditor::Exchange(std::vector<PortPlan>& from, std::vector<PortPlan>& to, patient::Patient& patient) {
  if (from.empty()) return false;
  to.push_back(PlanOf(patient));
  Use(from.back(), patient);
  from.pop_back();
  return true;
}

void PortEditor::Reset(patient::Patient& patient) {
  PortPlan before = PlanOf(patient);
  Use(proposal_, patient);
  Remember(std::move(before), patient);
}

void PortEditor::Use(const PortPlan& plan, patient::Patient& patient) {
  patient.ports = plan.ports;
  patient.table = plan.table;
}

std::optional<PortPlan> PortEditor::FindChange(const patient::Patient& patient) const {
  PortPlan now = PlanOf(patient);
  if (now == proposal_) return std::nullopt;
  return now;
}

}  // namespace trocar::rehearsal
