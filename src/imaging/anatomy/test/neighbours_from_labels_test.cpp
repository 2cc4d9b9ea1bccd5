// SPDX-License-Identifier: Apache-2.0
// What a label map shows round liver and gallbladder comes along: meshes, templates for what it lacks, ports with reasons.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "trocar/anatomy/move_port.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/anatomy/patient_lint.h"
#include "trocar/files/patient_file.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/json.h"
#include "trocar/host/safe_file.h"
#include "trocar/meshing/nearest_surface.h"
#include "trocar/patient/patient.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::anatomy {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::array<int, 3> kMapSize = {80, 70, 92};  // voxels
constexpr double kVoxelMm = 2.5;                       // mm

/// TotalSegmentator's numbers, version 2.
enum Label {
  kTotalKidney = 2,
  kTotalGallbladder = 4,
  kTotalLiver = 5,
  kTotalStomach = 6,
  kTotalDuodenum = 19,
  kTotalColon = 20,
  kTotalL4 = 28,
  kTotalL3 = 29,
  kTotalL2 = 30,
  kTotalAorta = 52,
  kTotalCava = 63,
  kTotalRib = 110
};

/// A body of balls, tubes and boxes. Voxel axes run to the right, anterior and superior (RAS); mm from the middle of the liver.
class TrunkMap {
 public:
  static std::array<double, 3> PlaceOf(int i, int j, int k) {
    return {kVoxelMm * (i - 40), kVoxelMm * (j - 38), kVoxelMm * (k - 62)};
  }
  using Shape = std::function<bool(double r, double a, double s)>;
  static Shape Ball(std::array<double, 3> c, std::array<double, 3> radii) {
    return [=](double r, double a, double s) {
      return std::pow((r - c[0]) / radii[0], 2) + std::pow((a - c[1]) / radii[1], 2) +
                 std::pow((s - c[2]) / radii[2], 2) <
             1;
    };
  }
  /// From one end to the other, with round ends.
  static Shape Tube(std::array<double, 3> from, std::array<double, 3> to, double radius) {
    return [=](double r, double a, double s) {
      const math::Vec3 p{r, a, s}, x{from[0], from[1], from[2]}, way = math::Vec3{to[0], to[1], to[2]} - x;
      const double t = std::clamp(math::Dot(p - x, way) / math::SquaredNorm(way), 0.0, 1.0);
      return math::Distance(p, x + t * way) < radius;
    };
  }

