// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/generate_patient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "trocar/anatomy/patient_lint.h"
#include "trocar/anatomy/shape_measures.h"
#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/geometry/tube.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

const patient::Organ& OrganOf(const patient::Patient& patient, const char* name) {
  return patient.organs.at(static_cast<std::size_t>(patient.FindOrgan(name)));
}
const patient::Tube* FindTube(const patient::Patient& patient, std::string_view name) {
  for (const patient::Tube& tube : patient.tubes) {
    if (tube.name == name) return &tube;
  }
  return nullptr;
}
double Millimetres(const patient::Patient& patient, const char* tube) {
  return 1e3 * geometry::CalcLength(FindTube(patient, tube)->line);
}

void ExpectSound(const patient::Patient& patient, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_TRUE(patient::CheckPatient(patient).ok());
  for (const LintFinding& finding : LintPatient(patient).findings)
    ADD_FAILURE() << finding.code << " " << finding.where << ": " << finding.text;
  for (const patient::Organ& organ : patient.organs) {
    const auto report = geometry::InspectMesh(organ.mesh);
    EXPECT_TRUE(report.closed && report.manifold && report.outward) << organ.name;
    EXPECT_EQ(report.components, 1u) << organ.name;
    EXPECT_EQ(report.genus, 0) << organ.name;
    EXPECT_EQ(geometry::CountSelfIntersections(organ.mesh), 0u) << organ.name;
    for (const patient::Region& region : organ.regions) EXPECT_GE(region.vertices.size(), 8u) << region.name;
  }
  const patient::Organ &liver = OrganOf(patient, "liver"), &gallbladder = OrganOf(patient, "gallbladder");
  EXPECT_LE(liver.mesh.triangles.size(), 5132u);
  EXPECT_GE(liver.mesh.triangles.size(), 5030u);
  EXPECT_LE(gallbladder.mesh.triangles.size(), 1798u);
  EXPECT_GE(gallbladder.mesh.triangles.size(), 1763u);
  EXPECT_GE(patient.attachments.size(), 100u);
  for (const char* name : {"fundus", "infundibulum", "gallbladder_body", "liver_edge", "umbilical_fissure",
                           "hepatocystic_triangle", "umbilicus"}) {
    EXPECT_NE(patient.FindLandmark(name), nullptr) << name;
  }
  for (const patient::Tube& tube : patient.tubes) EXPECT_FALSE(tube.is_seen) << tube.name;
  // fundus in front of and below the neck
  const math::Vec3 fundus = patient.FindLandmark("fundus")->position,
                   neck = patient.FindLandmark("infundibulum")->position;
  EXPECT_GT(fundus.z, neck.z + 0.01);
  EXPECT_LT(fundus.y, neck.y);
}

void ExpectApart(const patient::Patient& patient) {
  const meshing::NearestSurface liver(OrganOf(patient, "liver").mesh);
  int inside = 0;
  for (const math::Vec3& p : OrganOf(patient, "gallbladder").mesh.positions) inside += liver.IsInside(p);
  EXPECT_EQ(inside, 0) << "vertices of the gallbladder in the liver";
  // ducts stay out of the organs but for their ends
  for (const char* name :
       {"cystic_duct", "common_hepatic_duct", "common_bile_duct", "right_hepatic_artery"}) {
    const auto& points = FindTube(patient, name)->line.points;
    for (std::size_t i = points.size() / 4; i < points.size() * 3 / 4; ++i)
      EXPECT_FALSE(liver.IsInside(points[i])) << name << ", point " << i;
  }
}

void ExpectSoundSeeds(std::uint64_t first, std::uint64_t end) {
  for (std::uint64_t seed = first; seed < end; ++seed) {
    const auto patient = GeneratePatient(seed);
    ASSERT_TRUE(patient.ok()) << "seed " << seed << ": " << patient.error().Text();
    ExpectSound(*patient, "seed " + std::to_string(seed));
    SCOPED_TRACE("seed " + std::to_string(seed));
    if (seed < 6) ExpectApart(*patient);
    const auto number = [&](const char* name) { return NumberOf(patient->parameters, name); };
    // what was drawn is what was built
    EXPECT_NEAR(number("measured_liver_transverse") / number("liver_transverse"), 1, 0.02);
    EXPECT_NEAR(number("measured_liver_vertical") / number("liver_vertical"), 1, 0.02);
    EXPECT_NEAR(number("measured_liver_depth") / number("liver_depth"), 1, 0.02);
    EXPECT_GT(number("measured_liver_volume"), 950 * 0.92);
    EXPECT_LT(number("measured_liver_volume"), 2060 * 1.12);
    EXPECT_GT(number("measured_gallbladder_volume"), 16 * 0.85);
    EXPECT_LT(number("measured_gallbladder_volume"), 60 * 1.12);
  }
}

