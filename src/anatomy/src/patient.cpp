// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "patient_frame.h"
#include "patient_surroundings.h"
#include "trocar/core/json.h"
#include "trocar/core/json_text.h"
#include "trocar/core/partial_path.h"
#include "trocar/core/safe_file.h"
#include "trocar/geometry/mesh_file.h"
#include "trocar/geometry/mesh_measures.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using core::Error;
using core::ErrorCode;
using core::JsonView;

constexpr const char* kFormat = "trocar-patient";
constexpr int kVersion = 1;

// In which ranges a patient's quantities mean something; schemas/patient.schema.json says the same.
/// Of a coordinate [mm]: the frame's origin lies in the body, or where a scanner's table is.
constexpr core::NumberRange kCoordinateMm{-3000, 3000};
constexpr core::NumberRange kRadiusMm{0.01, 50};  // of a duct or vessel
constexpr core::NumberRange kIndex{0, 4294967294.0};
constexpr core::NumberRange kOrganIndex{0, 1e6};
constexpr core::NumberRange kParameter{-1e6, 1e6};
/// Diagonal of an organ's box [m]: a person's largest and smallest.
constexpr double kLargestOrgan = 1.0, kSmallestOrgan = 0.002;

Error Invalid(const std::string& what) {
  return {ErrorCode::kPatientInvalid, "the patient is inconsistent: " + what + "; build it again"};
}

nlohmann::ordered_json PointJson(const Vec3& world) {
  const Vec3 p = ToLps(world);
  return nlohmann::ordered_json::array({p.x, p.y, p.z});
}

Vec3 PointFrom(const JsonView& view, std::string_view key) {
  const auto p = view.Numbers(key, 3, kCoordinateMm);
  return FromLps({p[0], p[1], p[2]});
}

std::uint32_t IndexFrom(const JsonView& view) {
  const double value = view.AsNumber(kIndex);
  if (value != std::floor(value)) view.Complain("must be a whole number");
  return static_cast<std::uint32_t>(value);
}

/// The role that is stated, or that of the name.
template <class Role>
Role RoleFrom(const JsonView& view, const std::string& name) {
  if (!view.Has("role")) return roles::ConventionalRole<Role>(name);
  const auto role = roles::FindRole<Role>(view.Text("role"));
  if (!role) view.Complain("role must be other, or one of " + roles::ListNames<Role>());
  return role.value_or(Role::kOther);
}

/// States a role that the name does not say.
template <class Thing>
void StateRole(const Thing& thing, nlohmann::ordered_json& json) {
  using Role = decltype(thing.role);
  if (thing.role != roles::ConventionalRole<Role>(thing.name)) json["role"] = roles::NameOf(thing.role);
}