  TrunkMap() {
    labels_.assign(static_cast<std::size_t>(kMapSize[0]) * kMapSize[1] * kMapSize[2], 0);
    Fill(kTotalGallbladder, Tube({20, 42, -62}, {20, -20, -40}, 13));
    Fill(kTotalLiver, Ball({0, 0, 0}, {85, 62, 50}));
    Fill(kTotalStomach, Ball({-62, 25, -62}, {26, 30, 24}));
    Fill(kTotalColon, Tube({80, 36, -108}, {-70, 36, -114}, 16));
    Fill(kTotalDuodenum, Tube({-8, -10, -66}, {-8, -30, -110}, 11));
    Fill(kTotalKidney, Ball({58, -62, -62}, {24, 20, 44}));
    Fill(kTotalL4, Tube({-10, -82, -142}, {-10, -82, -132}, 11));
    Fill(kTotalL3, Tube({-10, -82, -112}, {-10, -82, -100}, 13));
    Fill(kTotalL2, Tube({-10, -82, -78}, {-10, -82, 30}, 12));
    Fill(kTotalAorta, Tube({-22, -62, -125}, {-22, -64, 40}, 8));
    Fill(kTotalCava, Tube({6, -62, -125}, {6, -66, 40}, 9));
    Fill(kTotalRib, Tube({92, -20, -20}, {84, 40, -48}, 7));
  }
  /// Only where nothing is yet.
  void Fill(int label, const Shape& shape) {
    ForEach([&](std::uint8_t& at, double r, double a, double s) {
      if (at == 0 && shape(r, a, s)) at = static_cast<std::uint8_t>(label);
    });
  }
  void Rename(int from, int to) {
    for (std::uint8_t& label : labels_) {
      if (label == from) label = static_cast<std::uint8_t>(to);
    }
  }
  /// Voxels within 60 mm of the box round liver and gallbladder [mL].
  double VolumeOf(int label) const {
    std::array<int, 3> low = kMapSize, high = {0, 0, 0};
    const auto visit = [&](const auto& act) {
      std::size_t at = 0;
      for (int k = 0; k < kMapSize[2]; ++k)
        for (int j = 0; j < kMapSize[1]; ++j)
          for (int i = 0; i < kMapSize[0]; ++i) act(labels_[at++], std::array{i, j, k});
    };
    visit([&](int one, const std::array<int, 3>& index) {
      if (one != kTotalLiver && one != kTotalGallbladder) return;
      for (std::size_t axis = 0; axis < 3; ++axis)
        low[axis] = std::min(low[axis], index[axis]), high[axis] = std::max(high[axis], index[axis]);
    });
    std::size_t count = 0;
    const int reach = static_cast<int>(60 / kVoxelMm);
    visit([&](int one, const std::array<int, 3>& index) {
      if (one != label) return;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (index[axis] < low[axis] - reach || index[axis] > high[axis] + reach) return;
      }
      ++count;
    });
    return static_cast<double>(count) * kVoxelMm * kVoxelMm * kVoxelMm / 1000.0;
  }
  std::string Nifti() const {
    std::string text(352, '\0');
    const auto put = [&](std::size_t at, auto value) { std::memcpy(&text[at], &value, sizeof value); };
    put(0, std::int32_t{348});
    const std::int16_t dims[8] = {3, kMapSize[0], kMapSize[1], kMapSize[2], 1, 1, 1, 1};
    std::memcpy(&text[40], dims, sizeof dims);
    put(70, std::int16_t{2}), put(72, std::int16_t{8});
    const auto step = static_cast<float>(kVoxelMm);
    const float sizes[8] = {1, step, step, step, 1, 1, 1, 1};
    std::memcpy(&text[76], sizes, sizeof sizes);
    put(108, 352.0f), put(112, 1.0f), put(123, char{2}), put(254, std::int16_t{1});
    const float rows[12] = {step, 0, 0, 10, 0, step, 0, -20, 0, 0, step, 30};
    std::memcpy(&text[280], rows, sizeof rows);
    std::memcpy(&text[344], "n+1", 4);
    text.append(reinterpret_cast<const char*>(labels_.data()), labels_.size());
    return text;
  }

 private:
  void ForEach(const std::function<void(std::uint8_t&, double, double, double)>& visit) {
    std::size_t at = 0;
    for (int k = 0; k < kMapSize[2]; ++k) {
      for (int j = 0; j < kMapSize[1]; ++j) {
        for (int i = 0; i < kMapSize[0]; ++i) {
          const auto [r, a, s] = PlaceOf(i, j, k);
          visit(labels_[at++], r, a, s);
        }
      }
    }
  }

  std::vector<std::uint8_t> labels_;
};

class NeighboursFromLabels : public testing::Test {
 protected:
  BuildReport Build(const TrunkMap& body, const std::string& names = "") {
    LabelOptions options;
    options.labels = folder_ / "map.nii";
    options.output = folder_ / "patient";
    options.spacing_mm = 2.0;
    EXPECT_TRUE(host::WriteFile(options.labels, body.Nifti()).ok());
    if (!names.empty()) {
      options.names = folder_ / "names.json";
      EXPECT_TRUE(host::WriteFile(options.names, names).ok());
    }
    auto report = BuildPatientFromLabels(options);
    EXPECT_TRUE(report.ok()) << report.error().Text();
    return report.ok() ? std::move(*report) : BuildReport{};
  }
  /// How deep the deepest vertex of a mesh lies in a closed other one [m].
  static double DepthIn(const geometry::TriangleMesh& mesh, const geometry::TriangleMesh& other) {
    const meshing::NearestSurface surface(other);
    double deepest = 0;
    for (const math::Vec3& p : mesh.positions) {
      const double distance = surface.Find(p).distance;
      if (distance > deepest && surface.IsInside(p)) deepest = distance;
    }
    return deepest;
  }

  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.Path();
};

