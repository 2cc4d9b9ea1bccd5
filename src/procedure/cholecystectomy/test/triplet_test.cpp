// SPDX-License-Identifier: Apache-2.0
#include "trocar/cholecystectomy/triplet.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace trocar::cholecystectomy {
namespace {

using enum InstrumentKind;

TEST(Triplet, NamesAreThoseOfTheDataSets) {
  EXPECT_EQ(NameOf(Triplet{kHook, Verb::kDissect, Target::kCysticPlate}), "hook,dissect,cystic_plate");
  EXPECT_EQ(NameOf(Triplet{}), "grasper,null_verb,null_target");
  std::set<std::string_view> names;
  for (int i = 0; i < static_cast<int>(Target::kCount); ++i) names.insert(NameOf(static_cast<Target>(i)));
  for (int i = 0; i < static_cast<int>(Verb::kCount); ++i) names.insert(NameOf(static_cast<Verb>(i)));
  EXPECT_EQ(names.size(), 25u);
  EXPECT_EQ(names.count(""), 0u);
}

}  // namespace
}  // namespace trocar::cholecystectomy