/// One top-level field a line, long lists of numbers on one line.
std::string FormatPatient(const Patient& patient) {
  using Json = nlohmann::ordered_json;
  std::string text = "{\n\"format\": \"" + std::string(kFormat) +
                     "\",\n\"version\": " + std::to_string(kVersion) +
                     ",\n\"name\": " + core::FormatJson(Json(patient.name)) +
                     ",\n\"provenance\": " + core::FormatJson(Json(patient.provenance)) +
                     ",\n\"frame\": \"LPS\",\n\"unit\": \"mm\",\n";
  const auto append_list = [&text](const char* key, const std::vector<Json>& items, bool is_last) {
    text += "\"" + std::string(key) + "\": [";
    for (std::size_t i = 0; i < items.size(); ++i)
      text += (i == 0 ? "\n  " : ",\n  ") + core::FormatJson(items[i]);
    text += is_last ? "]\n" : "],\n";
  };
  std::vector<Json> organs, attachments, tubes, landmarks;
  for (const Organ& organ : patient.organs) {
    Json regions = Json::array();
    for (const Region& region : organ.regions) {
      regions.push_back({{"name", region.name}, {"vertices", region.vertices}});
      StateRole(region, regions.back());
    }
    organs.push_back({{"name", organ.name}, {"mesh", organ.name + ".ply"}, {"regions", regions}});
    StateRole(organ, organs.back());
  }
  // runs of attachments between the same organs share one entry
  for (std::size_t i = 0; i < patient.attachments.size();) {
    const Attachment& first = patient.attachments[i];
    Json pairs = Json::array();
    for (; i < patient.attachments.size(); ++i) {
      const Attachment& a = patient.attachments[i];
      if (a.name != first.name || a.organ_a != first.organ_a || a.organ_b != first.organ_b) break;
      pairs.push_back(Json::array({a.vertex_a, a.vertex_b}));
    }
    attachments.push_back(
        {{"name", first.name}, {"organ_a", first.organ_a}, {"organ_b", first.organ_b}, {"pairs", pairs}});
  }
  for (const Tube& tube : patient.tubes) {
    Json points = Json::array(), radii = Json::array();
    for (std::size_t i = 0; i < tube.line.points.size(); ++i) {
      points.push_back(PointJson(tube.line.points[i]));
      radii.push_back(kMmPerMetre * tube.line.radii[i]);
    }
    tubes.push_back({{"name", tube.name},
                     {"kind", KindName(tube.kind)},
                     {"from", tube.from},
                     {"to", tube.to},
                     {"seen", tube.is_seen},
                     {"points", points},
                     {"radii", radii}});
    StateRole(tube, tubes.back());
  }
  for (const Landmark& landmark : patient.landmarks) {
    landmarks.push_back({{"name", landmark.name}, {"position", PointJson(landmark.position)}});
    StateRole(landmark, landmarks.back());
  }
  append_list("organs", organs, false);
  append_list("attachments", attachments, false);
  append_list("tubes", tubes, false);
  std::vector<Json> parameters;
  for (const Parameter& parameter : patient.parameters) {
    Json json = {{"name", parameter.name}};
    if (const double* number = std::get_if<double>(&parameter.value)) {
      json["value"] = *number;
    } else {
      json["text"] = std::get<std::string>(parameter.value);
    }
    json["unit"] = parameter.unit;
    json["source"] = parameter.source;
    parameters.push_back(std::move(json));
  }
  const auto surroundings = MakeSurroundingsJson(patient);
  append_list("landmarks", landmarks, parameters.empty() && surroundings.empty());
  // a patient without these stays readable for programs that do not know them
  if (!parameters.empty()) append_list("parameters", parameters, surroundings.empty());
  for (std::size_t i = 0; i < surroundings.size(); ++i) {
    const auto& [key, value] = surroundings[i];
    const bool is_last = i + 1 == surroundings.size();
    if (value.is_array()) {
      append_list(key.c_str(), {value.begin(), value.end()}, is_last);
    } else {
      text += "\"" + key + "\": " + core::FormatJson(value) + (is_last ? "\n" : ",\n");
    }
  }
  return text + "}\n";
}

}  // namespace

const Region* Organ::RegionOf(RegionRole wanted) const {
  const auto found = std::find_if(regions.begin(), regions.end(),
                                  [&](const Region& region) { return region.role == wanted; });
  return found == regions.end() ? nullptr : &*found;
}

int Patient::OrganOf(OrganRole role) const {
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (organs[i].role == role) return static_cast<int>(i);
  }
  return -1;
}

int Patient::TubeOf(TubeRole role) const {
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    if (tubes[i].role == role) return static_cast<int>(i);
  }
  return -1;
}

OrganRole Patient::RoleOfOrgan(int organ) const {
  const auto index = static_cast<std::size_t>(organ);
  return organ >= 0 && index < organs.size() ? organs[index].role : OrganRole::kOther;
}

const Landmark* Patient::LandmarkOf(LandmarkRole role) const {
  for (const Landmark& landmark : landmarks) {
    if (landmark.role == role) return &landmark;
  }
  return nullptr;
}