TEST_F(NeighboursFromLabels, HaveTheVolumeOfTheirVoxelsAndNoSlivers) {
  const TrunkMap body;
  const BuildReport report = Build(body);
  const std::map<roles::NeighbourRole, std::vector<int>> wanted = {
      {roles::NeighbourRole::kStomach, {kTotalStomach}},
      {roles::NeighbourRole::kDuodenum, {kTotalDuodenum}},
      {roles::NeighbourRole::kColon, {kTotalColon}},
      {roles::NeighbourRole::kRightKidney, {kTotalKidney}},
      {roles::NeighbourRole::kAorta, {kTotalAorta}},
      {roles::NeighbourRole::kVenaCava, {kTotalCava}},
      {roles::NeighbourRole::kRibs, {kTotalRib}},
      {roles::NeighbourRole::kSpine, {kTotalL2, kTotalL3, kTotalL4}}};
  for (const auto& [role, labels] : wanted) {
    SCOPED_TRACE(roles::NameOf(role));
    const patient::Neighbour* neighbour = report.patient.NeighbourOf(role);
    ASSERT_NE(neighbour, nullptr);
    EXPECT_TRUE(neighbour->is_seen);
    double voxels_ml = 0;
    for (const int label : labels) voxels_ml += body.VolumeOf(label);
    const auto inspected = geometry::InspectMesh(neighbour->mesh);
    EXPECT_TRUE(inspected.closed && inspected.manifold && inspected.outward);
    EXPECT_NEAR(1e6 * inspected.volume / voxels_ml, 1.0, 0.02);
    EXPECT_GE(inspected.min_angle * 180 / M_PI, 5.0);
    EXPECT_GE(inspected.triangles, 200u);
    EXPECT_LE(inspected.triangles, 8000u);
  }
  // where they are: the colon caudal of the gallbladder, the kidney behind, the stomach to the left
  const auto centre = [&](roles::NeighbourRole role) {
    const auto box = geometry::CalcBox(report.patient.NeighbourOf(role)->mesh.positions);
    return 0.5 * (box.min + box.max);
  };
  const math::Vec3 fundus = report.patient.LandmarkOf(roles::LandmarkRole::kFundus)->position;
  EXPECT_NEAR(fundus.y - centre(roles::NeighbourRole::kColon).y, 0.045, 0.012);
  EXPECT_NEAR(centre(roles::NeighbourRole::kStomach).x - fundus.x, 0.082, 0.012);
  EXPECT_LT(centre(roles::NeighbourRole::kRightKidney).z, fundus.z - 0.080);
  for (const NeighbourReport& one : report.neighbours) {
    if (one.is_seen) {
      EXPECT_NEAR(one.volume_ml / one.voxels_ml, 1.0, 0.02) << one.name;
    }
  }
}

TEST_F(NeighboursFromLabels, ComeBackFromThePatientsFolder) {
  const BuildReport report = Build(TrunkMap());
  const auto read = files::ReadPatient(folder_ / "patient");
  ASSERT_TRUE(read.ok()) << read.error().Text();
  ASSERT_EQ(read->neighbours.size(), report.patient.neighbours.size());
  for (std::size_t i = 0; i < read->neighbours.size(); ++i) {
    const patient::Neighbour &a = read->neighbours[i], &b = report.patient.neighbours[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.role, b.role);
    EXPECT_EQ(a.is_seen, b.is_seen);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
  }
  ASSERT_EQ(read->ports.size(), patient::kPortUseCount);
  for (const patient::Port& port : read->ports) {
    EXPECT_NEAR(math::Distance(port.position, report.patient.PortOf(port.use)->position), 0.0, 1e-9);
    EXPECT_EQ(port.reason, report.patient.PortOf(port.use)->reason);
  }
  ASSERT_TRUE(read->table.has_value());
  EXPECT_NEAR(read->table->head_up, report.patient.table->head_up, 1e-12);
  const auto lint = LintPatientFolder(folder_ / "patient");
  ASSERT_TRUE(lint.ok());
  for (const auto& finding : lint->findings) ADD_FAILURE() << finding.code << " " << finding.text;
  // a missing surface is found, by those who read and by those who check
  fs::remove(folder_ / "patient" / "stomach.ply");
  EXPECT_EQ(files::ReadPatient(folder_ / "patient").error().code, base::ErrorCode::kFileMissing);
  const auto broken = LintPatientFolder(folder_ / "patient");
  ASSERT_TRUE(broken.ok());
  ASSERT_EQ(broken->findings.size(), 1u);
  EXPECT_EQ(broken->findings[0].code, "L-MESH-UNREADABLE");
  EXPECT_EQ(broken->findings[0].where, "stomach");
}

