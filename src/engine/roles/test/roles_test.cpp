// SPDX-License-Identifier: Apache-2.0
#include "trocar/roles/roles.h"

#include <gtest/gtest.h>

namespace trocar::roles {
namespace {

template <class Role>
void ExpectEveryNameLeadsBack(Role last) {
  ASSERT_EQ(std::size(RoleNames<Role>::kNames), static_cast<std::size_t>(last) + 1)
      << "a role without a name";
  for (std::size_t i = 0; i <= static_cast<std::size_t>(last); ++i) {
    const Role role = static_cast<Role>(i);
    EXPECT_EQ(FindRole<Role>(NameOf(role)), role);
    EXPECT_EQ(ConventionalRole<Role>(NameOf(role)), role);
  }
  EXPECT_FALSE(FindRole<Role>("spleen").has_value());
  EXPECT_EQ(ConventionalRole<Role>("spleen"), Role::kOther);
  EXPECT_EQ(ConventionalRole<Role>(""), Role::kOther);
}

TEST(Roles, EveryNameLeadsBackToItsRole) {
  ExpectEveryNameLeadsBack(OrganRole::kGallbladder);
  ExpectEveryNameLeadsBack(TubeRole::kRightHepaticArtery);
  ExpectEveryNameLeadsBack(RegionRole::kGallbladderBed);
  ExpectEveryNameLeadsBack(LandmarkRole::kHepatocysticTriangle);
  ExpectEveryNameLeadsBack(TissueRole::kArtery);
}

TEST(Roles, ASecondTubeOfAKindHasItsRole) {
  EXPECT_EQ(ConventionalRole<TubeRole>("cystic_artery_deep"), TubeRole::kCysticArtery);
  EXPECT_EQ(ConventionalRole<TubeRole>("cystic_duct_2"), TubeRole::kCysticDuct);
  EXPECT_EQ(ConventionalRole<TubeRole>("cystic_ductlet"), TubeRole::kOther);
  EXPECT_EQ(ConventionalRole<OrganRole>("liver_2"), OrganRole::kOther) << "organs are one of a kind";
}

TEST(Roles, AreSpoken) {
  EXPECT_EQ(SpokenName(TubeRole::kCommonBileDuct), "common bile duct");
  EXPECT_EQ(ListNames<OrganRole>(), "liver, gallbladder");
}

}  // namespace
}  // namespace trocar::roles