TEST(GeneratePatient, EightSeedsAreSoundAndOfTheirSize) {
  ExpectSoundSeeds(0, 8);
}

TEST(GeneratePatientSlow, TwelveMoreSeedsAreSoundAndOfTheirSize) {
  ExpectSoundSeeds(8, 20);
}

TEST(GeneratePatient, AWideCysticDuctHasAMouthThatTheLinterAccepts) {
  const auto patient = GeneratePatient(30, std::vector<ParameterSetting>{{"cystic_duct_diameter", "4.9"}});
  ASSERT_TRUE(patient.ok());
  ExpectSound(*patient, "4.9 mm");
}

TEST(GeneratePatient, SameSeedGivesTheSameBits) {
  const auto first = GeneratePatient(5), second = GeneratePatient(5), other = GeneratePatient(6);
  ASSERT_TRUE(first.ok() && second.ok() && other.ok());
  for (std::size_t i = 0; i < first->organs.size(); ++i)
    EXPECT_EQ(first->organs[i].mesh, second->organs[i].mesh);
  for (std::size_t i = 0; i < first->tubes.size(); ++i)
    EXPECT_EQ(first->tubes[i].line, second->tubes[i].line);
  EXPECT_EQ(first->parameters, second->parameters);
  EXPECT_NE(first->organs[0].mesh, other->organs[0].mesh);
}

TEST(GeneratePatient, VariationsAreThereWhenTheyAreSet) {
  const auto make = [](std::vector<ParameterSetting> settings) {
    settings.insert(settings.begin(), {{"population", "ideal"},
                                       {"double_cystic_artery", "no"},
                                       {"subvesical_duct", "no"},
                                       {"moynihan_hump", "no"},
                                       {"phrygian_cap", "no"},
                                       {"cystic_duct_insertion", "lateral"},
                                       {"cystic_duct_class", "normal"}});
    auto patient = GeneratePatient(3, settings);
    EXPECT_TRUE(patient.ok()) << patient.error().Text();
    ExpectSound(*patient, settings.back().first);
    return *patient;
  };
  const patient::Patient plain = make({});
  EXPECT_EQ(plain.tubes.size(), 5u);
  EXPECT_NEAR(Millimetres(plain, "cystic_duct"), NumberOf(plain.parameters, "cystic_duct_length"), 2.5);
  EXPECT_NE(FindTube(make({{"double_cystic_artery", "yes"}}), "cystic_artery_deep"), nullptr);
  EXPECT_NE(FindTube(make({{"subvesical_duct", "yes"}}), "subvesical_duct"), nullptr);

  // the hump brings the artery to the gallbladder's neck
  const auto nearest_to_neck = [](const patient::Patient& patient) {
    double nearest = 1;
    for (const math::Vec3& p : FindTube(patient, "right_hepatic_artery")->line.points)
      nearest = std::min(nearest, Distance(p, patient.FindLandmark("infundibulum")->position));
    return nearest;
  };
  EXPECT_LT(nearest_to_neck(make({{"moynihan_hump", "yes"}})), 0.009);
  EXPECT_GT(nearest_to_neck(plain), 0.010);

  // a low insertion lengthens the common hepatic duct, a high one shortens it
  const double usual = Millimetres(plain, "common_hepatic_duct");
  EXPECT_GT(Millimetres(make({{"cystic_duct_insertion", "low"}}), "common_hepatic_duct"), usual + 12);
  EXPECT_LT(Millimetres(make({{"cystic_duct_insertion", "high"}}), "common_hepatic_duct"), usual - 8);
  // a parallel duct runs beside the common hepatic duct for 12 mm or more
  const patient::Patient parallel = make({{"cystic_duct_insertion", "parallel"}});
  const auto& hepatic = FindTube(parallel, "common_hepatic_duct")->line.points;
  int beside = 0;
  for (const math::Vec3& p : FindTube(parallel, "cystic_duct")->line.points) {
    double nearest = 1;
    for (const math::Vec3& q : hepatic) nearest = std::min(nearest, Distance(p, q));
    beside += nearest < 0.006;
  }
  EXPECT_GE(beside, 6) << "points 2 mm apart";
  const patient::Patient brief = make({{"cystic_duct_class", "short"}}),
                         lengthy = make({{"cystic_duct_class", "long"}});
  EXPECT_LT(Millimetres(brief, "cystic_duct"), 22);
  EXPECT_GT(Millimetres(lengthy, "cystic_duct"), 40);

  // a folded fundus makes the gallbladder shorter from end to end
  const auto extent = [](const patient::Patient& patient) {
    const auto box = geometry::CalcBox(OrganOf(patient, "gallbladder").mesh.positions);
    return Distance(box.min, box.max);
  };
  EXPECT_LT(extent(make({{"phrygian_cap", "yes"}})), 0.95 * extent(plain));
}

