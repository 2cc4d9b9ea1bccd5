// SPDX-License-Identifier: Apache-2.0
#include "patient_surroundings.h"

#include <algorithm>
#include <cmath>

#include "patient_frame.h"
#include "trocar/geometry/mesh_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/math/rotation_angle.h"

namespace trocar::anatomy {
namespace {

using core::Error;
using core::ErrorCode;
using core::JsonView;
using Json = nlohmann::ordered_json;

constexpr core::NumberRange kPortMm{-3000, 3000};
constexpr core::NumberRange kTableDeg{-30, 30};
constexpr core::NumberRange kLabel{0, 2147483647};
constexpr double kMostTableTilt = 30 * math::kDegree;
constexpr const char* kUses[] = {"laparoscope", "left_hand", "right_hand", "assistant"};
static_assert(std::size(kUses) == kPortUseCount);

Error Invalid(const std::string& what) {
  return {ErrorCode::kPatientInvalid, "the patient is inconsistent: " + what + "; build it again"};
}

NeighbourRole ReadRole(const JsonView& view, const std::string& name) {
  if (!view.Has("role")) return roles::ConventionalRole<NeighbourRole>(name);
  const auto role = roles::FindRole<NeighbourRole>(view.Text("role"));
  if (!role) view.Complain("role must be other, or one of " + roles::ListNames<NeighbourRole>());
  return role.value_or(NeighbourRole::kOther);
}

void ReadPort(const JsonView& view, std::vector<Port>& ports) {
  view.AllowOnly({"for", "position", "reason"});
  Port port;
  const std::string use = view.Text("for");
  const auto found = std::find(std::begin(kUses), std::end(kUses), use);
  if (found == std::end(kUses)) {
    view.Complain("for must be laparoscope, left_hand, right_hand or assistant");
  } else {
    port.use = static_cast<PortUse>(found - std::begin(kUses));
  }
  const auto p = view.Numbers("position", 3, kPortMm);
  port.position = FromLps({p[0], p[1], p[2]});
  port.reason = view.Text("reason");
  ports.push_back(std::move(port));
}

}  // namespace

const char* NameOf(PortUse use) noexcept {
  return kUses[static_cast<std::size_t>(use)];
}

void ReadSurroundings(const JsonView& root, Patient& patient) {
  if (root.Has("neighbours")) {
    for (const JsonView& view : root.Array("neighbours")) {
      view.AllowOnly({"name", "role", "mesh", "seen"});
      Neighbour neighbour{view.Text("name"), {}};
      neighbour.role = ReadRole(view, neighbour.name);
      neighbour.is_seen = view.BooleanOr("seen", true);
      if (!IsPlainName(neighbour.name)) view.Complain("name must consist of a-z, 0-9 and _");
      if (view.Text("mesh") != neighbour.name + ".ply")
        view.Complain("mesh must be the neighbour's name and .ply");
      patient.neighbours.push_back(std::move(neighbour));
    }
  }
  if (root.Has("ports")) {
    for (const JsonView& view : root.Array("ports")) ReadPort(view, patient.ports);
  }
  if (root.Has("table")) {
    const JsonView view = root.Object("table");
    view.AllowOnly({"head_up_deg", "right_up_deg", "reason"});
    patient.table = Table{math::kDegree * view.Number("head_up_deg", kTableDeg),
                          math::kDegree * view.Number("right_up_deg", kTableDeg), view.Text("reason")};
  }
  if (root.Has("labels")) {
    for (const JsonView& view : root.Array("labels")) {
      view.AllowOnly({"label", "taken_as", "reason", "doubt"});
      patient.labels.push_back({view.Integer("label", kLabel), view.Text("taken_as"), view.Text("reason"),
                                view.TextOr("doubt", "")});
    }
  }
}

std::vector<std::pair<std::string, Json>> MakeSurroundingsJson(const Patient& patient) {
  std::vector<std::pair<std::string, Json>> members;
  if (!patient.neighbours.empty()) {
    Json neighbours = Json::array();
    for (const Neighbour& one : patient.neighbours) {
      Json json = {{"name", one.name}, {"mesh", one.name + ".ply"}, {"seen", one.is_seen}};
      if (one.role != roles::ConventionalRole<NeighbourRole>(one.name))
        json["role"] = roles::NameOf(one.role);
      neighbours.push_back(std::move(json));
    }
    members.emplace_back("neighbours", std::move(neighbours));
  }
  if (!patient.ports.empty()) {
    Json ports = Json::array();
    for (const Port& port : patient.ports) {
      const Vec3 p = ToLps(port.position);
      ports.push_back(
          {{"for", NameOf(port.use)}, {"position", Json::array({p.x, p.y, p.z})}, {"reason", port.reason}});
    }
    members.emplace_back("ports", std::move(ports));
  }
  if (patient.table) {
    members.emplace_back("table", Json{{"head_up_deg", patient.table->head_up / math::kDegree},
                                       {"right_up_deg", patient.table->right_up / math::kDegree},
                                       {"reason", patient.table->reason}});
  }
  if (!patient.labels.empty()) {
    Json labels = Json::array();
    for (const SourceLabel& one : patient.labels) {
      Json json = {{"label", one.label}, {"taken_as", one.meaning}, {"reason", one.reason}};
      if (!one.doubt.empty()) json["doubt"] = one.doubt;
      labels.push_back(std::move(json));
    }
    members.emplace_back("labels", std::move(labels));
  }
  return members;
}

core::Status CheckSurroundings(const Patient& patient, std::set<std::string>& names) {
  if (const Neighbour* second = FindSecondOfRole(patient.neighbours); second != nullptr) {
    return Invalid("two neighbours have the role " + roles::SpokenName(second->role) + ", '" + second->name +
                   "' is one of them");
  }
  for (const Neighbour& one : patient.neighbours) {
    if (!IsPlainName(one.name))
      return Invalid("neighbour's name '" + one.name + "' must consist of a-z, 0-9 and _");
    if (!names.insert(one.name).second) return Invalid("the name '" + one.name + "' is used twice");
    if (const auto status = geometry::CheckMesh(one.mesh); !status.ok())
      return Invalid(one.name + ": " + status.error().message);
    const auto report = geometry::InspectMesh(one.mesh);
    if (!report.closed || !report.manifold || !report.outward) {
      return Error{ErrorCode::kMeshNotClosed,
                   "the mesh of " + one.name + " is not closed, manifold and outward; repair it"};
    }
  }
  bool is_used[kPortUseCount] = {};
  for (const Port& port : patient.ports) {
    bool& is_there = is_used[static_cast<std::size_t>(port.use)];
    if (is_there) return Invalid(std::string("there are two ports for ") + NameOf(port.use));
    is_there = true;
    if (!math::IsFinite(port.position))
      return Invalid(std::string("the port for ") + NameOf(port.use) + " is nowhere");
  }
  if (patient.table) {
    for (const double tilt : {patient.table->head_up, patient.table->right_up}) {
      if (!(std::fabs(tilt) <= kMostTableTilt * (1 + 1e-9)))
        return Invalid("the table tilts by more than 30 degrees");
    }
  }
  return {};
}

}  // namespace trocar::anatomy