int Patient::FindOrgan(std::string_view organ_name) const {
  for (std::size_t i = 0; i < organs.size(); ++i) {
    if (organs[i].name == organ_name) return static_cast<int>(i);
  }
  return -1;
}

int Patient::FindTube(std::string_view tube_name) const {
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    if (tubes[i].name == tube_name) return static_cast<int>(i);
  }
  return -1;
}

int Patient::FindPart(std::string_view part_name) const {
  const int organ = FindOrgan(part_name), tube = FindTube(part_name);
  if (organ >= 0) return organ;
  return tube < 0 ? -1 : static_cast<int>(organs.size()) + tube;
}

const Landmark* Patient::FindLandmark(std::string_view landmark_name) const {
  for (const Landmark& landmark : landmarks) {
    if (landmark.name == landmark_name) return &landmark;
  }
  const LandmarkRole role = roles::ConventionalRole<LandmarkRole>(landmark_name);
  return role == LandmarkRole::kOther ? nullptr : LandmarkOf(role);
}

const Parameter* Patient::FindParameter(std::string_view parameter_name) const {
  for (const Parameter& parameter : parameters) {
    if (parameter.name == parameter_name) return &parameter;
  }
  return nullptr;
}

const Neighbour* Patient::NeighbourOf(NeighbourRole role) const {
  for (const Neighbour& neighbour : neighbours) {
    if (neighbour.role == role) return &neighbour;
  }
  return nullptr;
}

const Port* Patient::PortOf(PortUse use) const {
  for (const Port& port : ports) {
    if (port.use == use) return &port;
  }
  return nullptr;
}