TEST_F(NeighboursFromLabels, AreATemplateWhereTheMapHasNone) {
  TrunkMap body;
  body.Rename(kTotalStomach, 0), body.Rename(kTotalDuodenum, 0), body.Rename(kTotalKidney, 0);
  const BuildReport report = Build(body);
  for (const roles::NeighbourRole role :
       {roles::NeighbourRole::kStomach, roles::NeighbourRole::kDuodenum, roles::NeighbourRole::kRightKidney,
        roles::NeighbourRole::kPancreas, roles::NeighbourRole::kPortalVein}) {
    SCOPED_TRACE(roles::NameOf(role));
    const patient::Neighbour* neighbour = report.patient.NeighbourOf(role);
    ASSERT_NE(neighbour, nullptr);
    EXPECT_FALSE(neighbour->is_seen);
    const auto inspected = geometry::InspectMesh(neighbour->mesh);
    EXPECT_TRUE(inspected.closed && inspected.manifold && inspected.outward);
    EXPECT_GE(inspected.min_angle * 180 / M_PI, 5.0);
    for (const patient::Organ& organ : report.patient.organs)
      EXPECT_LT(DepthIn(neighbour->mesh, organ.mesh), 0.002);
  }
  EXPECT_TRUE(report.patient.NeighbourOf(roles::NeighbourRole::kColon)->is_seen);
  EXPECT_EQ(report.patient.NeighbourOf(roles::NeighbourRole::kSmallBowel), nullptr);
  EXPECT_THAT(FormatSurroundings(report), HasSubstr("template"));
}

TEST_F(NeighboursFromLabels, PortsFollowTheBodyAndSayWhy) {
  const BuildReport report = Build(TrunkMap());
  const patient::Patient& patient = report.patient;
  const patient::Port* eye = patient.PortOf(patient::PortUse::kLaparoscope);
  ASSERT_NE(eye, nullptr);
  EXPECT_THAT(eye->reason, HasSubstr("in the midline by the spine"));
  EXPECT_THAT(eye->reason, HasSubstr("third and fourth lumbar vertebrae"));
  EXPECT_THAT(eye->reason, HasSubstr("the gas lifts it"));
  // the origin is the navel: in the spine's sagittal plane, 30 mm left of the gallbladder's
  const math::Vec3 fundus = patient.LandmarkOf(roles::LandmarkRole::kFundus)->position;
  EXPECT_NEAR(fundus.x, -0.030, 0.004);
  EXPECT_NEAR(eye->position.x, 0.0, 1e-9);
  // disc at s = -121, fundus at s = -66
  EXPECT_NEAR(fundus.y, 0.055, 0.005);
  EXPECT_LT(fundus.z, -0.040);
  for (const patient::Port& port : patient.ports) {
    SCOPED_TRACE(NameOf(port.use));
    EXPECT_FALSE(port.reason.empty());
    EXPECT_EQ(port.reason.back(), '.');
    const math::Vec3 neck = patient.LandmarkOf(roles::LandmarkRole::kInfundibulum)->position;
    EXPECT_GT(math::Distance(port.position, neck), 0.070);
    EXPECT_LT(math::Distance(port.position, neck), 0.225);
    for (const patient::Port& other : patient.ports) {
      if (&other != &port) {
        EXPECT_GT(math::Distance(port.position, other.position), 0.035);
      }
    }
    // in front of everything there, and below the rib
    for (const patient::Organ& organ : patient.organs)
      EXPECT_EQ(DepthIn({{port.position}, {}}, organ.mesh), 0.0);
  }
  EXPECT_THAT(FormatSurroundings(report), HasSubstr("Port for right hand"));
  ASSERT_TRUE(patient.table.has_value());
  EXPECT_FALSE(patient.table->reason.empty());
}

