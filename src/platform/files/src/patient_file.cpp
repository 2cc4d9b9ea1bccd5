// SPDX-License-Identifier: Apache-2.0
#include "trocar/files/patient_file.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "patient_surroundings.h"
#include "trocar/base/to_integer.h"
#include "trocar/files/mesh_file.h"
#include "trocar/files/patient_frame.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/json.h"
#include "trocar/host/json_text.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar/procedures/find_procedure.h"

namespace trocar::files {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;
using host::JsonView;

constexpr const char* kFormat = "trocar-patient";
constexpr int kVersion = 1;

// In which ranges a patient's quantities mean something; schemas/patient.schema.json says the same.
/// Of a coordinate [mm]: the frame's origin lies in the body, or where a scanner's table is.
constexpr host::NumberRange kCoordinateMm{-3000, 3000};
constexpr host::NumberRange kRadiusMm{0.01, 50};  // of a duct or vessel
constexpr host::NumberRange kIndex{0, 4294967294.0};
constexpr host::NumberRange kOrganIndex{0, 1e6};
constexpr host::NumberRange kParameterValue{-1e6, 1e6};
nlohmann::ordered_json PointJson(const math::Vec3& world) {
  const math::Vec3 p = ToLps(world);
  return nlohmann::ordered_json::array({p.x, p.y, p.z});
}

math::Vec3 PointFrom(const JsonView& view, std::string_view key) {
  const auto p = view.Numbers(key, 3, kCoordinateMm);
  return FromLps({p[0], p[1], p[2]});
}

std::uint32_t IndexFrom(const JsonView& view) {
  const double value = view.AsNumber(kIndex);
  if (value != std::floor(value)) view.Complain("must be a whole number");
  return base::TruncateTo<std::uint32_t>(value);
}

/// The role that is stated, or that of the name.
template <class Role>
Role RoleFrom(const JsonView& view, const std::string& name) {
  if (!view.Has("role")) return roles::ConventionalRole<Role>(name);
  const auto role = procedures::FindRole<Role>(view.Text("role"));
  if (!role) view.Complain("role must be other, or one of " + procedures::ListRoles<Role>());
  return role.value_or(Role::kOther);
}

/// States a role that the name does not say.
template <class Thing>
void StateRole(const Thing& thing, nlohmann::ordered_json& json) {
  using Role = decltype(thing.role);
  if (thing.role != roles::ConventionalRole<Role>(thing.name)) json["role"] = procedures::NameOf(thing.role);
}

/// One top-level field a line, long lists of numbers on one line.
std::string FormatPatient(const patient::Patient& patient) {
  using Json = nlohmann::ordered_json;
  std::string text = "{\n\"format\": \"" + std::string(kFormat) +
                     "\",\n\"version\": " + std::to_string(kVersion) +
                     ",\n\"name\": " + host::FormatJson(Json(patient.name)) +
                     ",\n\"provenance\": " + host::FormatJson(Json(patient.provenance)) +
                     ",\n\"frame\": \"LPS\",\n\"unit\": \"mm\",\n";
  const auto append_list = [&text](const char* key, const std::vector<Json>& items, bool is_last) {
    text += "\"" + std::string(key) + "\": [";
    for (std::size_t i = 0; i < items.size(); ++i)
      text += (i == 0 ? "\n  " : ",\n  ") + host::FormatJson(items[i]);
    text += is_last ? "]\n" : "],\n";
  };
  std::vector<Json> organs, attachments, tubes, landmarks;
  for (const patient::Organ& organ : patient.organs) {
    Json regions = Json::array();
    for (const patient::Region& region : organ.regions) {
      regions.push_back({{"name", region.name}, {"vertices", region.vertices}});
      StateRole(region, regions.back());
    }
    organs.push_back({{"name", organ.name}, {"mesh", organ.name + ".ply"}, {"regions", regions}});
    StateRole(organ, organs.back());
  }
  // runs of attachments between the same organs share one entry
  for (std::size_t i = 0; i < patient.attachments.size();) {
    const patient::Attachment& first = patient.attachments[i];
    Json pairs = Json::array();
    for (; i < patient.attachments.size(); ++i) {
      const patient::Attachment& a = patient.attachments[i];
      if (a.name != first.name || a.organ_a != first.organ_a || a.organ_b != first.organ_b) break;
      pairs.push_back(Json::array({a.vertex_a, a.vertex_b}));
    }
    attachments.push_back(
        {{"name", first.name}, {"organ_a", first.organ_a}, {"organ_b", first.organ_b}, {"pairs", pairs}});
  }
  for (const patient::Tube& tube : patient.tubes) {
    Json points = Json::array(), radii = Json::array();
    for (std::size_t i = 0; i < tube.line.points.size(); ++i) {
      points.push_back(PointJson(tube.line.points[i]));
      radii.push_back(kMmPerMetre * tube.line.radii[i]);
    }
    tubes.push_back({{"name", tube.name},
                     {"kind", patient::KindName(tube.kind)},
                     {"from", tube.from},
                     {"to", tube.to},
                     {"seen", tube.is_seen},
                     {"points", points},
                     {"radii", radii}});
    StateRole(tube, tubes.back());
  }
  for (const patient::Landmark& landmark : patient.landmarks) {
    landmarks.push_back({{"name", landmark.name}, {"position", PointJson(landmark.position)}});
    StateRole(landmark, landmarks.back());
  }
  append_list("organs", organs, false);
  append_list("attachments", attachments, false);
  append_list("tubes", tubes, false);
  std::vector<Json> parameters;
  for (const patient::Parameter& parameter : patient.parameters) {
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
      text += "\"" + key + "\": " + host::FormatJson(value) + (is_last ? "\n" : ",\n");
    }
  }
  return text + "}\n";
}

}  // namespace

