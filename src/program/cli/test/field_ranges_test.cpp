// SPDX-License-Identifier: Apache-2.0
// Every number that a file may hold has a range, and the schema and the reader give the same one.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "run_trocar.h"
#include "trocar/device/device_store.h"
#include "trocar/files/operation_parameters_file.h"
#include "trocar/files/patient_file.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar/scene/scene.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::cli {
namespace {

namespace fs = std::filesystem;
const fs::path kSource = TROCAR_SOURCE_DIR;

Json Load(const fs::path& path) {
  const auto text = host::ReadFile(path);
  EXPECT_TRUE(text.ok()) << text.error().Text();
  return text.ok() ? Json::parse(*text) : Json();
}

/// A schema with its references to itself followed.
class Schema {
 public:
  explicit Schema(const std::string& name)
      : root_(Load(kSource / "schemas" / (name + ".schema.json"))), name_(name) {}

  const Json& Root() const { return root_; }
  const std::string& Name() const { return name_; }

  Json Resolve(Json node) const {
    while (node.contains("$ref")) {
      const std::string ref = node["$ref"];
      if (!ref.starts_with("#/")) break;
      Json target = root_.at(nlohmann::ordered_json::json_pointer(ref.substr(1)));
      node.erase("$ref");
      target.update(node);
      node = std::move(target);
    }
    return node;
  }

  /// Of several shapes, the one that a value has: all that it needs, nothing that it does not know.
  Json Choose(const Json& node, const Json& value) const {
    const Json resolved = Resolve(node);
    const char* const key = resolved.contains("oneOf") ? "oneOf" : "anyOf";
    if (!resolved.contains(key) || resolved.contains("properties")) return resolved;
    for (const Json& option : resolved[key]) {
      const Json one = Resolve(option);
      if (IsLike(one, value)) {
        Json chosen = resolved;
        chosen.erase(key);
        chosen.update(one);
        return chosen;
      }
    }
    return resolved;
  }

  static bool IsNumber(const Json& node) {
    return node.contains("type") && (node["type"] == "number" || node["type"] == "integer");
  }

 private:
  static bool IsLike(const Json& node, const Json& value) {
    if (!value.is_object()) return value.is_number() == IsNumber(node);
    if (!node.contains("properties")) return false;
    for (const Json& needed : node.value("required", Json::array())) {
      if (!value.contains(needed.get<std::string>())) return false;
    }
    for (const auto& [name, part] : value.items()) {
      const auto& known = node["properties"];
      if (!known.contains(name)) return false;
      if (known[name].contains("const") && known[name]["const"] != part) return false;
    }
    return true;
  }