TEST_F(NeighboursFromLabels, APortMovesOnTheWallAsFarAsTheRulesAllow) {
  BuildReport report = Build(TrunkMap());
  patient::Patient& patient = report.patient;
  const patient::Port& hand = *patient.PortOf(patient::PortUse::kLeftHand);
  const auto moved = MovePort(patient, patient::PortUse::kLeftHand, hand.position.x, hand.position.y - 0.005);
  ASSERT_TRUE(moved.ok()) << moved.error().Text();
  EXPECT_NEAR(moved->position.y, hand.position.y - 0.005, 1e-12);
  EXPECT_GT(std::fabs(moved->position.z - hand.position.z), 1e-6) << "it follows the wall";
  EXPECT_THAT(moved->reason, HasSubstr("by hand"));
  // each rule refuses with its reason
  const patient::Port& camera = *patient.PortOf(patient::PortUse::kLaparoscope);
  const auto close =
      MovePort(patient, patient::PortUse::kLeftHand, camera.position.x - 0.01, camera.position.y);
  ASSERT_FALSE(close.ok());
  EXPECT_EQ(close.error().code, base::ErrorCode::kEditRefused);
  EXPECT_THAT(close.error().message, HasSubstr("another port"));
  const auto far = MovePort(patient, patient::PortUse::kLeftHand, hand.position.x, hand.position.y - 0.3);
  ASSERT_FALSE(far.ok());
  EXPECT_THAT(far.error().message, HasSubstr("more than 220 mm"));
  const auto high =
      MovePort(patient, patient::PortUse::kLeftHand, hand.position.x - 0.03, hand.position.y + 0.08);
  ASSERT_FALSE(high.ok());
  EXPECT_THAT(high.error().message, HasSubstr("ribs"));
  // where the present place breaks a rule, a better one is taken though it breaks it, too
  for (patient::Port& port : patient.ports) {
    if (port.use == patient::PortUse::kLeftHand) port.position.y -= 0.4;
  }
  EXPECT_TRUE(MovePort(patient, patient::PortUse::kLeftHand, hand.position.x, hand.position.y + 0.05).ok());
  EXPECT_FALSE(MovePort(patient, patient::PortUse::kLeftHand, hand.position.x, hand.position.y - 0.05).ok());
}

TEST_F(NeighboursFromLabels, ABuildThatIsStoppedWritesNothing) {
  LabelOptions options;
  options.labels = folder_ / "map.nii";
  options.output = folder_ / "patient";
  options.spacing_mm = 2.0;
  ASSERT_TRUE(host::WriteFile(options.labels, TrunkMap().Nifti()).ok());
  std::stop_source stop;
  options.stop = stop.get_token();
  const auto report = BuildPatientFromLabels(options, [&](std::string_view what, double) {
    if (what.starts_with("meshing")) stop.request_stop();
  });
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.error().code, base::ErrorCode::kCancelled);
  EXPECT_FALSE(fs::exists(options.output));
}

TEST_F(NeighboursFromLabels, WithoutABodyPortsAreTheUsualOnesAndSayThat) {
  TrunkMap body;
  for (int label = 0; label < 128; ++label) {
    if (label != kTotalLiver && label != kTotalGallbladder) body.Rename(label, 0);
  }
  body.Rename(kTotalLiver, 1), body.Rename(kTotalGallbladder, 2);
  const BuildReport report = Build(body);
  const math::Vec3 fundus = report.patient.LandmarkOf(roles::LandmarkRole::kFundus)->position;
  EXPECT_NEAR(math::Distance(fundus, {-0.075, 0.095, -0.070}), 0, 1e-9);
  // the usual ports are the operation's
  const auto scene = host::JsonDocument::Read(fs::path(TROCAR_SOURCE_DIR) / "scenes/cholecystectomy.json");
  ASSERT_TRUE(scene.ok());
  const host::JsonView root = scene->Root(), instruments = root.Object("instruments");
  const std::map<patient::PortUse, host::JsonView> usual = {
      {patient::PortUse::kLaparoscope, root.Object("laparoscope")},
      {patient::PortUse::kLeftHand, instruments.Object("left")},
      {patient::PortUse::kRightHand, instruments.Object("right")},
      {patient::PortUse::kAssistant, root.Object("operation").Object("assistant")}};
  for (const auto& [use, view] : usual) {
    const auto mm = view.Numbers("port_mm", 3, {-3000, 3000});
    EXPECT_NEAR(math::Distance(report.patient.PortOf(use)->position, 0.001 * math::Vec3{mm[0], mm[1], mm[2]}),
                0, 1e-9)
        << NameOf(use);
  }
  EXPECT_THAT(report.patient.PortOf(patient::PortUse::kAssistant)->reason,
              HasSubstr("say nothing of this body's wall"));
  for (const patient::Neighbour& neighbour : report.patient.neighbours) EXPECT_FALSE(neighbour.is_seen);
}