core::Result<UncheckedPatient> ReadPatientUnchecked(const fs::path& folder) {
  const fs::path path = folder / "patient.json";
  auto document = core::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "name", "provenance", "frame", "unit", "organs", "attachments",
                  "tubes", "landmarks", "parameters", "neighbours", "ports", "table", "labels"});
  if (root.Text("format") != kFormat) root.Complain(std::string("format must be \"") + kFormat + "\"");
  root.Integer("version", {kVersion, kVersion});
  if (root.Text("frame") != "LPS" || root.Text("unit") != "mm")
    root.Complain("frame must be \"LPS\" and unit \"mm\"");
  Patient patient;
  patient.name = root.Text("name");
  patient.provenance = root.Text("provenance");
  for (const JsonView& view : root.Array("organs")) {
    view.AllowOnly({"name", "role", "mesh", "regions"});
    Organ organ{view.Text("name"), {}, {}};
    organ.role = RoleFrom<OrganRole>(view, organ.name);
    // the mesh lies beside patient.json under the organ's own name: no path can lead out of the folder
    if (!IsPlainName(organ.name)) view.Complain("name must consist of a-z, 0-9 and _");
    if (view.Text("mesh") != organ.name + ".ply") view.Complain("mesh must be the organ's name and .ply");
    for (const JsonView& region_view : view.Array("regions")) {
      region_view.AllowOnly({"name", "role", "vertices"});
      Region region{region_view.Text("name"), {}};
      region.role = RoleFrom<RegionRole>(region_view, region.name);
      for (const JsonView& vertex : region_view.Array("vertices"))
        region.vertices.push_back(IndexFrom(vertex));
      organ.regions.push_back(std::move(region));
    }
    patient.organs.push_back(std::move(organ));
  }
  for (const JsonView& view : root.Array("attachments")) {
    view.AllowOnly({"name", "organ_a", "organ_b", "pairs"});
    Attachment attachment;
    attachment.name = view.Text("name");
    attachment.organ_a = static_cast<std::uint32_t>(view.Integer("organ_a", kOrganIndex));
    attachment.organ_b = static_cast<std::uint32_t>(view.Integer("organ_b", kOrganIndex));
    for (const JsonView& pair : view.Array("pairs")) {
      const auto elements = pair.Elements();
      if (elements.size() != 2) {
        pair.Complain("must be a list of two vertices");
        continue;
      }
      attachment.vertex_a = IndexFrom(elements[0]);
      attachment.vertex_b = IndexFrom(elements[1]);
      patient.attachments.push_back(attachment);
    }
  }
  for (const JsonView& view : root.Array("tubes")) {
    view.AllowOnly({"name", "role", "kind", "from", "to", "seen", "points", "radii"});
    Tube tube{view.Text("name")};
    tube.role = RoleFrom<TubeRole>(view, tube.name);
    const std::string kind = view.Text("kind");
    const auto known = FindKind(kind);
    if (!known) view.Complain("kind must be \"duct\" or \"artery\"");
    tube.kind = known.value_or(TubeKind::kDuct);
    const bool is_duct = tube.kind == TubeKind::kDuct;
    if (view.Has("role") && tube.role != TubeRole::kOther && roles::IsDuct(tube.role) != is_duct)
      view.Complain("role does not fit the kind: a " + roles::SpokenName(tube.role) + " is no " + kind);
    tube.from = view.TextOr("from", "");
    tube.to = view.TextOr("to", "");
    tube.is_seen = view.BooleanOr("seen", true);
    for (const JsonView& point : view.Array("points")) {
      const auto p = point.AsNumbers(3, kCoordinateMm);
      tube.line.points.push_back(FromLps({p[0], p[1], p[2]}));
    }
    for (const JsonView& radius : view.Array("radii"))
      tube.line.radii.push_back(radius.AsNumber(kRadiusMm) / kMmPerMetre);
    patient.tubes.push_back(std::move(tube));
  }
  for (const JsonView& view : root.Array("landmarks")) {
    view.AllowOnly({"name", "role", "position"});
    Landmark landmark{view.Text("name"), PointFrom(view, "position")};
    landmark.role = RoleFrom<LandmarkRole>(view, landmark.name);
    patient.landmarks.push_back(std::move(landmark));
  }
  if (root.Has("parameters")) {
    for (const JsonView& view : root.Array("parameters")) {
      view.AllowOnly({"name", "value", "text", "unit", "source"});
      Parameter parameter{view.Text("name"), 0.0, view.Text("unit"), view.Text("source")};
      if (view.Has("text")) {
        parameter.value = view.Text("text");
      } else {
        parameter.value = view.Number("value", kParameter);
      }
      patient.parameters.push_back(std::move(parameter));
    }
  }
  ReadSurroundings(root, patient);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  UncheckedPatient unchecked{std::move(patient), {}};
  const auto read_mesh = [&](auto& thing) {
    auto mesh = geometry::ReadPly(folder / (thing.name + ".ply"));
    unchecked.mesh_errors.push_back(mesh.ok() ? Error{} : mesh.error());
    if (mesh.ok()) thing.mesh = Converted(std::move(*mesh), FromLps);
  };
  for (Organ& organ : unchecked.patient.organs) read_mesh(organ);
  for (Neighbour& neighbour : unchecked.patient.neighbours) read_mesh(neighbour);
  return unchecked;
}

core::Result<Patient> ReadPatient(const fs::path& folder) {
  auto read = ReadPatientUnchecked(folder);
  if (!read.ok()) return read.error();
  for (const Error& error : read->mesh_errors) {
    if (error.code != ErrorCode::kNone) return error;
  }
  if (const auto status = CheckPatient(read->patient); !status.ok()) {
    return Error{status.error().code, (folder / "patient.json").string() + ": " + status.error().message};
  }
  return std::move(read->patient);
}

