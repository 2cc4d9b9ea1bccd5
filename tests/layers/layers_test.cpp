// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "include_rules.h"
#include "trocar/host/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::layers {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const std::filesystem::path kRoot = TROCAR_SOURCE_DIR;

Rules ReadRules() {
  const auto text = host::ReadFile(kRoot / "tools/layers.txt");
  EXPECT_TRUE(text.ok()) << text.error().Text();
  auto rules = ParseRules(*text);
  EXPECT_TRUE(rules.ok()) << rules.error().Text();
  return *rules;
}

TEST(Layers, EveryIncludeOfTheSourceFollowsAnArrow) {
  for (const Breach& breach : FindBreaches(ReadRules(), kRoot / "src")) {
    ADD_FAILURE() << "src/" << breach.file << ":" << breach.line << ": " << breach.what
                  << "; tools/layers.txt says what a wing and a module may include";
  }
}

TEST(Layers, EveryIncludeOfThePythonPackageFollowsAnArrow) {
  int looked_at = 0;
  for (const Breach& breach :
       FindBreachesOfModule(ReadRules(), kRoot / "src", kRoot, "python", "learn", &looked_at)) {
    ADD_FAILURE() << breach.file << ":" << breach.line << ": " << breach.what;
  }
  EXPECT_GE(looked_at, 6);
}

// What the engine must not know: files, threads, clocks, logs, JSON, and others' libraries but Bullet behind rigid.
const std::vector<std::string> kSystem = {
    "fstream", "iostream",  "filesystem", "thread",    "mutex",    "condition_variable",
    "future",  "chrono",    "ctime",      "time.h",    "unistd.h", "fcntl.h",
    "dlfcn.h", "pthread.h", "sys/",       "nlohmann/", "spdlog/",  "fmt/",
    "tbb/",    "oneapi/",   "Eigen/",     "gtk/",      "png.h"};
// Each with its reason.
const std::map<std::string, std::string> kKnown = {
    {"scene/include/trocar/scene/scene.h",
     "filesystem"},                                  // the name of a patient's folder, which is not opened
    {"simulation/src/simulation_model.h", "mutex"},  // std::once_flag of what all simulations share
    {"tissue/src/workers.cpp", "thread"}};           // gives the processor away while it waits; starts none

TEST(Layers, TheEngineKnowsNoSystem) {
  std::set<std::string> met;
  for (const Breach& breach : FindIncludes(kSystem, kRoot / "src/engine")) {
    const auto known = kKnown.find(breach.file);
    if (known != kKnown.end() && known->second == breach.what) {
      met.insert(breach.file);
    } else {
      ADD_FAILURE() << "src/engine/" << breach.file << ":" << breach.line << ": includes " << breach.what
                    << ", which a program has to give";
    }
  }
  EXPECT_EQ(met.size(), kKnown.size()) << "an exception that is no more has to leave the list";
}

// What is owed is paid back: the list may get shorter, never longer.
TEST(Layers, NoMoreIsOwedThanBefore) {
  EXPECT_LE(ReadRules().debts.size(), 2u);
}

// The scripted surgeons see the published snapshot and the constant scene, never the simulation.
TEST(Layers, RestrictedFoldersIncludeOnlyWhatIsNamed) {
  const auto restrictions = ReadRules().restrictions;
  ASSERT_THAT(restrictions, Not(IsEmpty()));
  for (const Restriction& restriction : restrictions) {
    for (const Breach& breach : FindBreaches(restriction, kRoot / "src")) {
      ADD_FAILURE() << "src/" << breach.file << ":" << breach.line << ": " << breach.what
                    << "; tools/layers.txt says what the folder may include";
    }
    for (const std::string& name : restriction.seen)
      EXPECT_FALSE(name.ends_with("/simulation.h")) << "a surgeon must not hold a simulation";
  }
}

TEST(Layers, ReachEverythingUpTheList) {
  const Layers layers = ReadRules().modules;
  EXPECT_TRUE(layers.at("cli").contains("base"));
  EXPECT_TRUE(layers.at("surgery").contains("collision"));
  EXPECT_FALSE(layers.at("tissue").contains("collision"));
  EXPECT_FALSE(layers.at("base").contains("math"));
}

