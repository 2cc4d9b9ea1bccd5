// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/patient_lint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <ostream>
#include <set>
#include <string>

#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/primitives.h"
#include "trocar/host/safe_file.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path kBuiltIn = fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient";
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

const patient::Patient& BuiltIn() {
  static const patient::Patient patient = [] {
    auto read = files::ReadPatient(kBuiltIn);
    EXPECT_TRUE(read.ok()) << read.error().Text();
    return *read;
  }();
  return patient;
}

std::set<std::string> Codes(const LintReport& report) {
  std::set<std::string> codes;
  for (const auto& finding : report.findings) codes.insert(finding.code);
  return codes;
}

std::string Listing(const LintReport& report) {
  std::string text;
  for (const auto& f : report.findings) text += f.code + " " + f.where + ": " + f.text + "\n";
  return text;
}

patient::Organ& Liver(patient::Patient& p) {
  return p.organs[p.FindOrgan("liver")];
}
patient::Organ& Gallbladder(patient::Patient& p) {
  return p.organs[p.FindOrgan("gallbladder")];
}
patient::Tube& TubeOf(patient::Patient& p, std::string_view name) {
  return *std::find_if(p.tubes.begin(), p.tubes.end(),
                       [&](const patient::Tube& t) { return t.name == name; });
}
patient::Region& RegionOf(patient::Organ& organ, std::string_view name) {
  return *std::find_if(organ.regions.begin(), organ.regions.end(),
                       [&](const patient::Region& r) { return r.name == name; });
}

/// Every point of the patient through a map that keeps the triangles' sides or mirrors them.
void Transform(patient::Patient& p, const std::function<math::Vec3(const math::Vec3&)>& map, bool is_mirror) {
  for (patient::Organ& organ : p.organs) {
    for (math::Vec3& x : organ.mesh.positions) x = map(x);
    if (is_mirror) {
      for (auto& t : organ.mesh.triangles) std::swap(t[1], t[2]);
    }
  }
  for (patient::Tube& tube : p.tubes) {
    for (math::Vec3& x : tube.line.points) x = map(x);
  }
  for (patient::Landmark& l : p.landmarks) l.position = map(l.position);
}

void Scale(patient::Patient& p, double factor) {
  Transform(
      p, [factor](const math::Vec3& x) { return factor * x; }, false);
  for (patient::Tube& tube : p.tubes) {
    for (double& r : tube.line.radii) r *= factor;
  }
}

TEST(LintPatient, IsSilentAboutTheBuiltInPatient) {
  const LintReport report = LintPatient(BuiltIn());
  EXPECT_THAT(report.findings, IsEmpty()) << Listing(report);
  ASSERT_EQ(report.meshes.size(), 2u);
  EXPECT_EQ(report.meshes[0].name, "liver");
  EXPECT_EQ(report.meshes[0].triangles, 5132u);
  EXPECT_TRUE(report.meshes[0].closed);
  EXPECT_TRUE(report.meshes[0].manifold);
  EXPECT_NEAR(report.meshes[1].volume_ml, 24.14185, 1e-3);
}

/// The built-in patient made wrong in one way, and the one code that this must give.
struct Wrong {
  const char* name;
  std::function<void(patient::Patient&)> change;
  std::set<std::string> codes;
  const char* where;
  const char* text;  // part of the finding's text
};

void PrintTo(const Wrong& wrong, std::ostream* out) {
  *out << wrong.name;
}

class EachWrong : public testing::TestWithParam<Wrong> {};

TEST_P(EachWrong, IsFoundAndNothingElse) {
  patient::Patient patient = BuiltIn();
  GetParam().change(patient);
  const LintReport report = LintPatient(patient);
  EXPECT_EQ(Codes(report), GetParam().codes) << Listing(report);
  const bool is_there = std::any_of(report.findings.begin(), report.findings.end(), [](const LintFinding& f) {
    return f.where == GetParam().where && f.text.find(GetParam().text) != std::string::npos;
  });
  EXPECT_TRUE(is_there) << Listing(report);
}

