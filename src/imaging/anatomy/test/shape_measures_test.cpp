// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/shape_measures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "trocar/anatomy/generate_patient.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

double ValueOf(const std::vector<ShapeMeasure>& measures, std::string_view name) {
  for (const ShapeMeasure& measure : measures) {
    if (measure.name == name) return measure.value;
  }
  ADD_FAILURE() << "no measure " << name;
  return 0;
}

using Profile = double (*)(double t);

/// A body of revolution of 80 mm from the origin along `axis`, its upper half in a slab of liver whose face lies in
/// the axis' plane; `radius` gives it at each part of the axis [m].
patient::Patient MakePear(const math::Vec3& axis, Profile radius) {
  constexpr int kRings = 59, kSpokes = 48;  // no ring lies between two slabs
  constexpr double kLength = 0.080;
  const math::Vec3 up = math::Normalized(math::Cross(math::Cross(axis, {0, 1, 0}), axis), {0, 0, 1});
  const math::Vec3 side = math::Cross(axis, up);
  patient::Patient patient;
  patient::Organ gallbladder{"gallbladder", {}, {}};
  auto& mesh = gallbladder.mesh;
  for (int i = 0; i <= kRings; ++i) {
    const double t = static_cast<double>(i) / kRings;
    for (int k = 0; k < kSpokes; ++k) {
      const double turn = 2 * M_PI * k / kSpokes;
      mesh.positions.push_back(kLength * t * axis +
                               radius(t) * (std::cos(turn) * up + std::sin(turn) * side));
    }
  }
  const auto at = [](int i, int k) { return static_cast<std::uint32_t>(i * kSpokes + k % kSpokes); };
  for (int i = 0; i < kRings; ++i) {
    for (int k = 0; k < kSpokes; ++k) {
      mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      mesh.triangles.push_back({at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
    }
  }
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({});
  mesh.positions.push_back(kLength * axis);
  for (int k = 0; k < kSpokes; ++k) {
    mesh.triangles.push_back({first, at(0, k + 1), at(0, k)});
    mesh.triangles.push_back({first + 1, at(kRings, k), at(kRings, k + 1)});
  }
  patient::Region bed{patient::kGallbladderBed, {}};
  for (std::uint32_t v = 0; v < first; ++v)
    if (Dot(mesh.positions[v], up) > -1e-9) bed.vertices.push_back(v);
  gallbladder.regions = {bed};
  // a tetrahedron is liver enough: it is not looked at here
  patient::Organ liver{"liver", {}, {}};
  liver.mesh.positions = {{0, 0, 0}, {0.2, 0, 0}, {0, 0.15, 0}, {0, 0, 0.1}};
  liver.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  patient.organs = {liver, gallbladder};
  patient.landmarks = {{"infundibulum", {0, 0, 0}}, {"fundus", kLength * axis}};
  return patient;
}

TEST(ShapeMeasures, OfACylinderHalfInTheLiverAreKnown) {
  const double tilt = 0.5, turn = 0.3;
  const math::Vec3 axis = {-std::cos(tilt) * std::sin(turn), -std::sin(tilt),
                           std::cos(tilt) * std::cos(turn)};
  const auto measures = MeasureShapes(MakePear(axis, [](double) { return 0.015; }));
  ASSERT_TRUE(measures.ok()) << measures.error().Text();
  EXPECT_NEAR(ValueOf(*measures, "liver_transverse"), 200, 1e-9);
  EXPECT_NEAR(ValueOf(*measures, "liver_volume"), 0.2 * 0.15 * 0.1 / 6 * 1e6, 1e-6);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_length"), 80, 1e-9);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_diameter"), 30, 0.01);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_volume"), M_PI * 15 * 15 * 80 / 1000, 0.3);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_inclination"), tilt * 180 / M_PI, 1e-9);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_azimuth"), turn * 180 / M_PI, 1e-9);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_bend"), 0, 0.1);
  EXPECT_NEAR(ValueOf(*measures, "hartmann_pouch"), 0, 0.1);
  EXPECT_NEAR(ValueOf(*measures, "contact_area"), M_PI * 15 * 80, 20);
  EXPECT_NEAR(ValueOf(*measures, "fossa_depth"), 12.3, 0.3)
      << "the half circles at both ends are border, too";
}

TEST(ShapeMeasures, AConstrictionAfterTheInfundibulumIsAPouch) {
  const auto measures = MeasureShapes(MakePear({0, 0, 1}, [](double t) {
    return t < 0.15 ? 0.012 : t < 0.3 ? 0.008 : 0.015;
  }));
  ASSERT_TRUE(measures.ok()) << measures.error().Text();
  EXPECT_NEAR(ValueOf(*measures, "hartmann_pouch"), 8, 0.5);
  EXPECT_NEAR(ValueOf(*measures, "gallbladder_neck"), 16, 0.5);
}

TEST(ShapeMeasures, OfGeneratedPatientsFollowWhatTheyWereDrawnWith) {
  const std::vector<ParameterSetting> shallow = {{"population", "ideal"},
                                                 {"gallbladder_embedding", "0.25"},
                                                 {"gallbladder_bend", "0"}},
                                      deep = {{"population", "ideal"},
                                              {"gallbladder_embedding", "0.48"},
                                              {"gallbladder_bend", "40"}};
  const auto one = MeasureShapes(*GeneratePatient(3, shallow)),
             other = MeasureShapes(*GeneratePatient(3, deep));
  ASSERT_TRUE(one.ok() && other.ok());
  EXPECT_GT(ValueOf(*other, "contact_share"), ValueOf(*one, "contact_share") + 0.05);
  EXPECT_GT(ValueOf(*other, "fossa_depth"), ValueOf(*one, "fossa_depth"));
  EXPECT_GT(ValueOf(*other, "gallbladder_bend"), ValueOf(*one, "gallbladder_bend"));
  const auto hilum = std::find_if(one->begin(), one->end(),
                                  [](const ShapeMeasure& it) { return it.name == "infundibulum_to_hilum"; });
  ASSERT_NE(hilum, one->end());
  EXPECT_FALSE(hilum->is_seen) << "its duct is a template";
}

TEST(ShapeMeasures, NeedABed) {
  patient::Patient patient = MakePear({0, 0, 1}, [](double) { return 0.015; });
  patient.organs[1].regions.clear();
  const auto measures = MeasureShapes(patient);
  ASSERT_FALSE(measures.ok());
  EXPECT_EQ(measures.error().code, base::ErrorCode::kPatientInvalid);
}

}  // namespace
}  // namespace trocar::anatomy