core::Status WritePatient(const fs::path& folder, const Patient& patient) {
  if (const auto status = CheckPatient(patient); !status.ok()) return status.error();
  fs::path target = folder;
  if (!target.has_filename()) target = target.parent_path();
  const core::PartialPath part(target);
  const fs::path& partial = part.Path();
  const fs::path former = target.string() + ".former" + std::to_string(::getpid());
  const auto fail = [&](const std::string& why) {
    return Error{ErrorCode::kFileUnwritable,
                 target.string() + ": " + why + "; check the folder, its rights and the space left"};
  };
  std::error_code failure;
  if (fs::exists(target, failure)) {
    // only a patient is replaced, never somebody's other folder
    const bool is_patient = fs::is_directory(target, failure) &&
                            (fs::exists(target / "patient.json", failure) || fs::is_empty(target, failure));
    if (!is_patient) return fail("it exists and is no patient folder");
  }
  fs::create_directories(partial, failure);
  if (failure) return fail(failure.message());
  const auto write_mesh = [&](const auto& thing) {
    return geometry::WritePly(partial / (thing.name + ".ply"), Converted(thing.mesh, ToLps),
                              "LPS millimetres, " + thing.name);
  };
  for (const Organ& organ : patient.organs) {
    if (const auto status = write_mesh(organ); !status.ok()) return fail(status.error().message);
  }
  for (const Neighbour& neighbour : patient.neighbours) {
    if (const auto status = write_mesh(neighbour); !status.ok()) return fail(status.error().message);
  }
  if (const auto status = core::WriteFile(partial / "patient.json", FormatPatient(patient)); !status.ok()) {
    return fail(status.error().message);
  }
  const bool replaces = fs::exists(target, failure);
  if (replaces) {
    fs::rename(target, former, failure);
    if (failure) return fail(failure.message());
  }
  fs::rename(partial, target, failure);
  if (failure) {
    const std::string why = failure.message();
    if (replaces) fs::rename(former, target, failure);
    return fail(why);
  }
  fs::remove_all(former, failure);
  return {};
}