const Wrong kWrongs[] = {
    {"OrganMissing",
     [](patient::Patient& p) {
       p.organs[0].name = "spleen", p.organs[0].role = roles::OrganRole::kOther;
       TubeOf(p, "common_hepatic_duct").from = "";
       TubeOf(p, "right_hepatic_artery").to = "";
     },
     {"L-ORGAN-MISSING"},
     "liver",
     "no such organ"},
    {"NameTwice",
     [](patient::Patient& p) { TubeOf(p, "cystic_artery").name = "right_hepatic_artery"; },
     {"L-NAME-TWICE"},
     "right_hepatic_artery",
     "two tubes"},
    {"RoleTwice",
     [](patient::Patient& p) { p.landmarks.back().role = roles::LandmarkRole::kFundus; },
     {"L-ROLE-TWICE", "L-LANDMARK-MISSING"},
     "umbilicus",
     "is the fundus, too"},
    {"OpenMesh",
     [](patient::Patient& p) { Liver(p).mesh.triangles.pop_back(); },
     {"L-MESH-OPEN"},
     "liver",
     "3 edges belong"},
    {"NonManifold",
     [](patient::Patient& p) {
       // a second sheet of two triangles back to back on one edge of the liver
       auto& mesh = Liver(p).mesh;
       const auto t = mesh.triangles[0];
       const math::Vec3 out = math::Normalized(geometry::CalcAreaNormal(mesh.positions, t));
       mesh.positions.push_back(mesh.positions[t[0]] + 0.004 * out);
       const auto top = static_cast<std::uint32_t>(mesh.positions.size() - 1);
       mesh.triangles.push_back({t[0], t[1], top});
       mesh.triangles.push_back({t[1], t[0], top});
     },
     {"L-MESH-MANIFOLD"},
     "liver",
     "repair the mesh"},
    {"DoubtfulLabel",
     [](patient::Patient& p) {
       p.labels = {{1, "liver", "its name", ""},
                   {2, "gallbladder", "as asked", "it does not touch the liver"}};
     },
     {"L-LABEL-DOUBT"},
     "gallbladder",
     "does not touch the liver"},
    {"InsideOut",
     [](patient::Patient& p) {
       for (auto& t : Liver(p).mesh.triangles) std::swap(t[1], t[2]);
     },
     {"L-MESH-INSIDE-OUT"},
     "liver",
     "face inwards"},
    {"SelfIntersection",
     [](patient::Patient& p) {
       // a closed ball half through the liver's surface, away from the gallbladder
       auto& mesh = Liver(p).mesh;
       const auto top = *std::max_element(mesh.positions.begin(), mesh.positions.end(),
                                          [](const math::Vec3& a, const math::Vec3& b) { return a.y < b.y; });
       const auto ball = geometry::MakeSphere(top, 0.01, 1);
       const auto first = static_cast<std::uint32_t>(mesh.positions.size());
       mesh.positions.insert(mesh.positions.end(), ball.positions.begin(), ball.positions.end());
       for (const auto& t : ball.triangles)
         mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
     },
     {"L-MESH-SELF-CUT"},
     "liver",
     "near ("},
    {"Sliver",
     [](patient::Patient& p) {
       // one vertex almost onto its neighbour
       auto& mesh = Gallbladder(p).mesh;
       const auto t = mesh.triangles[100];
       mesh.positions[t[1]] = math::Lerp(mesh.positions[t[0]], mesh.positions[t[1]], 0.02);
     },
     {"L-MESH-ANGLE"},
     "gallbladder",
     "angle below 5 degrees"},
    {"MeshNotFinite",
     [](patient::Patient& p) { Liver(p).mesh.positions[7].y = kNan; },
     {"L-MESH-NUMBER"},
     "liver",
     "vertex 7"},
    {"MeshIndexOutOfRange",
     [](patient::Patient& p) { Liver(p).mesh.triangles[3][1] = 1u << 30; },
     {"L-MESH-NUMBER"},
     "liver",
     "triangle 3"},
    {"MeshVast",
     [](patient::Patient& p) { Liver(p).mesh.positions[7].y = 1e300; },
     {"L-MESH-NUMBER"},
     "liver",
     "vertex 7"},
    {"MeshEmpty", [](patient::Patient& p) { Liver(p).mesh = {}; }, {"L-MESH-EMPTY"}, "liver", "no triangle"},
    {"Metres", [](patient::Patient& p) { Scale(p, 1e-3); }, {"L-UNIT"}, "liver", "looks like metres"},
    {"Centimetres",
     [](patient::Patient& p) { Scale(p, 0.1); },
     {"L-UNIT"},
     "liver",
     "looks like centimetres"},
    {"Millimetres",
     [](patient::Patient& p) { Scale(p, 1e3); },
     {"L-UNIT"},
     "liver",
     "looks like millimetres"},
    {"UnitUnknown", [](patient::Patient& p) { Scale(p, 2.3); }, {"L-UNIT"}, "liver", "check the unit"},
    {"LeftRight",
     [](patient::Patient& p) {
       Transform(
           p,
           [](const math::Vec3& x) {
             return math::Vec3{-x.x, x.y, x.z};
           },
           true);
     },
     {"L-SIDE-LEFT-RIGHT", "L-REGION-VISCERAL"},
     "liver",
     "left and right are swapped"},
    {"GallbladderLeft",
     [](patient::Patient& p) {
       // the umbilicus between the gallbladder and the liver's centre
       for (auto& l : p.landmarks) {
         if (l.name == "umbilicus") l.position.x = -0.07;
       }
     },
     {"L-SIDE-LEFT-RIGHT"},
     "gallbladder",
     "left and right are swapped"},
    {"CranialCaudal",
     [](patient::Patient& p) {
       Transform(
           p,
           [](const math::Vec3& x) {
             return math::Vec3{x.x, -x.y, x.z};
           },
           true);
     },
     {"L-SIDE-CRANIAL-CAUDAL", "L-REGION-VISCERAL"},
     "gallbladder",
     "cranial and caudal"},
    {"AnteriorPosterior",
     [](patient::Patient& p) {
       Transform(
           p,
           [](const math::Vec3& x) {
             return math::Vec3{x.x, x.y, -x.z};
           },
           true);
     },
     {"L-SIDE-ANTERIOR-POSTERIOR", "L-REGION-VISCERAL"},
     "gallbladder",
     "anterior and posterior"},
    {"SmallGallbladder",
     [](patient::Patient& p) {
       // a ball of 0.5 mL in its place
       patient::Organ& organ = Gallbladder(p);
       const auto box = geometry::CalcBox(organ.mesh.positions);
       const math::Vec3 middle = 0.5 * (box.min + box.max);
       organ.mesh = geometry::MakeSphere(middle, 0.005, 3);
       organ.regions[0].vertices = {0};
       p.attachments.clear();
       std::erase_if(p.tubes, [](const patient::Tube& t) {
         return t.name == "cystic_duct" || t.name == "cystic_artery";
       });
       for (auto& l : p.landmarks) {
         if (l.name == "fundus") l.position = middle + math::Vec3{0, -0.0035, 0.0035};
         if (l.name == "infundibulum") l.position = middle + math::Vec3{0, 0.0035, -0.0035};
       }
     },
     {"L-VOLUME"},
     "gallbladder",
     "plausible is 4.5"},
    {"RegionMissing",
     [](patient::Patient& p) {
       std::erase_if(Liver(p).regions, [](auto& r) { return r.name == patient::kCoronary; });
     },
     {"L-REGION-MISSING"},
     "liver/coronary",
     "no such region"},
    {"RegionEmpty",
     [](patient::Patient& p) { RegionOf(Liver(p), patient::kFalciform).vertices.clear(); },
     {"L-REGION-EMPTY"},
     "liver/falciform",
     "no vertex"},
    {"RegionOutOfRange",
     [](patient::Patient& p) { RegionOf(Liver(p), patient::kFalciform).vertices.push_back(99999); },
     {"L-REGION-RANGE"},
     "liver/falciform",
     "1 vertex is not in the mesh"},
    {"RegionUnsorted",
     [](patient::Patient& p) { std::ranges::reverse(RegionOf(Liver(p), patient::kFalciform).vertices); },
     {"L-REGION-ORDER"},
     "liver/falciform",
     "do not ascend"},
    {"RegionOnVisceralFace",
     [](patient::Patient& p) {
       auto& vertices = RegionOf(Liver(p), patient::kDiaphragmaticFace).vertices;
       vertices.resize(Liver(p).mesh.positions.size());
       for (std::uint32_t v = 0; v < vertices.size(); ++v) vertices[v] = v;
     },
     {"L-REGION-VISCERAL"},
     "liver/diaphragmatic_face",
     "visceral face"},
    {"RegionOnBed",
     [](patient::Patient& p) {
       RegionOf(Liver(p), patient::kGallbladderBed).vertices = {
           RegionOf(Liver(p), patient::kCoronary).vertices.front()};
     },
     {"L-REGION-VISCERAL"},
     "liver/coronary",
     "gallbladder bed"},
    {"AttachmentFar",
     [](patient::Patient& p) {
       p.attachments[5].vertex_b = RegionOf(Liver(p), patient::kCoronary).vertices.front();
     },
     {"L-ATTACHMENT-FAR"},
     "gallbladder_bed",
     "1 of 832"},
    {"AttachmentOrganOutOfRange",
     [](patient::Patient& p) { p.attachments[5].organ_b = 7; },
     {"L-ATTACHMENT-RANGE"},
     "gallbladder_bed",
     "1 of 832"},
    {"AttachmentVertexOutOfRange",
     [](patient::Patient& p) { p.attachments[5].vertex_a = 1u << 31; },
     {"L-ATTACHMENT-RANGE"},
     "gallbladder_bed",
     "1 of 832"},
    {"TubeToNothingKnown",
     [](patient::Patient& p) { TubeOf(p, "cystic_artery").from = "aorta"; },
     {"L-TUBE-END"},
     "cystic_artery/from",
     "'aorta' is neither"},
    {"TubeToItself",
     [](patient::Patient& p) { TubeOf(p, "cystic_duct").to = "cystic_duct"; },
     {"L-TUBE-END"},
     "cystic_duct/to",
     "ends nowhere"},
    {"CysticDuctLeavesTheScene",
     [](patient::Patient& p) { TubeOf(p, "cystic_duct").to = ""; },
     {"L-TUBE-END"},
     "cystic_duct/to",
     "never leaves the scene"},
    {"DuctsMeetTwice",
     [](patient::Patient& p) {
       // from the common hepatic duct to the common bile duct beside their joint
       patient::Tube loop = TubeOf(p, "common_hepatic_duct");
       loop.name = "loop";
       loop.from = "common_hepatic_duct";
       loop.to = "common_bile_duct";
       p.tubes.push_back(loop);
     },
     {"L-TUBE-CYCLE"},
     "common_hepatic_duct",
     "loop"},
    {"BileCannotFlowOff",
     [](patient::Patient& p) { TubeOf(p, "common_bile_duct").to = "liver"; },
     {"L-DUCT-CLOSED", "L-TUBE-FAR"},
     "cystic_duct",
     "cannot flow off"},
    {"CysticArteryMissesTheGallbladder",
     [](patient::Patient& p) { TubeOf(p, "cystic_artery").to = ""; },
     {"L-TUBE-END"},
     "cystic_artery",
     "leads to the gallbladder"},
    {"TubeAlone",
     [](patient::Patient& p) {
       p.tubes.push_back({"loose_duct",
                          patient::TubeKind::kDuct,
                          "",
                          "",
                          {{{0, 0, 0}, {0, 0.02, 0}}, {0.001, 0.001}},
                          true});
     },
     {"L-TUBE-END"},
     "loose_duct",
     "joins nothing"},
    {"TubeFarFromOrgan",
     [](patient::Patient& p) { TubeOf(p, "cystic_duct").line.points.front().z += 0.02; },
     {"L-TUBE-FAR"},
     "cystic_duct/from",
     "from gallbladder"},
    {"TubeFarFromTube",
     [](patient::Patient& p) { TubeOf(p, "cystic_artery").line.points.front().z += 0.006; },
     {"L-TUBE-FAR"},
     "cystic_artery/from",
     "from right_hepatic_artery"},
    {"TubeThick",
     [](patient::Patient& p) { TubeOf(p, "cystic_duct").line.radii[3] = 0.0031; },
     {"L-TUBE-RADIUS"},
     "cystic_duct",
     "3.1 mm"},
    {"TubeRadiusZero",
     [](patient::Patient& p) { TubeOf(p, "cystic_artery").line.radii[3] = 0.0; },
     {"L-TUBE-RADIUS"},
     "cystic_artery",
     "from 0 to"},
    {"TubeLong",
     [](patient::Patient& p) {
       auto& line = TubeOf(p, "cystic_duct").line;
       line.points.insert(line.points.begin() + 8, line.points[8] + math::Vec3{0, 0, 0.03});
       line.radii.insert(line.radii.begin() + 8, line.radii[8]);
     },
     {"L-TUBE-LENGTH"},
     "cystic_duct",
     "plausible is 5 to 80"},
    {"TubePoints",
     [](patient::Patient& p) { TubeOf(p, "cystic_duct").line.radii.pop_back(); },
     {"L-TUBE-POINTS"},
     "cystic_duct",
     "a radius for each"},
    {"TubeNotFinite",
     [](patient::Patient& p) { TubeOf(p, "cystic_duct").line.points[4].x = kNan; },
     {"L-TUBE-NUMBER"},
     "cystic_duct",
     "not finite"},
    {"UmbilicusMissing",
     [](patient::Patient& p) { std::erase_if(p.landmarks, [](auto& l) { return l.name == "umbilicus"; }); },
     {"L-LANDMARK-MISSING"},
     "umbilicus",
     "place it"},
    {"FundusMissing",
     [](patient::Patient& p) { std::erase_if(p.landmarks, [](auto& l) { return l.name == "fundus"; }); },
     {"L-LANDMARK-MISSING"},
     "fundus",
     "place it"},
    {"InfundibulumMissing",
     [](patient::Patient& p) {
       std::erase_if(p.landmarks, [](auto& l) { return l.name == "infundibulum"; });
     },
     {"L-LANDMARK-MISSING"},
     "infundibulum",
     "place it"},
    {"LandmarkNotFinite",
     [](patient::Patient& p) { p.landmarks[2].position.z = kNan; },
     {"L-LANDMARK-NUMBER"},
     "gallbladder_body",
     "not finite"},
    {"LandmarkFar",
     [](patient::Patient& p) {
       for (auto& l : p.landmarks) {
         if (l.name == "fundus") l.position.z += 0.02;
       }
     },
     {"L-LANDMARK-FAR"},
     "fundus",
     "from the surface of the gallbladder"},
    {"GallbladderDeepInLiver",
     [](patient::Patient& p) {
       // the gallbladder sinks 5 mm towards its bed, and its tubes with it
       patient::Organ& organ = Gallbladder(p);
       const auto& mesh = organ.mesh;
       p.attachments.clear();
       math::Vec3 bed, all;
       for (const auto v : organ.regions[0].vertices) bed += mesh.positions[v];
       for (const math::Vec3& x : mesh.positions) all += x;
       bed = bed / static_cast<double>(organ.regions[0].vertices.size());
       all = all / static_cast<double>(mesh.positions.size());
       const math::Vec3 shift = 0.005 * math::Normalized(bed - all);
       for (math::Vec3& x : organ.mesh.positions) x += shift;
       for (patient::Tube& tube : p.tubes) {
         if (tube.from == "gallbladder") tube.line.points.front() += shift;
         if (tube.to == "gallbladder") tube.line.points.back() += shift;
       }
     },
     {"L-GALLBLADDER-DEEP"},
     "gallbladder",
     "deeper than 2 mm"},
};