base::Result<UncheckedPatient> ReadPatientUnchecked(const fs::path& folder) {
  const fs::path path = folder / "patient.json";
  auto document = host::JsonDocument::Read(path);
  if (!document.ok()) return document.error();
  const JsonView root = document->Root();
  root.AllowOnly({"format", "version", "name", "provenance", "frame", "unit", "organs", "attachments",
                  "tubes", "landmarks", "parameters", "neighbours", "ports", "table", "labels"});
  if (root.Text("format") != kFormat) root.Complain(std::string("format must be \"") + kFormat + "\"");
  root.Integer("version", {kVersion, kVersion});
  if (root.Text("frame") != "LPS" || root.Text("unit") != "mm")
    root.Complain("frame must be \"LPS\" and unit \"mm\"");
  patient::Patient patient;
  patient.name = root.Text("name");
  patient.provenance = root.Text("provenance");
  for (const JsonView& view : root.Array("organs")) {
    view.AllowOnly({"name", "role", "mesh", "regions"});
    patient::Organ organ{view.Text("name"), {}, {}};
    organ.role = RoleFrom<roles::OrganRole>(view, organ.name);
    // the mesh lies beside patient.json under the organ's own name: no path can lead out of the folder
    if (!patient::IsPlainName(organ.name)) view.Complain("name must consist of a-z, 0-9 and _");
    if (view.Text("mesh") != organ.name + ".ply") view.Complain("mesh must be the organ's name and .ply");
    for (const JsonView& region_view : view.Array("regions")) {
      region_view.AllowOnly({"name", "role", "vertices"});
      patient::Region region{region_view.Text("name"), {}};
      region.role = RoleFrom<roles::RegionRole>(region_view, region.name);
      for (const JsonView& vertex : region_view.Array("vertices"))
        region.vertices.push_back(IndexFrom(vertex));
      organ.regions.push_back(std::move(region));
    }
    patient.organs.push_back(std::move(organ));
  }
  for (const JsonView& view : root.Array("attachments")) {
    view.AllowOnly({"name", "organ_a", "organ_b", "pairs"});
    patient::Attachment attachment;
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
    patient::Tube tube{view.Text("name")};
    tube.role = RoleFrom<roles::TubeRole>(view, tube.name);
    const std::string kind = view.Text("kind");
    const auto known = patient::FindKind(kind);
    if (!known) view.Complain("kind must be \"duct\" or \"artery\"");
    tube.kind = known.value_or(patient::TubeKind::kDuct);
    const bool is_duct = tube.kind == patient::TubeKind::kDuct;
    if (view.Has("role") && tube.role != roles::TubeRole::kOther && roles::IsDuct(tube.role) != is_duct)
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
    patient::Landmark landmark{view.Text("name"), PointFrom(view, "position")};
    landmark.role = RoleFrom<roles::LandmarkRole>(view, landmark.name);
    patient.landmarks.push_back(std::move(landmark));
  }
  if (root.Has("parameters")) {
    for (const JsonView& view : root.Array("parameters")) {
      view.AllowOnly({"name", "value", "text", "unit", "source"});
      patient::Parameter parameter{view.Text("name"), 0.0, view.Text("unit"), view.Text("source")};
      if (view.Has("text")) {
        parameter.value = view.Text("text");
      } else {
        parameter.value = view.Number("value", kParameterValue);
      }
      patient.parameters.push_back(std::move(parameter));
    }
  }
  ReadSurroundings(root, patient);
  if (const auto status = document->Check(); !status.ok()) return status.error();
  UncheckedPatient unchecked{std::move(patient), {}};
  const auto read_mesh = [&](auto& thing) {
    auto mesh = ReadPly(folder / (thing.name + ".ply"));
    unchecked.mesh_errors.push_back(mesh.ok() ? Error{} : mesh.error());
    if (mesh.ok()) thing.mesh = Converted(std::move(*mesh), FromLps);
  };
  for (patient::Organ& organ : unchecked.patient.organs) read_mesh(organ);
  for (patient::Neighbour& neighbour : unchecked.patient.neighbours) read_mesh(neighbour);
  return unchecked;
}

base::Result<patient::Patient> ReadPatient(const fs::path& folder) {
  auto read = ReadPatientUnchecked(folder);
  if (!read.ok()) return read.error();
  for (const Error& error : read->mesh_errors) {
    if (error.code != ErrorCode::kNone) return error;
  }
  if (const auto status = patient::CheckPatient(read->patient); !status.ok()) {
    return Error{status.error().code, (folder / "patient.json").string() + ": " + status.error().message};
  }
  return std::move(read->patient);
}

base::Status WritePatient(const fs::path& folder, const patient::Patient& patient) {
  if (const auto status = patient::CheckPatient(patient); !status.ok()) return status.error();
  fs::path target = folder;
  if (!target.has_filename()) target = target.parent_path();
  const host::PartialPath part(target);
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
    return WritePly(partial / (thing.name + ".ply"), Converted(thing.mesh, ToLps),
                    "LPS millimetres, " + thing.name);
  };
  for (const patient::Organ& organ : patient.organs) {
    if (const auto status = write_mesh(organ); !status.ok()) return fail(status.error().message);
  }
  for (const patient::Neighbour& neighbour : patient.neighbours) {
    if (const auto status = write_mesh(neighbour); !status.ok()) return fail(status.error().message);
  }
  if (const auto status = host::WriteFile(partial / "patient.json", FormatPatient(patient)); !status.ok()) {
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

}  // namespace trocar::files