namespace {

/// Refuses an organ of a size or at a place that none has: mostly a file in metres or micrometres instead of millimetres.
core::Status CheckSize(const Organ& organ) {
  if (organ.mesh.positions.empty()) return {};  // has no surface, which is said elsewhere
  Vec3 low = organ.mesh.positions.front(), high = low;
  for (const Vec3& p : organ.mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  const double size = math::Norm(high - low), reach = std::max(math::Norm(low), math::Norm(high));
  if (size >= kSmallestOrgan && size <= kLargestOrgan && reach * kMmPerMetre <= 2 * kCoordinateMm.max)
    return {};
  char text[240];
  std::snprintf(
      text, sizeof text,
      "%.60s is %.3g mm large and lies up to %.3g mm from the origin; an organ is 2 to 1000 mm; check the "
      "unit of its mesh, which is millimetres",
      organ.name.c_str(), kMmPerMetre * size, kMmPerMetre * reach);
  return Error{ErrorCode::kPatientInvalid, text};
}

/// Refuses a role that two of the things have.
template <class Thing>
core::Status CheckRoles(const std::vector<Thing>& things, const std::string& what) {
  const Thing* second = FindSecondOfRole(things);
  if (second == nullptr) return {};
  return Invalid("two " + what + " have the role " + roles::SpokenName(second->role) + ", '" + second->name +
                 "' is one of them");
}

}  // namespace

core::Status CheckPatient(const Patient& patient) {
  if (patient.organs.empty()) return Invalid("it has no organ");
  if (core::Status good = CheckRoles(patient.organs, "organs"); !good) return good;
  if (core::Status good = CheckRoles(patient.landmarks, "landmarks"); !good) return good;
  std::set<std::string> names;
  for (const Organ& organ : patient.organs) {
    if (!IsPlainName(organ.name))
      return Invalid("organ name '" + organ.name + "' must consist of a-z, 0-9 and _");
    if (!names.insert(organ.name).second) return Invalid("the name '" + organ.name + "' is used twice");
    if (const auto status = geometry::CheckMesh(organ.mesh); !status.ok())
      return Invalid(organ.name + ": " + status.error().message);
    if (core::Status good = CheckSize(organ); !good) return good;
    const auto report = geometry::InspectMesh(organ.mesh);
    if (!report.closed || !report.manifold) {
      return Error{ErrorCode::kMeshNotClosed, "the mesh of " + organ.name + " is not closed and manifold (" +
                                                  std::to_string(report.boundary_edges) + " open edges, " +
                                                  std::to_string(report.odd_edges) + " odd edges, " +
                                                  std::to_string(report.odd_vertices) + " odd vertices, " +
                                                  std::to_string(report.degenerate) +
                                                  " flat triangles); repair it"};
    }
    if (!report.outward) return Invalid("the triangles of " + organ.name + " face inwards");
    if (core::Status good = CheckRoles(organ.regions, "regions of " + organ.name); !good) return good;
    std::set<std::string> regions;
    for (const Region& region : organ.regions) {
      if (!regions.insert(region.name).second)
        return Invalid("region '" + region.name + "' of " + organ.name + " is there twice");
      for (std::size_t i = 0; i < region.vertices.size(); ++i) {
        if (region.vertices[i] >= organ.mesh.positions.size()) {
          return Invalid("region '" + region.name + "' of " + organ.name +
                         " names a vertex that is not there");
        }
        if (i > 0 && region.vertices[i] <= region.vertices[i - 1]) {
          return Invalid("the vertices of region '" + region.name + "' of " + organ.name + " do not ascend");
        }
      }
    }
  }
  if (core::Status good = CheckSurroundings(patient, names); !good) return good;
  for (const Attachment& a : patient.attachments) {
    const bool in_range = a.organ_a < patient.organs.size() && a.organ_b < patient.organs.size() &&
                          a.vertex_a < patient.organs[a.organ_a].mesh.positions.size() &&
                          a.vertex_b < patient.organs[a.organ_b].mesh.positions.size();
    if (!in_range)
      return Invalid("an attachment '" + a.name + "' names an organ or vertex that is not there");
  }
  for (const Tube& tube : patient.tubes) {
    if (!names.insert(tube.name).second) return Invalid("the name '" + tube.name + "' is used twice");
  }
  for (const Tube& tube : patient.tubes) {
    if (tube.line.points.size() < 2 || tube.line.points.size() != tube.line.radii.size()) {
      return Invalid("tube '" + tube.name + "' needs two points or more, and a radius for each");
    }
    for (std::size_t i = 0; i < tube.line.points.size(); ++i) {
      const double radius = tube.line.radii[i];
      if (!math::IsFinite(tube.line.points[i]) || !(radius > 0.0) || !std::isfinite(radius)) {
        return Invalid("tube '" + tube.name +
                       "' has a point that is not finite or a radius that is not positive");
      }
    }
    for (const std::string& end : {tube.from, tube.to}) {
      if (!end.empty() && !names.contains(end)) {
        return Invalid("tube '" + tube.name + "' leads to '" + end + "', which is neither organ nor tube");
      }
    }
  }
  std::set<std::string> landmarks;
  for (const Landmark& landmark : patient.landmarks) {
    if (!landmarks.insert(landmark.name).second)
      return Invalid("landmark '" + landmark.name + "' is there twice");
    if (!math::IsFinite(landmark.position)) return Invalid("landmark '" + landmark.name + "' is not finite");
  }
  std::set<std::string> parameters;
  for (const Parameter& parameter : patient.parameters) {
    if (parameter.name.empty() || !parameters.insert(parameter.name).second)
      return Invalid("parameter '" + parameter.name + "' has no name or is there twice");
    const double* number = std::get_if<double>(&parameter.value);
    if (number != nullptr && !std::isfinite(*number))
      return Invalid("parameter '" + parameter.name + "' is not finite");
  }
  return {};
}

}  // namespace trocar::anatomy