INSTANTIATE_TEST_SUITE_P(LintPatient, EachWrong, testing::ValuesIn(kWrongs),
                         [](const auto& one) { return std::string(one.param.name); });

TEST(LintPatient, AcceptsAPatientWithNothingInIt) {
  const LintReport report = LintPatient({});
  EXPECT_THAT(Codes(report), ElementsAre("L-LANDMARK-MISSING", "L-ORGAN-MISSING"));
}

TEST(LintPatient, SaysTheSameTwice) {
  patient::Patient patient = BuiltIn();
  patient.attachments[0].vertex_a = 0;
  Liver(patient).mesh.triangles.erase(Liver(patient).mesh.triangles.begin() + 40);
  EXPECT_EQ(Listing(LintPatient(patient)), Listing(LintPatient(patient)));
}

// docs/patient-check.md names every code that the source can give, and no other.
TEST(LintPatient, EveryCodeIsInTheDocumentation) {
  const auto codes_in = [](const fs::path& file, char quote) {
    const std::string text = *host::ReadFile(fs::path(TROCAR_SOURCE_DIR) / file);
    std::set<std::string> codes;
    const std::string start = std::string(1, quote) + "L-";
    for (auto at = text.find(start); at != std::string::npos; at = text.find(start, at + 1))
      codes.insert(text.substr(at + 1, text.find(quote, at + 1) - at - 1));
    return codes;
  };
  std::set<std::string> in_source;
  for (const auto& entry : fs::directory_iterator(fs::path(TROCAR_SOURCE_DIR) / "src/imaging/anatomy/src")) {
    const std::string name = entry.path().filename();
    if (name.starts_with("patient_lint")) in_source.merge(codes_in("src/imaging/anatomy/src/" + name, '"'));
  }
  EXPECT_GT(in_source.size(), 25u);
  EXPECT_EQ(codes_in("docs/patient-check.md", '`'), in_source);
  std::set<std::string> tested = {"L-MESH-UNREADABLE"};  // below, from a folder
  for (const Wrong& wrong : kWrongs) tested.insert(wrong.codes.begin(), wrong.codes.end());
  EXPECT_EQ(tested, in_source);
}

