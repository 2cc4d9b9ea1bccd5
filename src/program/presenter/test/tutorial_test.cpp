// SPDX-License-Identifier: Apache-2.0
#include "trocar/presenter/tutorial.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace trocar::presenter {
namespace {

/// A person before a simulation.
struct Person {
  simulation::Snapshot snapshot;
  scene::Input input;
  TutorialSight sight;

  Person() {
    for (auto& hand : input.hands) hand.depth = 0.1;
    sight.snapshot = &snapshot;
    sight.input = &input;
  }
};

/// What each step asks for, in frames.
std::vector<std::vector<std::function<void(Person&)>>> Lessons() {
  constexpr int kHand = instrument::kRight;
  return {{[](Person& p) { p.sight.is_pointer_taken = true; }},
          {[](Person& p) { p.input.hands[kHand].pan += 0.3; }},
          {[](Person& p) { p.input.hands[kHand].depth += 0.012; }},
          {[](Person& p) { p.input.hands[kHand].jaw = 0.7; }},
          {[](Person& p) { p.input.hands[kHand].jaw = 0.0; }},
          {[](Person& p) { p.input.hands[kHand].spin += 0.5; }},
          {[](Person& p) { p.sight.hand = device::kLeftHand; }},
          {[](Person& p) {
             p.sight.is_laparoscope_held = true;
             p.input.laparoscope.pan += 0.2;
           },
           [](Person& p) { p.sight.is_laparoscope_held = false; }},
          {[](Person& p) { p.snapshot.instruments[0].object = 1; },
           [](Person& p) { p.snapshot.instruments[0].object = -1; }},
          {[](Person& p) { p.sight.is_paused = true; }, [](Person& p) { p.sight.is_paused = false; }}};
}

TEST(Tutorial, GoesOnWhenEachControlWasUsed) {
  Person person;
  Tutorial tutorial;
  EXPECT_EQ(tutorial.Text(KeyBindings()), "");
  tutorial.Begin(0);
  const auto lessons = Lessons();
  ASSERT_EQ(lessons.size(), static_cast<std::size_t>(kTutorialSteps));
  for (int step = 0; step < kTutorialSteps; ++step) {
    EXPECT_EQ(tutorial.Step(), step);
    EXPECT_NE(tutorial.Text(KeyBindings()).find(std::to_string(step + 1) + " of 10"), std::string::npos);
    const auto& frames = lessons[static_cast<std::size_t>(step)];
    for (std::size_t frame = 0; frame < frames.size(); ++frame) {
      EXPECT_FALSE(tutorial.Observe(person.sight)) << step << ": nothing has been done yet";
      frames[frame](person);
    }
    EXPECT_TRUE(tutorial.Observe(person.sight)) << step;
  }
  EXPECT_TRUE(tutorial.IsDone());
  EXPECT_EQ(tutorial.Text(KeyBindings()).rfind("Done", 0), 0u);
  EXPECT_FALSE(tutorial.Observe(person.sight));
}

// What another step asks for does not pass this one.
TEST(Tutorial, IsNotPassedByAnotherControl) {
  const auto lessons = Lessons();
  for (int step = 0; step < kTutorialSteps; ++step) {
    for (int other = 0; other < kTutorialSteps; ++other) {
      // closing needs open jaws before; moving and looking are told apart by what is held
      if (other == step) continue;
      Person person;
      Tutorial tutorial;
      tutorial.Begin(step);
      tutorial.Observe(person.sight);
      const bool is_taken_already = step == 0 && person.sight.is_pointer_taken;
      if (is_taken_already) continue;
      for (const auto& frame : lessons[static_cast<std::size_t>(other)]) {
        frame(person);
        tutorial.Observe(person.sight);
      }
      EXPECT_EQ(tutorial.Step(), step) << "by " << other;
    }
  }
}

TEST(Tutorial, CanBeLeftAndResumed) {
  Person person;
  Tutorial tutorial;
  tutorial.Begin(4);
  EXPECT_NE(tutorial.Text(KeyBindings()).find("left mouse button"), std::string::npos);
  KeyBindings left_handed;
  left_handed.SetLayout(KeyLayout::kLeftHanded);
  EXPECT_NE(tutorial.Text(left_handed).find("right mouse button"), std::string::npos);
  tutorial.Leave();
  EXPECT_FALSE(tutorial.IsOn());
  EXPECT_FALSE(tutorial.Observe(person.sight));
  tutorial.Begin(tutorial.Step());
  EXPECT_EQ(tutorial.Step(), 4);
}

}  // namespace
}  // namespace trocar::presenter
