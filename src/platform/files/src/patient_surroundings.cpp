// SPDX-License-Identifier: Apache-2.0
#include "patient_surroundings.h"

#include "trocar/files/patient_frame.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"

namespace trocar::files {
namespace {

using host::JsonView;
using Json = nlohmann::ordered_json;

constexpr host::NumberRange kPortMm{-3000, 3000};
constexpr host::NumberRange kTableDeg{-30, 30};
constexpr host::NumberRange kLabel{0, 2147483647};
roles::NeighbourRole ReadRole(const JsonView& view, const std::string& name) {
  if (!view.Has("role")) return roles::ConventionalRole<roles::NeighbourRole>(name);
  const auto role = roles::FindRole<roles::NeighbourRole>(view.Text("role"));
  if (!role) view.Complain("role must be other, or one of " + roles::ListNames<roles::NeighbourRole>());
  return role.value_or(roles::NeighbourRole::kOther);
}

void ReadPort(const JsonView& view, std::vector<patient::Port>& ports) {
  view.AllowOnly({"for", "position", "reason"});
  patient::Port port;
  const std::string use = view.Text("for");
  const auto found = patient::FindPortUse(use);
  if (!found) view.Complain("for must be laparoscope, left_hand, right_hand or assistant");
  port.use = found.value_or(port.use);
  const auto p = view.Numbers("position", 3, kPortMm);
  port.position = FromLps({p[0], p[1], p[2]});
  port.reason = view.Text("reason");
  ports.push_back(std::move(port));
}

}  // namespace

void ReadSurroundings(const JsonView& root, patient::Patient& patient) {
  if (root.Has("neighbours")) {
    for (const JsonView& view : root.Array("neighbours")) {
      view.AllowOnly({"name", "role", "mesh", "seen"});
      patient::Neighbour neighbour{view.Text("name"), {}};
      neighbour.role = ReadRole(view, neighbour.name);
      neighbour.is_seen = view.BooleanOr("seen", true);
      if (!patient::IsPlainName(neighbour.name)) view.Complain("name must consist of a-z, 0-9 and _");
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
    patient.table =
        patient::Table{math::kDegree * view.Number("head_up_deg", kTableDeg),
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

std::vector<std::pair<std::string, Json>> MakeSurroundingsJson(const patient::Patient& patient) {
  std::vector<std::pair<std::string, Json>> members;
  if (!patient.neighbours.empty()) {
    Json neighbours = Json::array();
    for (const patient::Neighbour& one : patient.neighbours) {
      Json json = {{"name", one.name}, {"mesh", one.name + ".ply"}, {"seen", one.is_seen}};
      if (one.role != roles::ConventionalRole<roles::NeighbourRole>(one.name))
        json["role"] = roles::NameOf(one.role);
      neighbours.push_back(std::move(json));
    }
    members.emplace_back("neighbours", std::move(neighbours));
  }
  if (!patient.ports.empty()) {
    Json ports = Json::array();
    for (const patient::Port& port : patient.ports) {
      const math::Vec3 p = ToLps(port.position);
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
    for (const patient::SourceLabel& one : patient.labels) {
      Json json = {{"label", one.label}, {"taken_as", one.meaning}, {"reason", one.reason}};
      if (!one.doubt.empty()) json["doubt"] = one.doubt;
      labels.push_back(std::move(json));
    }
    members.emplace_back("labels", std::move(labels));
  }
  return members;
}

}  // namespace trocar::files