TEST(GeneratePatient, PathologiesChangeTheOrgans) {
  const auto make = [](std::vector<ParameterSetting> settings) {
    settings.emplace_back("population", "ideal");
    auto patient = GeneratePatient(2, settings);
    EXPECT_TRUE(patient.ok()) << patient.error().Text();
    ExpectSound(*patient, settings.front().first);
    return *patient;
  };
  const auto measured = [](const patient::Patient& patient, const char* name) {
    return NumberOf(patient.parameters, name);
  };
  const patient::Patient healthy = make({});
  EXPECT_NEAR(measured(make({{"steatosis", "1"}}), "measured_liver_volume"),
              1.25 * measured(healthy, "measured_liver_volume"),
              0.06 * measured(healthy, "measured_liver_volume"));
  EXPECT_GT(measured(make({{"hydrops", "1"}}), "measured_gallbladder_volume"),
            2 * measured(healthy, "measured_gallbladder_volume"));
  EXPECT_LT(measured(make({{"scleroatrophy", "1"}}), "measured_gallbladder_volume"),
            0.6 * measured(healthy, "measured_gallbladder_volume"));
  EXPECT_GT(measured(make({{"acute_cholecystitis", "1"}}), "measured_gallbladder_volume"),
            1.3 * measured(healthy, "measured_gallbladder_volume"));
  // nodules: the diaphragmatic face, smooth when healthy, bends both ways
  const auto roughness = [](const patient::Patient& patient) {
    const patient::Organ& liver = OrganOf(patient, "liver");
    std::vector<math::Vec3> normals(liver.mesh.positions.size());
    geometry::CalcVertexNormals(liver.mesh.positions, liver.mesh.triangles, normals);
    const std::set<std::uint32_t> face(liver.regions[0].vertices.begin(), liver.regions[0].vertices.end());
    double sum = 0;
    int count = 0;
    for (const auto& t : liver.mesh.triangles) {
      if (!face.contains(t[0]) || !face.contains(t[1])) continue;
      sum += Norm(normals[t[0]] - normals[t[1]]), ++count;
    }
    return sum / count;
  };
  const patient::Patient cirrhotic = make({{"cirrhosis", "1"}});
  EXPECT_GT(roughness(cirrhotic), 1.5 * roughness(healthy));
  EXPECT_EQ(measured(make({{"adhesions", "0.7"}}), "adhesions"), 0.7);
}

TEST(GeneratePatient, ComesBackFromItsFolder) {
  const test::TemporaryFolder temporary;
  const auto folder = temporary.Path() / "patient";
  const auto patient = GeneratePatient(9);
  ASSERT_TRUE(patient.ok());
  ASSERT_TRUE(files::WritePatient(folder, *patient).ok());
  const auto read = files::ReadPatient(folder);
  ASSERT_TRUE(read.ok()) << read.error().Text();
  EXPECT_EQ(read->parameters, patient->parameters);
  EXPECT_GE(read->parameters.size(), ParameterRules().size() + 9);
}

TEST(GeneratePatient, TheGallbladderLiesAsInclinedAsItIsSet) {
  for (const char* inclination : {"20", "45", "60"}) {
    const std::vector<ParameterSetting> settings = {{"gallbladder_inclination", inclination},
                                                    {"phrygian_cap", "no"}};
    const auto patient = GeneratePatient(4, settings);
    ASSERT_TRUE(patient.ok()) << patient.error().Text();
    ExpectSound(*patient, inclination);
    const auto measures = MeasureShapes(*patient);
    ASSERT_TRUE(measures.ok()) << measures.error().Text();
    for (const ShapeMeasure& measure : *measures) {
      if (measure.name == "gallbladder_inclination") {
        EXPECT_NEAR(measure.value, std::stod(inclination), 7);
      }
    }
  }
}