TEST_F(NeighboursFromLabels, AreFoundByNamesAndByTheFirstVersionsNumbers) {
  TrunkMap named;
  named.Rename(kTotalStomach, 77), named.Rename(kTotalColon, 78);
  const BuildReport by_names = Build(
      named, R"({"Liver": 5, "Gall Bladder": 4, "Stomach": 77, "large bowel": 78, "Rib right 7": 110})");
  EXPECT_TRUE(by_names.patient.NeighbourOf(roles::NeighbourRole::kStomach)->is_seen);
  EXPECT_TRUE(by_names.patient.NeighbourOf(roles::NeighbourRole::kColon)->is_seen);
  ASSERT_NE(by_names.patient.NeighbourOf(roles::NeighbourRole::kRibs), nullptr);
  // a label without a name is nothing, whatever TotalSegmentator calls its number
  EXPECT_FALSE(by_names.patient.NeighbourOf(roles::NeighbourRole::kAorta)->is_seen);

  fs::remove_all(folder_ / "patient");
  TrunkMap first;
  first.Rename(kTotalColon, 57), first.Rename(kTotalDuodenum, 56), first.Rename(kTotalAorta, 7),
      first.Rename(kTotalCava, 8);
  first.Rename(kTotalL4, 19), first.Rename(kTotalL3, 20), first.Rename(kTotalL2, 21),
      first.Rename(kTotalRib, 76);
  const BuildReport by_numbers = Build(first);
  for (const roles::NeighbourRole role :
       {roles::NeighbourRole::kColon, roles::NeighbourRole::kDuodenum, roles::NeighbourRole::kAorta,
        roles::NeighbourRole::kVenaCava, roles::NeighbourRole::kSpine, roles::NeighbourRole::kRibs})
    EXPECT_TRUE(by_numbers.patient.NeighbourOf(role)->is_seen) << roles::NameOf(role);
  EXPECT_NEAR(
      1e6 * geometry::InspectMesh(by_numbers.patient.NeighbourOf(roles::NeighbourRole::kColon)->mesh).volume /
          first.VolumeOf(57),
      1.0, 0.02);
}

// What TotalSegmentator writes without --ml: a folder of masks.
TEST_F(NeighboursFromLabels, ComeFromAFolderOfMasks) {
  const TrunkMap body;
  fs::create_directories(folder_ / "masks");
  const std::map<std::string, int> masks = {
      {"liver", kTotalLiver},         {"gallbladder", kTotalGallbladder}, {"stomach", kTotalStomach},
      {"colon", kTotalColon},         {"vertebrae_L3", kTotalL3},         {"vertebrae_L4", kTotalL4},
      {"kidney_right", kTotalKidney}, {"lung_upper_lobe_left", kTotalRib}};
  for (const auto& [name, label] : masks) {
    TrunkMap mask = body;
    for (int other = 0; other < 128; ++other) {
      if (other != label) mask.Rename(other, 0);
    }
    ASSERT_TRUE(host::WriteFile(folder_ / "masks" / (name + ".nii"), mask.Nifti()).ok());
  }
  LabelOptions options;
  options.labels = folder_ / "masks";
  options.spacing_mm = 2.0;
  const auto report = BuildPatientFromLabels(options);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  for (const roles::NeighbourRole role : {roles::NeighbourRole::kStomach, roles::NeighbourRole::kColon,
                                          roles::NeighbourRole::kRightKidney, roles::NeighbourRole::kSpine})
    EXPECT_TRUE(report->patient.NeighbourOf(role)->is_seen) << roles::NameOf(role);
  EXPECT_FALSE(report->patient.NeighbourOf(roles::NeighbourRole::kDuodenum)->is_seen);
  EXPECT_THAT(report->patient.PortOf(patient::PortUse::kLaparoscope)->reason,
              HasSubstr("between the third and fourth lumbar vertebrae"));
}

// The way of every instrument to the gallbladder is free of bowel.
TEST_F(NeighboursFromLabels, BowelInTheWaySinksUnderTheGas) {
  TrunkMap body;
  // a loop of colon in front of the gallbladder, behind the wall
  body.Fill(kTotalColon, TrunkMap::Tube({70, 62, -90}, {-60, 62, -90}, 13));
  const BuildReport report = Build(body);
  const patient::Neighbour* colon = report.patient.NeighbourOf(roles::NeighbourRole::kColon);
  ASSERT_NE(colon, nullptr);
  bool is_said = false;
  for (const std::string& sentence : report.sinking)
    is_said = is_said || sentence.find("the colon sinks by up to") != std::string::npos;
  EXPECT_TRUE(is_said);
  const meshing::NearestSurface surface(colon->mesh);
  const math::Vec3 neck = report.patient.LandmarkOf(roles::LandmarkRole::kInfundibulum)->position;
  for (const patient::Port& port : report.patient.ports) {
    for (double t = 0.0; t < 0.8; t += 0.02) {
      const math::Vec3 p = math::Lerp(port.position, neck, t);
      EXPECT_FALSE(surface.IsInside(p)) << NameOf(port.use) << " " << t;
      EXPECT_GT(surface.Find(p).distance, 0.003) << NameOf(port.use) << " " << t;
    }
  }
  const auto inspected = geometry::InspectMesh(colon->mesh);
  EXPECT_NEAR(1e6 * inspected.volume / body.VolumeOf(kTotalColon), 1.0, 0.02);
  EXPECT_GE(inspected.min_angle * 180 / M_PI, 5.0);
}

