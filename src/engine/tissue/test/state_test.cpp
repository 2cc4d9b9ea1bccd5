// SPDX-License-Identifier: Apache-2.0
/// \file state_test.cpp  The state of the tissue is a value: saved at any tick and restored beside solvers made anew, it
/// goes on to the same bits; and of the fields that are saved none is there in vain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "test_systems.h"
#include "trocar/base/state_hash.h"
#include "trocar/math/state_fields.h"
#include "trocar/tissue/conservation.h"
#include "trocar/tissue/damage.h"
#include "trocar/tissue/equilibrium.h"
#include "trocar/tissue/state_guard.h"
#include "trocar_test/threads.h"

namespace trocar::tissue {

using math::Vec3;

namespace {

constexpr double kSacRadius = 0.015, kSeconds = 1.0 / 120;
constexpr std::uint32_t kTailNodes = 6, kSpareNodes = 4;
const Vec3 kCentre{0.02, 0.05, -0.1};

/// What happens in a run, by tick; kNever for what does not.
constexpr int kNever = 1 << 20;
struct Course {
  const char* name;
  SolverSettings solver;
  int ticks = 60;
  int grasped = 2;               ///< the jaw takes the sac's pole and moves on
  int strands_are_cut = kNever;  ///< all that hold the sac
  int perforated = kNever;
  int cut = kNever;                        ///< the tail comes off, and a node of the sac is parted
  int scaled = kNever, unscaled = kNever;  ///< the springs are stiffer between
  double scale = 1.3;
  bool scales_shape = false;  ///< the virtual springs instead
  std::set<int> bad;          ///< a node is thrown away after the solve
  bool tears = false;         ///< springs gather damage
};

struct System {
  TissueDefinition definition;
  ClosedOrgan sac;
  std::uint32_t first_tail = 0, first_spare = 0;
};

/// A sac that strands hold to fixed nodes, with a tail of springs, and spare nodes.
System MakeSystem(bool tears) {
  const auto mesh = geometry::MakeSphere(kCentre, kSacRadius, 2);
  System system{MakeMembrane(mesh, 510.0, 3e3), {}, 0, 0};
  TissueDefinition& definition = system.definition;
  const auto n = static_cast<std::uint32_t>(definition.rest.size());
  system.sac = {0, n, mesh.triangles};
  if (tears)
    definition.laws.push_back({.stiffening = 8,
                               .stiffening_strain = 0.02,
                               .failure_strain = 0.3,
                               .damage_rate = 100.0,
                               .damage_exponent = 2.0});
  for (Spring& spring : definition.springs) spring.law = tears ? 1 : 0;
  const auto add_node = [&](const Vec3& rest, double mass, double shape) {
    definition.rest.push_back(rest), definition.mass.push_back(mass),
        definition.shape_stiffness.push_back(shape);
    return static_cast<std::uint32_t>(definition.rest.size() - 1);
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    if (mesh.positions[i].y < kCentre.y + 0.8 * kSacRadius) continue;
    const std::uint32_t anchor = add_node(mesh.positions[i] + Vec3{0, 0.001, 0}, 0, 0);
    definition.fixed.push_back(anchor);
    definition.strands.push_back({i, anchor, 30.0});
  }
  std::uint32_t last = 0;  // of the sac, lowest along y
  for (std::uint32_t i = 0; i < n; ++i) last = mesh.positions[i].y < mesh.positions[last].y ? i : last;
  const Vec3 lowest = mesh.positions[last];
  system.first_tail = static_cast<std::uint32_t>(definition.rest.size());
  for (std::uint32_t k = 0; k < kTailNodes; ++k) {
    const Vec3 rest = lowest + Vec3{0.001 * (k % 2), -0.002 * (k + 1), 0.0005 * k};
    const std::uint32_t node = add_node(rest, 2e-4, 0.05);
    definition.springs.push_back({last, node, 80.0, math::Distance(definition.rest[last], rest)});
    last = node;
  }
  system.first_spare = static_cast<std::uint32_t>(definition.rest.size());
  for (std::uint32_t k = 0; k < kSpareNodes; ++k)
    definition.fixed.push_back(add_node(definition.rest[0], 0, 0));
  return system;
}

/// A tissue as a simulation holds it.
class Tissue {
 public:
  Tissue(const Course& course, int threads)
      : course_(&course),
        threads_(threads),
        system_(MakeSystem(course.tears)),
        model_(MakeTissueModel(system_.definition)),
        state_(MakeRestState(model_)),
        conservation_(std::make_unique<Conservation>(model_, Settings())),
        conserved_(conservation_->MakeState(state_)),
        good_(conserved_),
        guard_(std::make_unique<StateGuard>(model_)),
        solver_(MakeSolver()) {
    conserved_.organs[0].target *= 1.1;
    good_ = conserved_;
  }
  // the parts point at the model
  Tissue(const Tissue&) = delete;
  Tissue& operator=(const Tissue&) = delete;