  Json root_;
  std::string name_;
};

struct Range {
  double min = 0, max = 0;
};
std::optional<Range> RangeOf(const Json& node) {
  if (!node.contains("minimum") || !node.contains("maximum")) return std::nullopt;
  return Range{node["minimum"], node["maximum"]};
}

/// Calls for each number of a document with its place in document and schema.
using Visit = std::function<void(const Json::json_pointer&, const std::string& place, const Json& node)>;
void Walk(const Schema& schema, const Json& node, const Json& value, const Json::json_pointer& at,
          const std::string& place, const Visit& visit) {
  const Json chosen = schema.Choose(node, value);
  if (value.is_number()) return visit(at, place, chosen);
  if (value.is_array() && chosen.contains("items") && chosen["items"].is_object()) {
    for (std::size_t i = 0; i < value.size(); ++i)
      Walk(schema, chosen["items"], value[i], at / i, place + "[]", visit);
  }
  if (!value.is_object()) return;
  for (const auto& [name, part] : value.items()) {
    if (chosen.contains("properties") && chosen["properties"].contains(name)) {
      Walk(schema, chosen["properties"][name], part, at / name, place + "." + name, visit);
    } else if (chosen.contains("additionalProperties") && chosen["additionalProperties"].is_object()) {
      Walk(schema, chosen["additionalProperties"], part, at / name, place + ".*", visit);
    }
  }
}

/// Every number of a schema by its place, reached or not.
void List(const Schema& schema, const Json& node, const std::string& place, int depth,
          std::set<std::string>& places) {
  const Json resolved = schema.Resolve(node);
  if (Schema::IsNumber(resolved)) places.insert(place);
  if (depth > 16) return;
  for (const char* several : {"oneOf", "anyOf"}) {
    if (!resolved.contains(several)) continue;
    for (const Json& option : resolved[several]) List(schema, option, place, depth + 1, places);
  }
  if (resolved.contains("properties")) {
    for (const auto& [name, part] : resolved["properties"].items())
      List(schema, part, place + "." + name, depth + 1, places);
  }
  if (resolved.contains("items") && resolved["items"].is_object())
    List(schema, resolved["items"], place + "[]", depth + 1, places);
  if (resolved.contains("additionalProperties") && resolved["additionalProperties"].is_object())
    List(schema, resolved["additionalProperties"], place + ".*", depth + 1, places);
}

/// Goals and errors have the same conditions, and the ways of both hands the same stops, by one definition in the schema and
/// one reader: what is tried in either counts.
std::string SharedPlace(const std::string& place) {
  for (const std::string condition : {".rules.goals[].steps[]", ".rules.errors[].when"}) {
    if (place.starts_with(condition)) return ".condition" + place.substr(condition.size());
  }
  for (const std::string way : {".ideal_path.left[]", ".ideal_path.right[]"}) {
    for (const std::string& stop : {way + ".stops[]", way}) {
      if (place.starts_with(stop)) return ".stop" + place.substr(stop.size());
    }
  }
  return place;
}

/// What a reader says of a document; no error where it is good.
using Reader = std::function<std::optional<base::Error>(const Json&)>;

template <typename Result>
std::optional<base::Error> ErrorOf(const Result& result) {
  if (result.ok()) return std::nullopt;
  return result.error();
}

/// Puts a value beyond its range into each number of the document, once per place in the schema.
void CompareRanges(const Schema& schema, const Json& document, const Reader& read,
                   std::set<std::string>& seen) {
  const auto good = read(document);
  ASSERT_FALSE(good.has_value()) << "the document is good before it is broken: " << good->Text();
  Walk(schema, schema.Root(), document, Json::json_pointer(), "",
       [&](const Json::json_pointer& at, const std::string& place, const Json& node) {
         if (node.contains("const") || !seen.insert(SharedPlace(place)).second) return;
         const auto range = RangeOf(node);
         ASSERT_TRUE(range) << schema.Name() << place << " has no range in the schema";
         Json broken = document;
         const double beyond = range->max + std::max(1.0, 0.01 * std::fabs(range->max));
         broken[at] = document[at].is_number_integer() && beyond < 9e15
                          ? Json(static_cast<std::int64_t>(beyond))
                          : Json(beyond);
         const auto refused = read(broken);
         ASSERT_TRUE(refused) << schema.Name() << place << ": " << beyond << " was accepted";
         const std::string wanted = "must lie between " + nlohmann::json(range->min).dump() + " and " +
                                    nlohmann::json(range->max).dump();
         EXPECT_NE(refused->message.find(wanted), std::string::npos)
             << schema.Name() << place << ": the schema says " << wanted
             << ", the reader: " << refused->Text();
       });
}

class FieldRanges : public testing::Test {
 protected:
  Reader SceneReader() {
    return [this](const Json& json) { return ErrorOf(files::ReadScene(Written("scene.json", json))); };
  }
  fs::path Written(const std::string& name, const Json& json) {
    const fs::path path = folder_.Path() / name;
    EXPECT_TRUE(host::WriteFile(path, json.dump()).ok());
    return path;
  }
  /// Compares, then asks that every number of the schema was reached.
  void ExpectAgreement(const std::string& name, const std::vector<Json>& documents, const Reader& read) {
    const Schema schema(name);
    std::set<std::string> seen, places;
    for (const Json& document : documents) CompareRanges(schema, document, read, seen);
    List(schema, schema.Root(), "", 0, places);
    for (const std::string& place : places)
      EXPECT_TRUE(seen.contains(SharedPlace(place))) << name << place << " is not tried";
  }
  test::TemporaryFolder folder_;
};

/// Every figure of a material, written out.
Json Figures() {
  return {{"organ", "liver"},
          {"young_modulus_pa", 20000},
          {"wall_thickness_mm", 0.1},
          {"foundation_modulus_pa", 2000},
          {"foundation_depth_mm", 40},
          {"density_kg_m3", 1060},
          {"failure_strain", 1.5},
          {"failure_force_n", 5},
          {"internal_pressure_pa", 100},
          {"stiffening", 10},
          {"stiffening_strain", 0.2},
          {"wall_failure_strain", 0.4},
          {"wall_damage_per_s", 0.5},
          {"wall_damage_exponent", 4},
          {"source", "a test"}};
}

Json Objects() {
  const Json at = {0, 0, -150}, turn = {0, 0, 90};
  const Json shapes = {
      {{"kind", "box"}, {"at_mm", at}, {"turn_deg", turn}, {"size_mm", {10, 10, 10}}},
      {{"kind", "cylinder"}, {"at_mm", at}, {"turn_deg", turn}, {"radius_mm", 2}, {"height_mm", 4}},
      {{"kind", "capsule"}, {"at_mm", at}, {"turn_deg", turn}, {"radius_mm", 2}, {"length_mm", 4}},
      {{"kind", "sphere"}, {"at_mm", at}, {"radius_mm", 2}},
      {{"kind", "ring"}, {"at_mm", at}, {"turn_deg", turn}, {"radius_mm", 8}, {"thickness_mm", 2}},
      {{"kind", "path"}, {"radius_mm", 2}, {"points_mm", {{0, 0, -100}, {0, 10, -100}}}}};
  return {{{"name", "board"},
           {"shapes", shapes},
           {"at_mm", {0, 0, 0}},
           {"turn_deg", turn},
           {"mass_g", 1},
           {"friction", 0.8},
           {"grips", {{{"at_mm", {0, 0, 0}}, {"across", {1, 0, 0}}, {"open_deg", 20}}}}}};
}

Json Tubes() {
  return {
      {"at_mm", {0, 0, -120}},
      {"tubes",
       {{{"name", "duct"},
         {"from_mm", {-30, 0, 0}},
         {"to_mm", {30, 0, 0}},
         {"radius_mm", 2},
         {"sag_mm", 1},
         {"spacing_mm", 2.5}}}},
      {"bands", {{{"name", "band"}, {"from_mm", {-30, 20, 0}}, {"to_mm", {30, 20, 0}}, {"radius_mm", 0.6}}}}};
}

Json Sheets() {
  return {{"sheets",
           {{{"name", "gauze"},
             {"centre_mm", {0, 0, -120}},
             {"half_mm", {40, 40}},
             {"spacing_mm", 3},
             {"circle_mm", 20},
             {"prestrain", 0.04}}}}};
}

/// The delivered operation with every number that a scene with a patient may hold.
Json OperationScene() {
  Json scene = Load(kSource / "scenes/cholecystectomy.json");
  scene["patient"] = (kSource / "assets/patients/visible-human-male/patient").string();
  for (Json& material : scene["materials"])
    material["file"] = (kSource / "scenes" / material["file"].get<std::string>()).string();
  scene["materials"][0] = Figures();
  for (const char* hand : {"left", "right"}) scene["instruments"][hand]["spin_deg"] = 10;
  scene["laparoscope"]["post_deg"] = 0;
  scene["laparoscope"]["target"]["offset_mm"] = {0, 0, 0};
  return scene;
}

/// Without a patient: places instead of landmarks, things to transport, and a model.
Json BoardScene(const Json& model) {
  Json scene = {{"format", "trocar-scene"}, {"version", 1}, {"name", "Board"}, {"objects", Objects()}};
  const auto hand = [](double x) {
    return Json{{"tool", "grasper"}, {"port_mm", {x, -90, 0}}, {"tip", {{"at_mm", {x, 10, -95}}}}};
  };
  scene["instruments"] = {{"left", hand(-70)}, {"right", hand(70)}};
  scene["laparoscope"] = {
      {"port_mm", {0, -110, -5}}, {"target", {{"at_mm", {0, 30, -125}}}}, {"depth_mm", 100}};
  if (!model.is_null()) scene["model"] = model;
  return scene;
}

TEST_F(FieldRanges, SchemaAndReaderAgreeOnScenes) {
  ExpectAgreement("scene", {OperationScene(), BoardScene(Tubes()), BoardScene(Sheets())}, SceneReader());
}

TEST_F(FieldRanges, SchemaAndReaderAgreeOnOperationParameters) {
  ExpectAgreement("operation", {Load(kSource / files::kOperationParametersFile)}, [this](const Json& json) {
    return ErrorOf(files::ReadOperationParameters(Written("parameters.json", json)));
  });
}

/// A task around a scene, with every rule that has a number.
Json TaskAround(Json scene) {
  for (const char* key : {"format", "version", "name", "seed"}) scene.erase(key);
  Json task = {{"format", "trocar-task"}, {"version", 1}, {"name", "Task"}, {"about", "Of a test"}};
  task["parameters"] = {{"a", {{"value", 1}, {"spread", 0}, {"vary", 0}}},
                        {"b", {{"by_level", {{"normal", 1}}}}}};
  task["scene"] = std::move(scene);
  task["regions"] = {{{"name", "ball"}, {"centre_mm", {0, 0, -100}}, {"radius_mm", 5}, {"facing", {0, 0, 1}}},
                     {{"name", "box"}, {"centre_mm", {0, 0, -100}}, {"half_mm", {5, 5, 5}}}};
  return task;
}

TEST_F(FieldRanges, SchemaAndReaderAgreeOnTasks) {
  const auto goal = [](const Json& step) {
    return Json{{{"name", "goal"}, {"points", 1}, {"stage", 0}, {"steps", step}}};
  };
  Json held = {{"kind", "lifted"}, {"object", "board"}, {"hand", "any"}, {"height_mm", 4}, {"seconds", 1}};
  Json seen = {{"kind", "camera_sees"}, {"region", "ball"}, {"within_deg", 5},
               {"facing_deg", 30},      {"near_mm", 10},    {"far_mm", 100}};
  Json task = TaskAround(BoardScene(Tubes()));
  task["level_scores"] = {{"normal", 85}};
  task["ideal_path"] = {
      {"left", {{{"object", "board"}, {"grip", 0}, {"offset_mm", {0, 0, 1}}}, {{"at_mm", {0, 0, -100}}}}}};
  task["rules"] = {{"time_limit_s", 100},
                   {"points_per_second_left", 1},
                   {"reference_points", 100},
                   {"goals", goal({held, seen})}};
  const auto error = [](const Json& when) {
    return Json{{"name", "error"}, {"about", "It happened"}, {"penalty", 1}, {"when", when}};
  };
  task["rules"]["errors"] = {error({{"kind", "dropped"}, {"object", "board"}, {"fall_mm", 5}}),
                             error({{"kind", "force_above"}, {"newtons", 2}}),
                             error({{"kind", "unclipped_cut"}, {"clips", 2}})};
  Json sheets = TaskAround(BoardScene(Sheets()));
  sheets["rules"] = {{"goals", goal({{{"kind", "cut_free"}, {"sheet", "gauze"}}})},
                     {"errors",
                      {error({{"kind", "cut_off_line"}, {"sheet", "gauze"}, {"distance_mm", 2}}),
                       error({{"kind", "cut_area_off"}, {"sheet", "gauze"}, {"area_mm2", 20}})}}};
  Json operation = TaskAround(OperationScene());
  operation["scene"]["operation"].erase("gallstones");
  operation["regions"].push_back(
      {{"name", "at"}, {"at", "fundus"}, {"offset_mm", {0, 0, 1}}, {"radius_mm", 5}});
  operation["rules"] = {{"goals", goal({{{"kind", "tip_in_region"}, {"region", "ball"}}})}};
  ExpectAgreement("task", {task, sheets, operation}, SceneReader());
}

TEST_F(FieldRanges, SchemaAndReaderAgreeOnScriptsAndMaterials) {
  Json scene = OperationScene();
  scene["script"] = "script.json";
  const auto hand = [] {
    return Json{{"at", "fundus"}, {"offset_mm", {0, 0, 10}}, {"spin_deg", 0}, {"jaw_deg", 10}};
  };
  const Json script = {{"format", "trocar-script"},
                       {"version", 1},
                       {"tremor_mm", 0.1},
                       {"keys", {{{"time_s", 0}, {"left", hand()}, {"right", hand()}}}}};
  ExpectAgreement("script", {script}, [&](const Json& json) {
    Written("script.json", json);
    return ErrorOf(files::ReadScene(Written("scene.json", scene)));
  });
  scene = OperationScene();
  scene["materials"][0] = {{"organ", "liver"}, {"file", "material.json"}};
  Json material = Figures();
  material.erase("organ"), material.erase("source");
  Json sources;
  for (const auto& [name, figure] : material.items()) sources[name] = "a test";
  material.update(Json{{"format", "trocar-material"}, {"version", 1}, {"sources", sources}});
  ExpectAgreement("material", {material}, [&](const Json& json) {
    Written("material.json", json);
    return ErrorOf(files::ReadScene(Written("scene.json", scene)));
  });
}

TEST_F(FieldRanges, SchemaAndReaderAgreeOnPatientsAndDevices) {
  const fs::path patient = kSource / "assets/patients/visible-human-male/patient";
  fs::copy(patient, folder_.Path() / "patient", fs::copy_options::recursive);
  Json json = Load(patient / "patient.json");
  json["parameters"] = {{{"name", "volume"}, {"value", 1}, {"unit", "ml"}, {"source", "a test"}}};
  json["ports"] = {{{"for", "laparoscope"}, {"position", {0.0, 0.0, 0.1}}, {"reason", "a test"}}};
  json["table"] = {{"head_up_deg", 12.0}, {"right_up_deg", 8.0}, {"reason", "a test"}};
  json["labels"] = {{{"label", 1}, {"taken_as", "liver"}, {"reason", "a test"}}};
  ExpectAgreement("patient", {json}, [&](const Json& one) {
    Written("patient/patient.json", one);
    return ErrorOf(files::ReadPatient(folder_.Path() / "patient"));
  });

  device::DeviceStore store;
  store.trackers["liberty"] = device::DefaultTracker();
  ASSERT_TRUE(device::SaveDeviceStore(folder_.Path() / "devices.json", store).ok());
  ExpectAgreement("devices", {Load(folder_.Path() / "devices.json")}, [&](const Json& one) {
    return device::LoadDeviceStore(Written("devices.json", one)).complaint;
  });
}

// the control: a schema that differs in one number is found
TEST_F(FieldRanges, AnotherRangeIsFound) {
  Json scene = BoardScene(Json());
  scene["objects"][0]["friction"] = 4.9;
  EXPECT_FALSE(SceneReader()(scene));
  scene["objects"][0]["friction"] = 5.1;
  const auto refused = SceneReader()(scene);
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->message.find("must lie between 0.0 and 5.0"), std::string::npos) << refused->Text();
  EXPECT_EQ(refused->message.find("must lie between 0.0 and 6.0"), std::string::npos);
}