TEST(GeneratePatient, AHartmannPouchSagsFromTheFreeWallAlone) {
  const auto with_pouch = [](const char* is_there) {
    const std::vector<ParameterSetting> settings = {
        {"hartmann_pouch", is_there}, {"hartmann_pouch_depth", "8"}, {"phrygian_cap", "no"}};
    return *GeneratePatient(4, settings);
  };
  const patient::Patient plain = with_pouch("no"), pouched = with_pouch("yes");
  ExpectSound(pouched, "a deep pouch");
  const meshing::NearestSurface surface(OrganOf(plain, "gallbladder").mesh);
  const patient::Organ& gallbladder = OrganOf(pouched, "gallbladder");
  std::set<std::uint32_t> in_bed;
  for (const patient::Region& region : gallbladder.regions) {
    if (region.name == patient::kGallbladderBed)
      in_bed.insert(region.vertices.begin(), region.vertices.end());
  }
  ASSERT_FALSE(in_bed.empty());
  double free_wall = 0, liver_side = 0;  // most, and mean [mm]
  for (std::uint32_t v = 0; v < gallbladder.mesh.positions.size(); ++v) {
    const double distance = 1e3 * surface.Find(gallbladder.mesh.positions[v]).distance;
    if (in_bed.contains(v)) {
      liver_side += distance / static_cast<double>(in_bed.size());
    } else {
      free_wall = std::max(free_wall, distance);
    }
  }
  EXPECT_NEAR(free_wall, 8, 2.5);
  EXPECT_LT(liver_side, 1.5);
}

/// Of one body twice, as docs/shapes.md has them: trocar anatomy measure out/labels
/// assets/patients/visible-human-male/patient
const std::map<std::string, std::pair<double, double>, std::less<>> kRealMeasures = {
    {"liver_transverse", {188, 187}},
    {"liver_vertical", {180, 178}},
    {"liver_depth", {189, 193}},
    {"liver_volume", {1764, 1811}},
    {"fundus_below_edge", {-15.1, -22.5}},
    {"gallbladder_length", {77, 73}},
    {"gallbladder_diameter", {28, 26.8}},
    {"gallbladder_volume", {28.5, 24.1}},
    {"gallbladder_inclination", {21.3, 16.7}},
    {"gallbladder_azimuth", {25, 23.3}},
    {"gallbladder_bend", {37.6, 34.5}},
    {"gallbladder_neck", {12.5, 11.4}},
    {"contact_area", {2331, 2308}},
    {"contact_share", {0.412, 0.444}},
    {"fossa_depth", {13.8, 14.5}},
    {"fossa_depth_share", {0.491, 0.54}},
    {"wall_beyond_duct", {0.3, 4.24}},
    {"infundibulum_to_hilum", {29.7, 20.4}},
};

TEST(GeneratePatientSlow, FortySeedsAreSoundAndHoldTheRealOne) {
  std::map<std::string, std::pair<double, double>, std::less<>> ranges;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto patient = GeneratePatient(seed);
    ASSERT_TRUE(patient.ok()) << "seed " << seed << ": " << patient.error().Text();
    ExpectSound(*patient, "seed " + std::to_string(seed));
    for (const patient::Organ& organ : patient->organs)
      EXPECT_GT(geometry::InspectMesh(organ.mesh).min_angle * 180 / M_PI, 5.0)
          << organ.name << ", seed " << seed;
    const auto measures = MeasureShapes(*patient);
    ASSERT_TRUE(measures.ok()) << measures.error().Text();
    for (const ShapeMeasure& measure : *measures) {
      const auto [range, is_new] =
          ranges.try_emplace(std::string(measure.name), std::pair{measure.value, measure.value});
      range->second.first = std::min(range->second.first, measure.value);
      range->second.second = std::max(range->second.second, measure.value);
    }
  }
  for (const auto& [name, real] : kRealMeasures) {
    const auto& [least, most] = ranges.at(name);
    EXPECT_LE(least, std::min(real.first, real.second)) << name;
    EXPECT_GE(most, std::max(real.first, real.second)) << name;
  }
}

}  // namespace
}  // namespace trocar::anatomy