  int TickCount() const { return tick_; }

  void Tick() {
    ++tick_;
    Move();
    TissueLoad load{.gravity = {0.5, -1.0, 0.2}};
    const bool is_scaled = tick_ >= course_->scaled && tick_ < course_->unscaled;
    (course_->scales_shape ? load.shape_scale : load.stiffness_scale) = is_scaled ? course_->scale : 1.0;
    if (!guard_->IsFrozen()) {
      const SolveReport report =
          SolveConserving(*solver_, course_->solver, kSeconds, *conservation_, load, state_, conserved_);
      if (course_->bad.contains(tick_)) state_.position[5].x += 2.0;
      if (guard_->Check(state_, report.is_finite) == GuardVerdict::kGood) {
        good_ = conserved_;
      } else {
        static_cast<ConservationTick&>(conserved_) = good_;
      }
    }
    if (course_->tears) (void)TearSprings(model_, kSeconds, state_, {});
    if (tick_ == course_->strands_are_cut)
      std::fill(state_.strand_is_intact.begin(), state_.strand_is_intact.end(), 0);
    if (tick_ == course_->perforated) conservation_->Perforate(0, 2e-6, conserved_);
    if (tick_ == course_->cut) Cut();
  }

  /// What an onlooker sees: the outcome, not what is remembered.
  std::uint64_t OutcomeHash() const {
    base::StateHash hash;
    for (const Vec3& p : state_.position) hash.Add(p.x), hash.Add(p.y), hash.Add(p.z);
    hash.Add(conserved_.organs[0].leaked);
    hash.Add(conserved_.organs[0].pressure);
    return hash.Value();
  }
  std::uint64_t Hash() {
    base::StateHash hash;
    base::StateArchive archive = base::StateArchive::ForHash(hash);
    Visit(archive);
    return hash.Value();
  }
  std::vector<std::byte> Save() {
    std::vector<std::byte> bytes;
    base::StateArchive archive = base::StateArchive::ForSave(bytes);
    Visit(archive);
    return bytes;
  }
  std::vector<std::string> FieldPaths() {
    std::vector<std::string> paths;
    base::StateHash hash;
    base::StateArchive archive = base::StateArchive::ForHash(hash);
    archive.Trace([&](const std::string& path, std::uint64_t) { paths.push_back(path); });
    Visit(archive);
    return paths;
  }
  /// Into one that has not ticked. \return what was wrong with the bytes
  std::string Restore(std::span<const std::byte> bytes, int tick, bool follows,
                      const std::string& omitted = {}) {
    base::StateArchive archive = base::StateArchive::ForRestore(bytes);
    archive.Omit(omitted);
    archive.Field("definition", system_.definition);
    if (!archive.ok()) return archive.Failure();
    tick_ = tick;
    model_ = MakeTissueModel(system_.definition);
    state_ = MakeRestState(model_);
    if (follows) {
      FollowTopology();
    } else {
      conservation_ = std::make_unique<Conservation>(model_, Settings());
      conserved_ = conservation_->MakeState(state_);
      good_ = conserved_;
      guard_ = std::make_unique<StateGuard>(model_);
      solver_ = MakeSolver();
    }
    VisitTick(archive);
    if (archive.ok() && !archive.IsAtEnd()) return "left something";
    return archive.Failure();
  }