TEST(LintPatientFolder, FindsWhatReadPatientRefuses) {
  test::TemporaryFolder folder;
  const fs::path copy = folder.Path() / "patient";
  fs::copy(kBuiltIn, copy);
  const std::string whole = *host::ReadFile(copy / "gallbladder.ply");
  ASSERT_TRUE(host::WriteFile(copy / "gallbladder.ply", whole.substr(0, whole.size() / 2)).ok());
  ASSERT_FALSE(files::ReadPatient(copy).ok());
  const auto report = LintPatientFolder(copy);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  ASSERT_EQ(report->findings.size(), 1u) << Listing(*report);
  EXPECT_EQ(report->findings[0].code, "L-MESH-UNREADABLE");
  EXPECT_EQ(report->findings[0].where, "gallbladder");
  EXPECT_THAT(report->findings[0].text, HasSubstr("E-GEO-001"));
  EXPECT_TRUE(report->meshes[0].closed);
}

TEST(LintPatientFolder, RefusesAFolderWithoutPatient) {
  test::TemporaryFolder folder;
  EXPECT_EQ(LintPatientFolder(folder.Path()).error().code, base::ErrorCode::kFileMissing);
  ASSERT_TRUE(host::WriteFile(folder.Path() / "patient.json", "{").ok());
  EXPECT_EQ(LintPatientFolder(folder.Path()).error().code, base::ErrorCode::kJsonSyntax);
}

}  // namespace
}  // namespace trocar::anatomy