// found by use: what was accepted before
TEST_F(FieldRanges, RefusesWhatMeansNothing) {
  const auto code = [&](const std::function<void(Json&)>& change) {
    Json scene = OperationScene();
    change(scene);
    const auto refused = SceneReader()(scene);
    return refused ? refused->code : base::ErrorCode::kNone;
  };
  using base::ErrorCode;
  EXPECT_EQ(code([](Json&) {}), ErrorCode::kNone);
  EXPECT_EQ(code([](Json& s) { s["instruments"]["left"]["port_mm"][0] = 1e40; }), ErrorCode::kJsonField);
  EXPECT_EQ(code([](Json& s) { s["settings"]["tolerance"] = 0; }), ErrorCode::kJsonField);
  EXPECT_EQ(code([](Json& s) { s["materials"].push_back(s["materials"][1]); }), ErrorCode::kSceneInvalid);
  EXPECT_EQ(code([](Json& s) { s["instruments"]["left"]["port_mm"] = s["instruments"]["right"]["port_mm"]; }),
            ErrorCode::kSceneInvalid);
  EXPECT_EQ(code([](Json& s) { s["laparoscope"]["port_mm"] = s["operation"]["assistant"]["port_mm"]; }),
            ErrorCode::kSceneInvalid);
  EXPECT_EQ(code([](Json& s) {
              s["laparoscope"]["port_mm"] = s["operation"]["assistant"]["port_mm"];
              s["laparoscope"]["port_mm"][1] = s["laparoscope"]["port_mm"][1].get<double>() + 6;
            }),
            ErrorCode::kNone)
      << "the control: 6 mm apart";
}

