// SPDX-License-Identifier: Apache-2.0
// What holds of every procedure: a new one is tested by its place in the list.
#include "trocar/procedures/find_procedure.h"

#include <gtest/gtest.h>

#include <set>

namespace trocar::procedures {
namespace {

TEST(Procedures, AreFoundByNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const scene::Procedure* procedure : ListProcedures()) {
    EXPECT_TRUE(names.insert(procedure->name).second) << procedure->name;
    EXPECT_EQ(FindProcedure(procedure->name), procedure);
  }
  EXPECT_NE(FindProcedure(kUsualProcedure), nullptr);
  EXPECT_NE(FindProcedure(kTissueTask), nullptr);
  EXPECT_EQ(FindProcedure("whipple"), nullptr);
}

// Scenes of before procedures had names keep their fingerprints; every later procedure has one of its own.
TEST(Procedures, AreToldApartByTheirFingerprints) {
  std::set<std::string_view> fingerprints;
  for (const scene::Procedure* procedure : ListProcedures()) {
    const bool is_first = procedure->name == kUsualProcedure || procedure->name == kTissueTask;
    EXPECT_EQ(procedure->fingerprint.empty(), is_first) << procedure->name;
    if (is_first) continue;
    EXPECT_TRUE(fingerprints.insert(procedure->fingerprint).second) << procedure->name;
  }
}

template <typename Rows, typename Name>
void ExpectDifferent(const scene::Procedure& procedure, const Rows& rows, const Name& name_of) {
  std::set<std::string_view> names;
  for (const auto& row : rows) {
    EXPECT_FALSE(name_of(row).empty()) << procedure.name;
    EXPECT_TRUE(names.insert(name_of(row)).second) << procedure.name << ": " << name_of(row);
  }
}

TEST(Procedures, HaveTablesWhoseRowsAreToldApart) {
  const auto self = [](std::string_view name) { return name; };
  for (const scene::Procedure* procedure : ListProcedures()) {
    ASSERT_NE(procedure->make_judge, nullptr) << procedure->name;
    EXPECT_FALSE(procedure->phases.empty()) << procedure->name;
    EXPECT_LE(procedure->phases.size(), 255u) << "a snapshot holds its number in a byte";
    EXPECT_LE(procedure->errors.size(), 255u) << "so does a state";
    ExpectDifferent(*procedure, procedure->phases, [](const scene::PhaseRow& row) { return row.name; });
    ExpectDifferent(*procedure, procedure->phases, [](const scene::PhaseRow& row) { return row.about; });
    ExpectDifferent(*procedure, procedure->criteria, self);
    ExpectDifferent(*procedure, procedure->sights, self);
    ExpectDifferent(*procedure, procedure->measures, [](const scene::MeasureRow& row) { return row.name; });
    ExpectDifferent(*procedure, procedure->measures,
                    [](const scene::MeasureRow& row) { return row.short_name; });
    ExpectDifferent(*procedure, procedure->errors, [](const surgery::ErrorRow& row) { return row.name; });
    ExpectDifferent(*procedure, procedure->errors,
                    [](const surgery::ErrorRow& row) { return row.explanation; });
    ExpectDifferent(*procedure, procedure->parts, [](const scene::PartRow& row) { return row.name; });
  }
}

TEST(Procedures, BeginWithTheStartAndReachNothingElseByThemselves) {
  for (const scene::Procedure* procedure : ListProcedures()) {
    scene::ProcedureSnapshot now;
    scene::SizeSnapshot(*procedure, now);
    for (double& measure : now.measures) measure = 0.5;
    ASSERT_FALSE(procedure->parts.empty()) << procedure->name;
    for (std::size_t i = 0; i < procedure->parts.size(); ++i)
      EXPECT_EQ(procedure->parts[i].is_reached(now, {}), i == 0) << procedure->parts[i].name;
  }
}

}  // namespace
}  // namespace trocar::procedures