// GoogleTest's folder is one for all processes, and ctest runs many at a time.
TEST(Layers, NoTestWritesIntoASharedFolder) {
  for (const char* folder : {"src", "tests"}) {
    for (const Breach& breach : FindCalls("TempDir", kRoot / folder)) {
      ADD_FAILURE() << folder << "/" << breach.file << ":" << breach.line << ": " << breach.what
                    << "; use test::TemporaryFolder of trocar_test/temporary_folder.h";
    }
  }
}

// One name for each thing: a reader who meets scene::Vec3 and tissue::Vec3 has to look up whether they are one.
TEST(Layers, NoHeaderGivesANameOfAnotherNamespaceAsItsOwn) {
  for (const Breach& breach : FindReExports(kRoot / "src")) {
    ADD_FAILURE() << "src/" << breach.file << ":" << breach.line << ": " << breach.what
                  << "; a header names what it uses in full";
  }
}

// Negative control: the check finds what is planted.
class Planted : public testing::Test {
 protected:
  /// Debts of files that are not planted would be complained about.
  static Rules WithoutDebts() {
    Rules rules = ReadRules();
    rules.debts.clear();
    return rules;
  }
  std::vector<Breach> Find(const std::string& file, const std::string& text) {
    EXPECT_TRUE(host::WriteFile(folder_.Path() / file, text).ok());
    return FindBreaches(WithoutDebts(), folder_.Path());
  }

  const std::filesystem::path& Folder() const { return folder_.Path(); }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Planted, DownwardIncludeIsFound) {
  const auto breaches = Find("engine/tissue/src/spring.cpp", "// x\n#include \"trocar/surgery/grasp.h\"\n");
  ASSERT_THAT(breaches, SizeIs(1));
  EXPECT_EQ(breaches[0].file, "engine/tissue/src/spring.cpp");
  EXPECT_EQ(breaches[0].line, 2);
  EXPECT_THAT(breaches[0].what, HasSubstr("tissue must not see surgery"));
}

// The arrow between the modules is there, that between the wings is not.
TEST_F(Planted, IncludeThroughAWallIsFoundUnlessItIsOwed) {
  const std::string text = "#include \"trocar/anatomy/drawn.h\"\n";
  Find("imaging/anatomy/include/trocar/anatomy/drawn.h", "int x;\n");
  const auto breaches = Find("judge/assessment/src/a.cpp", text);
  ASSERT_THAT(breaches, SizeIs(1));
  EXPECT_THAT(breaches[0].what, HasSubstr("the wing judge must not see imaging"));
  Rules rules = WithoutDebts();
  rules.debts = {{"judge/assessment/src/a.cpp", "anatomy/drawn.h"}};
  EXPECT_THAT(FindBreaches(rules, Folder()), IsEmpty());
  Find("judge/assessment/src/a.cpp", "int x;\n");
  EXPECT_THAT(FindBreaches(rules, Folder()), SizeIs(1)) << "a debt that is paid has to leave the list";
}

TEST_F(Planted, TestsSeeWhatIsNamedForThemAndNothingElseDoes) {
  const std::string text = "#include \"trocar/files/scene_file.h\"\n";
  Find("platform/files/include/trocar/files/scene_file.h", "int x;\n");
  EXPECT_THAT(Find("engine/scene/test/a_test.cpp", text), IsEmpty());
  EXPECT_THAT(Find("engine/scene/src/a.cpp", text), SizeIs(1));
}

TEST_F(Planted, ModuleOutsideOfTheWingsIsLookedAtToo) {
  ASSERT_TRUE(host::WriteFile(Folder() / "python/src/a.cpp", "#include \"trocar/cli/run_command.h\"\n").ok());
  EXPECT_THAT(FindBreachesOfModule(ReadRules(), kRoot / "src", Folder(), "python", "learn"), SizeIs(1));
}

TEST_F(Planted, SidewaysIncludeIsFoundHoweverItIsWritten) {
  EXPECT_THAT(Find("engine/tissue/test/a_test.cpp", "  #  include <trocar/collision/queries.h>\n"),
              SizeIs(1));
}

TEST_F(Planted, WhatTheSystemHasIsFoundButNotInTests) {
  Find("engine/tissue/src/a.cpp", "#include <vector>\n#include <fstream>\n");
  Find("engine/tissue/src/b.h", "#include <sys/stat.h>\n");
  Find("engine/tissue/test/a_test.cpp", "#include <fstream>\n");
  EXPECT_THAT(FindIncludes(kSystem, Folder() / "engine"), SizeIs(2));
}

