// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "include_rules.h"
#include "trocar/core/safe_file.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::layers {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

const std::filesystem::path kRoot = TROCAR_SOURCE_DIR;

Layers ReadLayers() {
  const auto text = core::ReadFile(kRoot / "tools/layers.txt");
  EXPECT_TRUE(text.ok()) << text.error().Text();
  auto layers = ParseLayers(*text);
  EXPECT_TRUE(layers.ok()) << layers.error().Text();
  return *layers;
}

TEST(Layers, EveryIncludeOfTheSourceFollowsAnArrow) {
  for (const Breach& breach : FindBreaches(ReadLayers(), kRoot / "src")) {
    ADD_FAILURE() << "src/" << breach.file << ":" << breach.line << ": " << breach.what
                  << "; tools/layers.txt says what a module may include";
  }
}

// bench/ stands beside src/: what measures is no part of what is measured.
TEST(Layers, EveryIncludeOfTheBenchmarksFollowsAnArrow) {
  int looked_at = 0;
  for (const Breach& breach : FindBreachesOfModule(ReadLayers(), kRoot, "bench", &looked_at)) {
    ADD_FAILURE() << breach.file << ":" << breach.line << ": " << breach.what;
  }
  EXPECT_GT(looked_at, 20);
}

TEST(Layers, EveryIncludeOfThePythonPackageFollowsAnArrow) {
  int looked_at = 0;
  for (const Breach& breach : FindBreachesOfModule(ReadLayers(), kRoot, "python", &looked_at)) {
    ADD_FAILURE() << breach.file << ":" << breach.line << ": " << breach.what;
  }
  EXPECT_GE(looked_at, 6);
}

std::vector<Restriction> ReadRestrictions() {
  const auto text = core::ReadFile(kRoot / "tools/layers.txt");
  EXPECT_TRUE(text.ok()) << text.error().Text();
  auto restrictions = ParseRestrictions(*text);
  EXPECT_TRUE(restrictions.ok()) << restrictions.error().Text();
  return *restrictions;
}

// The scripted surgeons see the published snapshot and the constant scene, never the simulation.
TEST(Layers, RestrictedFoldersIncludeOnlyWhatIsNamed) {
  const auto restrictions = ReadRestrictions();
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
  const Layers layers = ReadLayers();
  EXPECT_TRUE(layers.at("cli").contains("core"));
  EXPECT_TRUE(layers.at("surgery").contains("collision"));
  EXPECT_FALSE(layers.at("tissue").contains("collision"));
  EXPECT_FALSE(layers.at("core").contains("math"));
}

// GoogleTest's folder is one for all processes, and ctest runs many at a time.
TEST(Layers, NoTestWritesIntoASharedFolder) {
  for (const char* folder : {"src", "tests", "bench"}) {
    for (const Breach& breach : FindCalls("TempDir", kRoot / folder)) {
      ADD_FAILURE() << folder << "/" << breach.file << ":" << breach.line << ": " << breach.what
                    << "; use test::TemporaryFolder of trocar_test/temporary_folder.h";
    }
  }
}

// Negative control: the check finds what is planted.
class Planted : public testing::Test {
 protected:
  std::vector<Breach> Find(const std::string& file, const std::string& text) {
    EXPECT_TRUE(core::WriteFile(folder_.Path() / file, text).ok());
    return FindBreaches(ReadLayers(), folder_.Path());
  }

  const std::filesystem::path& Folder() const { return folder_.Path(); }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Planted, DownwardIncludeIsFound) {
  const auto breaches = Find("tissue/src/spring.cpp", "// x\n#include \"trocar/surgery/grasp.h\"\n");
  ASSERT_THAT(breaches, SizeIs(1));
  EXPECT_EQ(breaches[0].file, "tissue/src/spring.cpp");
  EXPECT_EQ(breaches[0].line, 2);
  EXPECT_THAT(breaches[0].what, HasSubstr("tissue must not see surgery"));
}

TEST_F(Planted, BenchmarksAreLookedAtToo) {
  ASSERT_TRUE(core::WriteFile(Folder() / "bench/src/a.cpp", "#include \"trocar/cli/run_command.h\"\n").ok());
  EXPECT_THAT(FindBreachesOfModule(ReadLayers(), Folder(), "bench"), SizeIs(1));
}

TEST_F(Planted, SidewaysIncludeIsFoundHoweverItIsWritten) {
  EXPECT_THAT(Find("tissue/test/a_test.cpp", "  #  include <trocar/collision/queries.h>\n"), SizeIs(1));
}

TEST_F(Planted, SharedFolderIsFound) {
  const std::string call = "TempDir";
  ASSERT_TRUE(core::WriteFile(Folder() / "tissue/test/a_test.cpp",
                              "test::TemporaryFolder folder;\nfs::path b = testing::" + call + "();\n")
                  .ok());
  const auto breaches = FindCalls(call, Folder());
  ASSERT_THAT(breaches, SizeIs(1));
  EXPECT_EQ(breaches[0].line, 2);
}

class PlantedInRestricted : public Planted {
 protected:
  std::vector<Breach> FindIn(const std::string& text) {
    Find("session/src/simulation_content.h", "int x;\n");
    Find("session/src/agent/plan.h", "int x;\n");
    EXPECT_TRUE(core::WriteFile(Folder() / "session/src/agent/a.cpp", text).ok());
    const auto restrictions =
        ParseRestrictions("only session/src/agent : math session/snapshot.h tissue/rest_frame.h\n");
    return FindBreaches(restrictions->front(), Folder());
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

TEST(ParseRestrictions, RefusesAMalformedLineAndAnEmptyFolder) {
  EXPECT_FALSE(ParseRestrictions("only agent snapshot.h\n").ok());
  const auto missing = ParseRestrictions("only no_such_folder : math\n");
  EXPECT_THAT(FindBreaches(missing->front(), kRoot / "src"), SizeIs(1));
}

TEST_F(Planted, UnknownModuleIsFound) {
  EXPECT_THAT(Find("graphics/src/a.cpp", "int x;\n"), SizeIs(1));
}

TEST_F(Planted, LibraryInPublicHeaderIsFound) {
  EXPECT_THAT(Find("render/include/trocar/render/a.h", "#include <epoxy/gl.h>\n"), SizeIs(1));
}

TEST_F(Planted, LibraryInPrivateFileIsAllowed) {
  EXPECT_THAT(Find("render/src/a.cpp", "#include <epoxy/gl.h>\n#include \"trocar/geometry/tube.h\"\n"),
              IsEmpty());
}

TEST(ParseLayers, RefusesACycleAndAMalformedLine) {
  EXPECT_FALSE(ParseLayers("a -> b\nb -> a\n").ok());
  EXPECT_FALSE(ParseLayers("a b\n").ok());
  EXPECT_FALSE(ParseLayers("a ->\na ->\n").ok());
}

}  // namespace
}  // namespace trocar::layers
