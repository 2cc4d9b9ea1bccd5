// SPDX-License-Identifier: Apache-2.0
#include "trocar/scene/scene_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "trocar/base/state_hash.h"
#include "trocar/files/find_scene.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"

namespace trocar::scene {
namespace {

/// Changes the value of one number among all that it meets; the others stay.
class Changer {
 public:
  explicit Changer(std::size_t which) : which_(which) {}

  template <typename T>
  void Value(T& value) {
    if (met_++ != which_) return;
    if constexpr (std::is_same_v<T, std::string>) {
      value += 'x';
    } else if constexpr (std::is_same_v<T, bool>) {
      value = !value;
    } else if constexpr (std::is_floating_point_v<T>) {
      // the last bit is enough
      value = std::isfinite(value) ? std::nextafter(value, std::numeric_limits<T>::max()) : T{1};
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(static_cast<std::underlying_type_t<T>>(value) ^ 1);
    } else {
      value = static_cast<T>(value ^ 1);
    }
  }
  template <typename List>
  void Length(List& list) {
    if (met_++ == which_) list.emplace_back();
  }
  template <typename Perhaps>
  void Presence(Perhaps& perhaps) {
    if (met_++ != which_) return;
    if (perhaps) {
      perhaps.reset();
    } else {
      perhaps.emplace();
    }
  }
  template <typename Either>
  void Choice(Either& either) {
    if (met_++ == which_) either = either.index() == 0 ? Either(std::string("x")) : Either(1.0);
  }

  std::size_t Met() const { return met_; }

 private:
  std::size_t which_, met_ = 0;
};

std::size_t CountValues(Scene scene) {
  Changer none(std::numeric_limits<std::size_t>::max());
  VisitFields(scene, none);
  return none.Met();
}

/// Meshes and long lists have the same fields over and over: each value up to a number, then ever wider apart.
std::size_t After(std::size_t which) {
  return which < 4000 ? which + 1 : which + which / 64;
}

void ExpectEachChangeIsNoticed(const Scene& scene) {
  const std::uint64_t fingerprint = CalcSceneFingerprint(scene);
  const std::size_t count = CountValues(scene);
  EXPECT_GT(count, 300u);
  std::size_t changed = 0;
  for (std::size_t which = 0; which < count; which = After(which)) {
    Scene other = scene;
    Changer change(which);
    VisitFields(other, change);
    ASSERT_NE(CalcSceneFingerprint(other), fingerprint)
        << "value " << which << " of " << count << " of " << scene.name;
    ++changed;
  }
  EXPECT_GT(changed, 300u);
}

TEST(SceneFields, AChangeOfAnyOneIsNoticedInATask) {
  for (const char* task : {"peg_transfer", "pattern_cut", "camera_navigation_30"}) {
    auto scene = files::FindScene(task);
    ASSERT_TRUE(scene.ok()) << scene.error().Text();
    ExpectEachChangeIsNoticed(*scene);
  }
}

// Without the meshes, whose values are many and alike; a generated patient's operation has every other kind of field.
TEST(SceneFields, AChangeOfAnyOneIsNoticedInAnOperation) {
  auto scene = files::FindScene("cholecystectomy");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  for (patient::Organ& organ : scene->patient.organs) {
    organ.mesh.positions.resize(5);
    organ.mesh.triangles.resize(5);
    for (patient::Region& region : organ.regions) region.vertices.resize(3);
  }
  scene->patient.attachments.resize(2);
  for (patient::Neighbour& neighbour : scene->patient.neighbours) {
    neighbour.mesh.positions.resize(2);
    neighbour.mesh.triangles.resize(2);
  }
  scene->patient.parameters = {{"gallbladder_volume", 31.0, "mL", "a test"},
                               {"insertion", std::string("lateral"), "", "a test"}};
  scene->patient.ports = {{patient::PortUse::kLeftHand, {0, 0.01, 0}, "a test"}};
  scene->patient.table = patient::Table{0.1, 0.2, "a test"};
  ExpectEachChangeIsNoticed(*scene);
}

// What is only told may be written anew: recordings go on to fit.
TEST(SceneFields, WordsForPersonsAreLeftOut) {
  auto scene = files::FindScene("clip_and_cut");
  ASSERT_TRUE(scene.ok()) << scene.error().Text();
  const std::uint64_t fingerprint = CalcSceneFingerprint(*scene);
  scene->task->about += " In other words.";
  scene->task->errors.front().about += " In other words.";
  scene->materials.front().source = "another publication";
  scene->patient.provenance = "another place";
  scene->patient_folder = "/another/folder";
  EXPECT_EQ(CalcSceneFingerprint(*scene), fingerprint);
  scene->task->errors.front().penalty += 1;
  EXPECT_NE(CalcSceneFingerprint(*scene), fingerprint) << "the control";
}

// A struct's fields are counted, not listed: what somebody adds is visited.
TEST(SceneFields, AFieldThatIsAddedIsVisited) {
  struct Before {
    double a = 1;
    std::vector<int> b;
    std::optional<std::string> c;
  };
  struct After {
    double a = 1;
    std::vector<int> b;
    std::optional<std::string> c;
    std::array<math::Vec3, 2> d;
  };
  static_assert(base::kFieldCount<Before> == 3 && base::kFieldCount<After> == 4);
  Changer before(100), after(100);
  Before old_values;
  struct After new_values;
  VisitFields(old_values, before);
  VisitFields(new_values, after);
  EXPECT_EQ(after.Met() - before.Met(), 6u);
}

}  // namespace
}  // namespace trocar::scene