 private:
  ConservationSettings Settings() const {
    ConservationSettings settings;
    settings.organs = {system_.sac};
    settings.imaging_gravity = {0, 0, -9.81};
    return settings;
  }
  std::unique_ptr<EquilibriumSolver> MakeSolver() const {
    return std::make_unique<EquilibriumSolver>(
        model_, SolverOptions{.threads = test::UseThreads(threads_), .spare_share = 0.5});
  }
  void Visit(base::StateArchive& archive) {
    archive.Field("definition", system_.definition);
    VisitTick(archive);
  }
  void VisitTick(base::StateArchive& archive) {
    archive.Field("tissue", state_);
    archive.Field("conserved", conserved_);
    archive.Field("good", good_);
    archive.Field("guard", *guard_);
  }
  void FollowTopology() {
    solver_->UpdateTopology(model_);
    conservation_->UpdateTopology(model_, {system_.sac}, conserved_);
    guard_->UpdateTopology(model_, state_);
  }
  /// The jaw takes the pole below and the tail's end, and goes on with them.
  void Move() {
    const double way = 4e-4 * std::max(0, tick_ - course_->grasped);
    const math::Pose X{math::RotationAbout({1, 0, 0}, 20.0 * way), way * Vec3{0.5, -0.3, 1.0}};
    for (std::uint32_t i = 0; i < system_.first_spare; ++i) {
      const bool is_tail_end = i + 1 == system_.first_spare;
      const bool is_pole = i < system_.sac.node_count && kCentre.z + 0.9 * kSacRadius < model_.rest[i].z;
      if (!is_pole && !is_tail_end) continue;
      if (tick_ == course_->grasped) state_.condition[i] = NodeCondition::kPrescribed;
      if (state_.condition[i] != NodeCondition::kPrescribed) continue;
      const Vec3 arm = model_.rest[i] - kCentre;
      state_.position[i] = kCentre + math::Rotate(X.rotation, arm) + X.translation;
    }
  }
  /// The tail's spring to the sac goes, and another; a node of the sac is parted in two that share its springs.
  void Cut() {
    TissueDefinition& definition = system_.definition;
    const std::uint32_t twin = system_.first_spare, node = 20;
    std::vector<double> factor, damage;
    std::vector<Spring> springs;
    bool takes = false;
    for (std::size_t i = 0; i < definition.springs.size(); ++i) {
      Spring spring = definition.springs[i];
      const bool is_tails = std::max(spring.a, spring.b) == system_.first_tail;
      if (is_tails || i == 0) continue;
      if ((spring.a == node || spring.b == node) && (takes = !takes))
        (spring.a == node ? spring.a : spring.b) = twin;
      springs.push_back(spring);
      factor.push_back(state_.spring_factor[i]), damage.push_back(state_.spring_damage[i]);
    }
    springs.push_back({node, twin, 3.0, 1e-4, springs.front().law});
    factor.push_back(1.0), damage.push_back(0.0);
    definition.springs = springs;
    definition.rest[twin] = definition.rest[node] + Vec3{1e-4, 0, 0};
    definition.mass[twin] = definition.mass[node] *= 0.5;
    definition.shape_stiffness[twin] = definition.shape_stiffness[node] *= 0.5;
    std::erase(definition.fixed, twin);
    model_ = MakeTissueModel(definition);
    state_.spring_factor = factor, state_.spring_damage = damage;
    state_.condition[twin] = NodeCondition::kFree;
    state_.position[twin] = state_.position[node] + Vec3{1e-4, 0, 0};
    FollowTopology();
  }