TEST_F(Planted, SharedFolderIsFound) {
  const std::string call = "TempDir";
  ASSERT_TRUE(host::WriteFile(Folder() / "engine/tissue/test/a_test.cpp",
                              "test::TemporaryFolder folder;\nfs::path b = testing::" + call + "();\n")
                  .ok());
  const auto breaches = FindCalls(call, Folder());
  ASSERT_THAT(breaches, SizeIs(1));
  EXPECT_EQ(breaches[0].line, 2);
}

TEST_F(Planted, ReExportIsFoundInHeadersAlone) {
  const std::string text =
      "namespace trocar::tissue {\nusing math::Vec3;\nstruct A : B {\n  using B::B;\n};\n}\n";
  Find("engine/tissue/src/a.cpp", text);
  Find("engine/tissue/src/a.h", text);
  const auto breaches = FindReExports(Folder());
  ASSERT_THAT(breaches, SizeIs(1));
  EXPECT_EQ(breaches[0].file, "engine/tissue/src/a.h");
  EXPECT_EQ(breaches[0].line, 2);
}

class PlantedInRestricted : public Planted {
 protected:
  std::vector<Breach> FindIn(const std::string& text) {
    Find("program/session/src/simulation_content.h", "int x;\n");
    Find("program/session/src/agent/plan.h", "int x;\n");
    EXPECT_TRUE(host::WriteFile(Folder() / "program/session/src/agent/a.cpp", text).ok());
    const auto rules =
        ParseRules("only program/session/src/agent : math session/snapshot.h tissue/rest_frame.h\n");
    return FindBreaches(rules->restrictions.front(), Folder());
  }
};

TEST_F(PlantedInRestricted, OnlyNamedHeadersAndOwnOnesPass) {
  EXPECT_THAT(FindIn("#include <vector>\n#include \"agent/plan.h\"\n#include \"trocar/math/pose.h\"\n"
                     "#include \"trocar/session/snapshot.h\"\n"),
              IsEmpty());
  EXPECT_THAT(FindIn("#include \"trocar/session/simulation.h\"\n"), SizeIs(1));
  EXPECT_THAT(FindIn("#include \"trocar/tissue/tissue_model.h\"\n"), SizeIs(1));
  EXPECT_THAT(FindIn("#include \"simulation_content.h\"\n"), SizeIs(1));
  EXPECT_THAT(FindIn("#include \"gone.h\"\n"), SizeIs(1));
}

TEST(ParseRules, RefusesAMalformedLineAndAnEmptyFolder) {
  EXPECT_FALSE(ParseRules("only agent snapshot.h\n").ok());
  const auto missing = ParseRules("only no_such_folder : math\n");
  EXPECT_THAT(FindBreaches(missing->restrictions.front(), kRoot / "src"), SizeIs(1));
}

TEST_F(Planted, UnknownModuleAndUnknownWingAreFound) {
  EXPECT_THAT(Find("picture/graphics/src/a.cpp", "int x;\n"), SizeIs(1));
  EXPECT_THAT(Find("attic/render/src/a.cpp", "int x;\n"), SizeIs(2));
}

TEST_F(Planted, LibraryInPublicHeaderIsFound) {
  EXPECT_THAT(Find("picture/render/include/trocar/render/a.h", "#include <epoxy/gl.h>\n"), SizeIs(1));
}

TEST_F(Planted, LibraryInPrivateFileIsAllowed) {
  EXPECT_THAT(
      Find("picture/render/src/a.cpp", "#include <epoxy/gl.h>\n#include \"trocar/geometry/tube.h\"\n"),
      IsEmpty());
}

TEST(ParseRules, RefusesACycleAndAMalformedLine) {
  EXPECT_FALSE(ParseRules("a -> b\nb -> a\n").ok());
  EXPECT_FALSE(ParseRules("wing a -> b\nwing b -> a\n").ok());
  EXPECT_FALSE(ParseRules("a b\n").ok());
  EXPECT_FALSE(ParseRules("a ->\na ->\n").ok());
  EXPECT_FALSE(ParseRules("a ->\ntests a : b\n").ok());
}

}  // namespace
}  // namespace trocar::layers