// a list of repeats is refused at the second, however long it is; a file is read once, however many organs name it
TEST_F(FieldRanges, ALongListOfMaterialsCostsNoMoreThanItsLength) {
  Json scene = OperationScene();
  const Json file = scene["materials"][1]["file"];
  for (int i = 0; i < 100'000; ++i) scene["materials"].push_back({{"organ", "liver"}, {"file", "none.json"}});
  const auto refused = SceneReader()(scene);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code, base::ErrorCode::kSceneInvalid)
      << "before the file that is not there is asked for";
  const fs::path shared = folder_.Path() / "shared.json";
  fs::copy_file(file.get<std::string>(), shared);
  scene = OperationScene();
  for (int i = 0; i < 100; ++i)
    scene["materials"].push_back({{"organ", "other_" + std::to_string(i)}, {"file", shared.string()}});
  const auto read = files::ReadScene(Written("scene.json", scene));
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->materials.back().organ, "other_99");
  EXPECT_EQ(read->materials.back().source, read->materials[5].source);
}

// a mesh in micrometres, or in metres, is said to be one
TEST_F(FieldRanges, RefusesAPatientAThousandTimesTooLargeOrTooSmall) {
  const auto patient = files::ReadPatient(kSource / "assets/patients/visible-human-male/patient");
  ASSERT_TRUE(patient.ok());
  for (const double scale : {1.0, 1e6, 1e3, 1e-3}) {
    patient::Patient scaled = *patient;
    for (auto& organ : scaled.organs) {
      for (auto& p : organ.mesh.positions) p = scale * p;
    }
    const base::Status status = patient::CheckPatient(scaled);
    if (scale == 1.0) {
      EXPECT_TRUE(status.ok()) << "the control";
      continue;
    }
    ASSERT_FALSE(status.ok()) << scale;
    EXPECT_EQ(status.error().code, base::ErrorCode::kPatientInvalid);
    EXPECT_NE(status.error().message.find("check the unit"), std::string::npos);
  }
}

}  // namespace
}  // namespace trocar::cli