  const Course* course_;
  int threads_, tick_ = 0;
  System system_;
  TissueModel model_;
  TissueState state_;
  std::unique_ptr<Conservation> conservation_;
  ConservationState conserved_;
  ConservationTick good_;
  std::unique_ptr<StateGuard> guard_;
  std::unique_ptr<EquilibriumSolver> solver_;
};

SolverSettings Newton(int max_linear_total = 100000) {
  SolverSettings settings;
  settings.kind = SolverKind::kNewtonMultigrid;
  settings.newton.max_linear_total = max_linear_total;
  return settings;
}

std::vector<Course> Courses() {
  std::vector<Course> courses{
      {.name = "cut free", .solver = Newton(), .strands_are_cut = 20, .perforated = 30, .cut = 15},
      {.name = "cut, and no strand gone", .solver = Newton(), .ticks = 40, .cut = 15},
      {.name = "in a hurry", .solver = Newton(3), .ticks = 70, .strands_are_cut = 20, .cut = 15},
      {.name = "stiffer for a while", .solver = Newton(), .scaled = 20, .unscaled = 40},
      {.name = "firmer for a while",
       .solver = Newton(),
       .scaled = 20,
       .unscaled = 30,
       .scale = 2000,
       .scales_shape = true},
      {.name = "gone wrong after the cut", .solver = Newton(), .ticks = 30, .cut = 15, .bad = {16}},
      {.name = "gone wrong in a hurry", .solver = Newton(4), .ticks = 30, .bad = {20}},
      {.name = "torn", .solver = Newton(), .strands_are_cut = 25, .cut = 18, .tears = true},
      {.name = "gone wrong",
       .solver = Newton(),
       .strands_are_cut = 10,
       .perforated = 16,
       .cut = 14,
       .bad = {19, 24, 25, 30, 40, 41, 42}}};
  for (const SolverKind kind : kSolverKinds) {
    if (kind == SolverKind::kNewtonMultigrid) continue;
    SolverSettings settings;
    settings.kind = kind;
    courses.push_back({.name = SolverName(kind).data(),
                       .solver = settings,
                       .ticks = 40,
                       .strands_are_cut = 16,
                       .perforated = 18,
                       .cut = 12,
                       .bad = {25},
                       .tears = true});
  }
  return courses;
}

/// The run of a course: outcome and whole state after each tick, and the bytes.
struct Recorded {
  std::vector<std::uint64_t> outcomes, hashes;
  std::vector<std::vector<std::byte>> bytes;
};
Recorded RunWhole(const Course& course) {
  Recorded run;
  Tissue tissue(course, 1);
  for (int tick = 0; tick <= course.ticks; ++tick) {
    if (tick > 0) tissue.Tick();
    run.outcomes.push_back(tissue.OutcomeHash());
    run.hashes.push_back(tissue.Hash());
    run.bytes.push_back(tissue.Save());
  }
  return run;
}

TEST(TissueState, GoesOnFromAnyTickInSolversMadeAnew) {
  std::mt19937 random(21);
  for (const Course& course : Courses()) {
    SCOPED_TRACE(course.name);
    const Recorded run = RunWhole(course);
    std::set<int> saves{course.cut, course.strands_are_cut, course.strands_are_cut + 1, course.perforated};
    for (int more = 0; more < 4; ++more)
      saves.insert(static_cast<int>(random() % static_cast<unsigned>(course.ticks)));
    for (const int at : saves) {
      if (at >= course.ticks) continue;
      for (const bool follows : {false, true}) {
        SCOPED_TRACE("tick " + std::to_string(at) + (follows ? ", following" : ", made anew"));
        Tissue tissue(course, 2);
        ASSERT_EQ(tissue.Restore(run.bytes[static_cast<std::size_t>(at)], at, follows), "");
        ASSERT_EQ(tissue.Hash(), run.hashes[static_cast<std::size_t>(at)]);
        while (tissue.TickCount() < course.ticks) {
          tissue.Tick();
          ASSERT_EQ(tissue.Hash(), run.hashes[static_cast<std::size_t>(tissue.TickCount())])
              << tissue.TickCount();
        }
      }
    }
  }
}

// Control: each field, left out, shows in what becomes of the tissue, in some course from some tick.
TEST(TissueState, NoFieldIsSavedInVain) {
  constexpr int kTicksAfter = 30;
  std::set<std::string> open;
  for (const Course& course : Courses()) {
    if (course.solver.kind != SolverKind::kNewtonMultigrid) continue;
    const Recorded run = RunWhole(course);
    if (open.empty()) {
      for (const std::string& path : Tissue(course, 1).FieldPaths()) open.insert(path);
      ASSERT_GT(open.size(), 25u);
    }
    std::set<int> saves{course.ticks / 2};
    for (const int event :
         {course.cut, course.strands_are_cut, course.perforated, course.scaled, course.unscaled}) {
      for (const int at : {event - 1, event, event + 1}) saves.insert(at);
    }
    for (const int bad : course.bad) saves.insert({bad - 1, bad});
    for (const int at : saves) {
      if (at < 0 || at >= course.ticks) continue;
      std::erase_if(open, [&](const std::string& path) {
        Tissue tissue(course, 1);
        // what cannot be put together without the field is told apart, too
        if (!tissue.Restore(run.bytes[static_cast<std::size_t>(at)], at, false, path).empty()) return true;
        while (tissue.TickCount() < std::min(course.ticks, at + kTicksAfter)) {
          tissue.Tick();
          if (tissue.OutcomeHash() != run.outcomes[static_cast<std::size_t>(tissue.TickCount())]) return true;
        }
        return false;
      });
      if (open.empty()) return;
    }
  }
  for (const std::string& path : open) ADD_FAILURE() << path << " decides nothing";
}

TEST(TissueState, RefusesBytesOfAnotherModelAndOfNone) {
  const Course course{.name = "cut", .solver = Newton(), .cut = 3};
  Tissue tissue(course, 1);
  for (int tick = 0; tick < 5; ++tick) tissue.Tick();
  const std::vector<std::byte> bytes = tissue.Save();
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 50) {
    Tissue other(course, 1);
    EXPECT_NE(other.Restore(std::span(bytes).first(size), 5, false), "") << size;
  }
  const TissueModel small = MakeTissueModel(MakeHangingSpring(20, 0.1, 0.05));
  TissueState large = MakeRestState(small), state = large;
  large.position.push_back({});
  std::vector<std::byte> wrong;
  base::SaveState(large, wrong);
  base::StateArchive archive = base::StateArchive::ForRestore(wrong);
  archive.Field("state", state);
  EXPECT_EQ(archive.Failure(), "state/position has 3 elements where the model has 2");
  EXPECT_EQ(state.position.size(), 2u);

  // springs that no model can have
  const TissueDefinition whole = MakeHangingSpring(20, 0.1, 0.05);
  std::vector<TissueDefinition> broken(6, whole);
  broken[0].springs[0].a = 2;
  broken[1].springs[0].stiffness = -1;
  broken[2].springs[0].rest_length = std::numeric_limits<double>::infinity();
  broken[3].springs[0].law = 1;
  broken[4].fixed[0] = 2;
  broken[5].rest[0].x = std::nan("");
  for (TissueDefinition& definition : broken) {
    std::vector<std::byte> saved;
    base::SaveState(definition, saved);
    base::StateArchive reads = base::StateArchive::ForRestore(saved);
    TissueDefinition read = whole;
    reads.Field("state", read);
    EXPECT_FALSE(reads.ok());
  }
}

}  // namespace
}  // namespace trocar::tissue