// The one neighbour that the Visible Human's reference labels have: a branched tube of 8 mL, which becomes one mesh beside the others' templates.
TEST_F(NeighboursFromLabels, OfTheVisibleHumanHaveTheirVolume) {
  LabelOptions options;
  options.labels = fs::path(TROCAR_SHARED_DIR) / "data/visible-human-male/reference/labels.nii.gz";
  if (!fs::exists(options.labels)) GTEST_SKIP() << options.labels.parent_path() << " is not there";
  options.names = folder_ / "names.json";
  options.spacing_mm = 2.0;
  ASSERT_TRUE(host::WriteFile(options.names, R"({"liver": 1, "gallbladder": 2, "portal vein": 5})").ok());
  const auto report = BuildPatientFromLabels(options);
  ASSERT_TRUE(report.ok()) << report.error().Text();
  const patient::Neighbour* vein = report->patient.NeighbourOf(roles::NeighbourRole::kPortalVein);
  ASSERT_NE(vein, nullptr);
  EXPECT_TRUE(vein->is_seen);
  const NeighbourReport& told = report->neighbours.front();
  EXPECT_EQ(told.name, vein->name);
  EXPECT_NEAR(told.volume_ml / told.voxels_ml, 1.0, 0.02);
  EXPECT_LT(told.left_out_ml, 0.1 * told.voxels_ml);
  for (const auto& finding : LintPatient(report->patient).findings) ADD_FAILURE() << finding.code;
}

TEST(PatientSurroundings, AreLeftOutOfAFileThatHasNone) {
  const patient::Patient patient =
      *files::ReadPatient(fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient");
  const test::TemporaryFolder temporary;
  const fs::path folder = temporary.Path() / "patient";
  ASSERT_TRUE(files::WritePatient(folder, patient).ok());
  const auto text = host::ReadFile(folder / "patient.json");
  for (const char* key : {"\"neighbours\"", "\"ports\"", "\"table\""})
    EXPECT_EQ(text->find(key), std::string::npos) << key;
}

TEST(PatientSurroundings, ThatAreInconsistentAreRefused) {
  patient::Patient patient =
      *files::ReadPatient(fs::path(TROCAR_SOURCE_DIR) / "assets/patients/visible-human-male/patient");
  const auto why = [&] { return patient::CheckPatient(patient).error().message; };
  patient.ports = {{patient::PortUse::kAssistant, {}, "a"}, {patient::PortUse::kAssistant, {0.1, 0, 0}, "b"}};
  EXPECT_THAT(why(), HasSubstr("two ports for assistant"));
  patient.ports.clear();
  patient.table = patient::Table{1.0, 0.0, "steep"};
  EXPECT_THAT(why(), HasSubstr("more than 30 degrees"));
  patient.table.reset();
  patient.neighbours = {{"stomach", patient.organs[0].mesh}, {"belly", patient.organs[0].mesh}};
  EXPECT_TRUE(patient::CheckPatient(patient).ok());
  patient.neighbours[1].role = roles::NeighbourRole::kStomach;
  EXPECT_THAT(why(), HasSubstr("role stomach"));
  patient.neighbours = {{patient.organs[0].name, patient.organs[0].mesh}};
  EXPECT_THAT(why(), HasSubstr("used twice"));
  patient.neighbours = {{"stomach", patient.organs[0].mesh}};
  patient.neighbours[0].mesh.triangles.pop_back();
  EXPECT_EQ(patient::CheckPatient(patient).error().code, base::ErrorCode::kMeshNotClosed);
}

}  // namespace
}  // namespace trocar::anatomy
