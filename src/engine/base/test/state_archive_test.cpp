// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/state_archive.h"

#include <gtest/gtest.h>

#include <map>

namespace trocar::base {
namespace {

enum class Colour : std::uint8_t { kRed, kBlue };

struct Leaf {
  double weight = 0;
  Colour colour = Colour::kRed;
  void VisitState(StateArchive& archive) {
    archive.Field("weight", weight);
    archive.Field("colour", colour);
  }
  friend bool operator==(const Leaf&, const Leaf&) = default;
};

struct Tree {
  std::uint64_t age = 0;
  std::vector<double> rings;
  std::vector<Leaf> leaves;
  std::array<Leaf, 2> buds;
  std::optional<Leaf> fruit;
  std::string name;
  friend bool operator==(const Tree&, const Tree&) = default;
};

void VisitState(StateArchive& archive, Tree& tree) {
  archive.Field("age", tree.age);
  archive.Field("rings", tree.rings);
  archive.Field("leaves", tree.leaves);
  archive.Field("buds", tree.buds);
  archive.Field("fruit", tree.fruit);
  archive.Field("name", tree.name);
}

Tree MakeTree() {
  return {7,    {1.5, -0.0, 3.25}, {{0.1, Colour::kBlue}, {0.2}}, {{{0.3}, {0.4, Colour::kBlue}}}, Leaf{0.5},
          "oak"};
}

std::vector<std::byte> Saved(const Tree& tree) {
  std::vector<std::byte> bytes;
  SaveState(tree, bytes);
  return bytes;
}

std::uint64_t HashOf(const Tree& tree) {
  StateHash hash;
  AddStateTo(hash, tree);
  return hash.Value();
}

TEST(StateArchive, RestoresWhatItSaved) {
  const Tree tree = MakeTree();
  const std::vector<std::byte> bytes = Saved(tree);
  Tree other{1, {9}, {}, {}, std::nullopt, "birch, which is longer"};
  StateArchive archive = StateArchive::ForRestore(bytes);
  archive.Field("state", other);
  EXPECT_TRUE(archive.ok()) << archive.Failure();
  EXPECT_TRUE(archive.IsAtEnd());
  EXPECT_EQ(other, tree);
  EXPECT_EQ(HashOf(other), HashOf(tree));
  EXPECT_EQ(Saved(other), bytes);
}

TEST(StateArchive, EveryFieldIsInTheHash) {
  const std::uint64_t hash = HashOf(MakeTree());
  std::vector<Tree> changed(9, MakeTree());
  changed[0].age = 8;
  changed[1].rings[1] = 0.0;  // minus zero is another state
  changed[2].rings.push_back(0.0);
  changed[3].leaves[1].colour = Colour::kBlue;
  changed[4].buds[0].weight = 0.31;
  changed[5].fruit.reset();
  changed[6].fruit->weight = 0.51;
  changed[7].name = "oaks";
  changed[8].leaves.pop_back();
  for (const Tree& tree : changed) EXPECT_NE(HashOf(tree), hash);
}

TEST(StateArchive, AnOmittedFieldKeepsItsValueAndTheRestIsRestored) {
  std::vector<std::string> paths;
  {
    StateHash hash;
    StateArchive archive = StateArchive::ForHash(hash);
    archive.Trace([&](const std::string& path, std::uint64_t) { paths.push_back(path); });
    Tree tree = MakeTree();
    archive.Field("state", tree);
  }
  EXPECT_EQ(paths.front(), "state/age");
  const Tree tree = MakeTree();
  const std::vector<std::byte> bytes = Saved(tree);
  StateArchive archive = StateArchive::ForRestore(bytes);
  archive.Omit("state/rings");
  Tree other;
  archive.Field("state", other);
  EXPECT_TRUE(archive.ok() && archive.IsAtEnd());
  EXPECT_TRUE(other.rings.empty());
  other.rings = tree.rings;
  EXPECT_EQ(other, tree);
}

TEST(StateArchive, TraceTellsWhichFieldDiffers) {
  const auto trace = [](Tree tree) {
    std::map<std::string, std::uint64_t> hashes;
    StateHash hash;
    StateArchive archive = StateArchive::ForHash(hash);
    archive.Trace([&](const std::string& path, std::uint64_t value) { hashes[path] = value; });
    archive.Field("state", tree);
    return hashes;
  };
  Tree other = MakeTree();
  other.name = "elm";
  const auto before = trace(MakeTree()), after = trace(other);
  for (const auto& [path, hash] : before) EXPECT_EQ(after.at(path) == hash, path != "state/name") << path;
}

TEST(StateArchive, RefusesEveryTruncation) {
  const std::vector<std::byte> bytes = Saved(MakeTree());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    StateArchive archive = StateArchive::ForRestore(std::span(bytes).first(size));
    Tree tree;
    archive.Field("state", tree);
    EXPECT_FALSE(archive.ok()) << size;
    EXPECT_NE(archive.Failure().find("state/"), std::string::npos);
  }
}

TEST(StateArchive, ACountThatCannotBeIsRefusedBeforeAnythingIsAllocated) {
  std::vector<std::byte> bytes = Saved(MakeTree());
  std::memset(bytes.data() + 8, 0xff, 8);  // of the rings
  StateArchive archive = StateArchive::ForRestore(bytes);
  Tree tree;
  archive.Field("state", tree);
  EXPECT_FALSE(archive.ok());
  EXPECT_TRUE(tree.rings.empty());
}

struct Grid {
  std::vector<double> heights;
  std::vector<std::vector<double>> rows;
  bool is_open = false;
};

void VisitState(StateArchive& archive, Grid& grid) {
  archive.FixedField("heights", grid.heights);
  archive.FixedField("rows", grid.rows);
  archive.Field("is_open", grid.is_open);
}

std::string RestoreGrid(const Grid& from, Grid& to) {
  std::vector<std::byte> bytes;
  SaveState(from, bytes);
  StateArchive archive = StateArchive::ForRestore(bytes);
  archive.Field("state", to);
  return archive.Failure();
}

TEST(StateArchive, AFieldOfFixedLengthIsRefusedWhereTheLengthIsAnother) {
  const Grid grid{{1, 2}, {{3}, {4, 5}}, true};
  Grid same{{0, 0}, {{0}, {0, 0}}, false};
  EXPECT_EQ(RestoreGrid(grid, same), "");
  EXPECT_EQ(same.heights, grid.heights);
  EXPECT_EQ(same.rows, grid.rows);
  EXPECT_TRUE(same.is_open);
  Grid longer{{0, 0, 0}, {{0}, {0, 0}}, false};
  EXPECT_EQ(RestoreGrid(grid, longer), "state/heights has 2 elements where the model has 3");
  EXPECT_EQ(longer.heights.size(), 3u);
  Grid ragged{{0, 0}, {{0}, {0}}, false};
  EXPECT_EQ(RestoreGrid(grid, ragged), "state/rows has 2 elements where the model has 1");
  EXPECT_FALSE(ragged.is_open) << "what follows is left as it is";
}

}  // namespace
}  // namespace trocar::base
