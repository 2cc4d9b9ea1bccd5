// SPDX-License-Identifier: Apache-2.0
// Which labels are liver, gallbladder and their neighbours: right, or asked for; never wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "label_evidence.h"
#include "label_schemes.h"
#include "label_sights.h"
#include "trocar/anatomy/patient_from_labels.h"

namespace trocar::anatomy {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr double kVoxelMm = 4.0;

/// A made-up trunk: what lies at a place (right, anterior, superior of the middle) [mm].
Structure StructureAt(double r, double a, double s) {
  struct Place {
    double r, a, s;
  };
  const auto ball = [&](Place c, Place radii) {
    return std::pow((r - c.r) / radii.r, 2) + std::pow((a - c.a) / radii.a, 2) +
               std::pow((s - c.s) / radii.s, 2) <=
           1;
  };
  const auto tube = [&](std::vector<Place> way, double radius) {
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
      const math::Vec3 p{r, a, s}, from{way[i].r, way[i].a, way[i].s},
          to{way[i + 1].r, way[i + 1].a, way[i + 1].s};
      const double t = std::clamp(math::Dot(p - from, to - from) / math::SquaredNorm(to - from), 0.0, 1.0);
      if (math::Distance(p, from + t * (to - from)) <= radius) return true;
    }
    return false;
  };
  using enum Structure;
  if (ball({42, 42, -52}, {15, 33, 15})) return kGallbladder;
  if (ball({58, -64, -62}, {27, 24, 52})) return kKidneyRight;
  if (ball({-62, -64, -40}, {27, 24, 52})) return kKidneyLeft;
  if (ball({-105, -40, 15}, {28, 40, 55})) return kSpleen;
  if (std::hypot(r + 12, a + 45) <= 10) return kAorta;
  if (std::hypot(r - 18, a + 40) <= 11) return kVenaCava;
  if (ball({34, -58, 2}, {6, 8, 14})) return kAdrenalRight;
  if (ball({-45, -55, 16}, {6, 8, 14})) return kAdrenalLeft;
  if (ball({62, 0, 0}, {62, 70, 70}) || ball({-15, 28, 25}, {78, 42, 32})) return kLiver;
  if (s > 40 && std::hypot(r + 5, a + 20) <= 8) return kEsophagus;
  if (ball({-60, 30, -20}, {45, 30, 40})) return kStomach;
  if (tube({{8, -8, -30}, {0, -10, -35}, {-70, -25, -15}}, 6)) return kPortalVein;
  if (tube({{6, 20, -52}, {24, -2, -58}, {26, -14, -95}, {-4, -22, -108}}, 10)) return kDuodenum;
  if (ball({-12, 0, -42}, {50, 14, 14})) return kPancreas;
  if (tube(
          {{82, 0, -160}, {88, 8, -112}, {55, 45, -118}, {-60, 45, -112}, {-105, -5, -70}, {-108, -15, -160}},
          17))
    return kColon;
  if (ball({0, 25, -150}, {68, 30, 32})) return kSmallBowel;
  if (ball({-25, 30, 100}, {45, 40, 42})) return kHeart;
  if (ball({75, -10, 120}, {62, 75, 75})) return kLungRight;
  if (ball({-80, -10, 120}, {60, 75, 75})) return kLungLeft;
  if (tube({{100, -75, 30}, {138, -5, 0}, {118, 70, -30}}, 6)) return kRibsRight;
  if (tube({{-104, -85, 30}, {-142, -5, 0}, {-122, 70, -30}}, 6)) return kRibsLeft;
  if (std::hypot(r - 2, a + 88) <= 19) {
    return s < -155 ? kSacrum : s < -125 ? kVertebraL4 : s < -93 ? kVertebraL3 : kVertebra;
  }
  if (ball({0, 45, -192}, {34, 28, 16})) return kBladder;
  return kUnknown;
}

/// The trunk as a map of structures.
const images::LabelVolume& Trunk() {
  static const images::LabelVolume trunk = [] {
    images::LabelVolume volume;
    volume.size = {80, 56, 94};
    // columns to the left, rows to posterior, slices to superior (LPS)
    volume.direction = {{{kVoxelMm, 0, 0}, {0, kVoxelMm, 0}, {0, 0, kVoxelMm}}};
    for (int k = 0; k < volume.size[2]; ++k) {
      for (int j = 0; j < volume.size[1]; ++j) {
        for (int i = 0; i < volume.size[0]; ++i) {
          volume.labels.push_back(static_cast<int>(
              StructureAt(kVoxelMm * (39.5 - i), kVoxelMm * (26.5 - j), kVoxelMm * (k - 50.5))));
        }
      }
    }
    return volume;
  }();
  return trunk;
}

/// The number that a map has for each structure; what is not in it is left out.
using Numbers = std::map<Structure, int>;

Numbers NumbersOf(const LabelScheme& scheme) {
  Numbers numbers;
  for (const auto& [label, structure] : scheme.numbers) {
    if (structure != Structure::kOther) numbers.emplace(structure, label);
  }
  return numbers;
}

images::LabelVolume Numbered(const Numbers& numbers) {
  images::LabelVolume volume = Trunk();
  for (std::int32_t& label : volume.labels) {
    const auto found = numbers.find(static_cast<Structure>(label));
    label = found == numbers.end() ? 0 : found->second;
  }
  return volume;
}

images::LabelVolume Named(const std::map<Structure, std::string>& names) {
  Numbers numbers;
  int label = 40;
  for (const auto& [structure, name] : names) numbers[structure] = ++label;
  images::LabelVolume volume = Numbered(numbers);
  for (const auto& [structure, name] : names) volume.names.emplace_back(name, numbers[structure]);
  return volume;
}

/// Only what occurs in the trunk.
Numbers Present(const Numbers& numbers) {
  Numbers present;
  for (const auto& [structure, label] : numbers) {
    if (std::find(Trunk().labels.begin(), Trunk().labels.end(), static_cast<int>(structure)) !=
        Trunk().labels.end())
      present.emplace(structure, label);
  }
  return present;
}

std::string ErrorOf(const images::LabelVolume& volume, const LabelOptions& options = {}) {
  const auto found = FindLabels(volume, options);
  return found.ok()
             ? "liver " + std::to_string(found->liver) + ", gallbladder " + std::to_string(found->gallbladder)
             : found.error().message;
}

/// Whatever is said of a label is so.
void ExpectNothingWrong(const OrganLabels& found, const Numbers& truth, const std::string& what) {
  EXPECT_EQ(found.liver, truth.at(Structure::kLiver)) << what;
  EXPECT_EQ(found.gallbladder, truth.at(Structure::kGallbladder)) << what;
  for (const auto& [structure, label] : truth) {
    const auto said = found.structures.find(label);
    if (said == found.structures.end() || said->second == Structure::kOther) continue;
    const bool is_same = said->second == structure || RoleOf(said->second) == RoleOf(structure);
    EXPECT_TRUE(is_same) << what << ": " << NameOf(structure) << " taken for " << NameOf(said->second);
  }
}

TEST(FindLabels, KnowsEverySchemeOfNumbers) {
  int with_gallbladder = 0;
  for (const LabelScheme& scheme : LabelSchemes()) {
    const Numbers numbers = NumbersOf(scheme);
    const auto found = FindLabels(Numbered(numbers), {});
    if (!numbers.contains(Structure::kGallbladder)) {
      ASSERT_FALSE(found.ok()) << scheme.name;
      EXPECT_THAT(found.error().message, HasSubstr("gallbladder")) << scheme.name;
      continue;
    }
    ++with_gallbladder;
    ASSERT_TRUE(found.ok()) << scheme.name << ": " << found.error().message;
    ExpectNothingWrong(*found, numbers, scheme.name);
    EXPECT_THAT(found->convention, HasSubstr("the numbers of "));
    ASSERT_GE(found->taken.size(), 2u);
    EXPECT_THAT(found->taken[1].reason,
                AllOf(HasSubstr("which all labels fit"), HasSubstr("of its surface at the liver")));
    for (const patient::SourceLabel& label : found->taken) EXPECT_EQ(label.doubt, "") << scheme.name;
  }
  EXPECT_GE(with_gallbladder, 12);
}

// the 50 cases of AbdomenCT-1K with twelve organs: both kidneys have one number, and the gallbladder another than in FLARE
TEST(FindLabels, KnowsTheCasesOfTwelveOrgans) {
  using enum Structure;
  const Numbers numbers = {{kLiver, 1},       {kKidneyRight, 2}, {kKidneyLeft, 2},    {kSpleen, 3},
                           {kPancreas, 4},    {kAorta, 5},       {kVenaCava, 6},      {kStomach, 7},
                           {kGallbladder, 8}, {kEsophagus, 9},   {kAdrenalRight, 10}, {kAdrenalLeft, 11}};
  const auto found = FindLabels(Numbered(numbers), {});
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->liver, 1);
  EXPECT_EQ(found->gallbladder, 8);
  EXPECT_EQ(found->convention, "the numbers of AbdomenCT-12organ");
}

/// Eight ways in which labels could have changed their numbers.
std::vector<std::pair<std::string, std::vector<std::size_t>>> Permutations(const Numbers& numbers,
                                                                           unsigned seed) {
  std::vector<Structure> order;
  for (const auto& [structure, label] : numbers) order.push_back(structure);
  const auto swap = [&](Structure a, Structure b) {
    std::vector<std::size_t> to(order.size());
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = i;
    const auto at = [&](Structure one) { return std::find(order.begin(), order.end(), one) - order.begin(); };
    if (numbers.contains(a) && numbers.contains(b))
      std::swap(to[static_cast<std::size_t>(at(a))], to[static_cast<std::size_t>(at(b))]);
    return to;
  };
  const auto shift = [&](std::size_t by) {
    std::vector<std::size_t> to(order.size());
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = (i + by) % to.size();
    return to;
  };
  std::vector<std::size_t> backwards(order.size());
  for (std::size_t i = 0; i < backwards.size(); ++i) backwards[i] = backwards.size() - 1 - i;
  std::vector<std::size_t> random[2] = {shift(0), shift(0)};
  std::mt19937 engine(seed);
  for (auto& one : random) {
    // std::shuffle differs from library to library
    for (std::size_t i = one.size(); i > 1; --i) std::swap(one[i - 1], one[engine() % i]);
  }
  using enum Structure;
  return {
      {"gallbladder and right kidney", swap(kGallbladder, kKidneyRight)},
      {"gallbladder and duodenum", swap(kGallbladder, numbers.contains(kDuodenum) ? kDuodenum : kPancreas)},
      {"liver and stomach", swap(kLiver, kStomach)},
      {"next", shift(1)},
      {"last but one", shift(order.size() - 2)},
      {"backwards", backwards},
      {"random", random[0]},
      {"random again", random[1]}};
}

TEST(FindLabels, IsRightOrAsksWhenNumbersAreExchanged) {
  int tried = 0, asked = 0;
  for (std::size_t s = 0; s < LabelSchemes().size(); ++s) {
    const LabelScheme& scheme = LabelSchemes()[s];
    const Numbers numbers = Present(NumbersOf(scheme));
    if (!numbers.contains(Structure::kGallbladder)) continue;
    std::vector<int> labels;
    for (const auto& [structure, label] : numbers) labels.push_back(label);
    for (const auto& [what, to] : Permutations(numbers, static_cast<unsigned>(s))) {
      Numbers exchanged = numbers;
      std::size_t i = 0;
      for (auto& [structure, label] : exchanged) label = labels[to[i++]];
      if (exchanged == numbers) continue;
      ++tried;
      const auto found = FindLabels(Numbered(exchanged), {});
      if (found.ok()) {
        ExpectNothingWrong(*found, exchanged, std::string(scheme.name) + ", " + what);
      } else {
        ++asked;
        EXPECT_EQ(found.error().code, base::ErrorCode::kLabelsMismatch);
      }
    }
  }
  EXPECT_GE(tried, 8 * 12);
  EXPECT_GT(asked, tried / 2);
}

// Every two labels of every scheme, by the evidence alone.
TEST(LabelEvidence, SpeaksAgainstEveryExchangeOfAnOrgan) {
  Numbers own;
  for (int i = 1; i < static_cast<int>(Structure::kCount); ++i) own[static_cast<Structure>(i)] = i;
  const auto volume = Numbered(own);
  const auto frame = MakeVoxelFrame(volume, false);
  const LabelSights sights = LookAtLabels(volume, *frame);
  Meanings right;
  for (const auto& [label, sight] : sights.labels) right[label] = static_cast<Structure>(label);
  EXPECT_THAT(FindContradictions(sights, right), testing::IsEmpty());
  EXPECT_FALSE(FindContradictions(sights, right, true).empty()) << "it is not symmetrical";
  for (const auto& [a, meaning_a] : right) {
    for (const Structure organ : {Structure::kLiver, Structure::kGallbladder}) {
      const int b = static_cast<int>(organ);
      if (a == b) continue;
      Meanings exchanged = right;
      std::swap(exchanged[a], exchanged[b]);
      EXPECT_FALSE(FindContradictions(sights, exchanged).empty())
          << NameOf(meaning_a) << " and " << NameOf(organ);
    }
  }
  // what is no gallbladder where nothing else is known; a duodenum or pancreas might be one
  for (const Structure other :
       {Structure::kKidneyRight, Structure::kKidneyLeft, Structure::kSpleen, Structure::kStomach,
        Structure::kColon, Structure::kVenaCava, Structure::kAorta, Structure::kAdrenalRight,
        Structure::kHeart, Structure::kRibsRight, Structure::kVertebra, Structure::kBladder}) {
    const Meanings alone = {{static_cast<int>(Structure::kLiver), Structure::kLiver},
                            {static_cast<int>(other), Structure::kGallbladder}};
    EXPECT_FALSE(FindContradictions(sights, alone).empty()) << NameOf(other);
  }
}

TEST(FindLabels, SaysWhatItSeesWhereItAsks) {
  // AbdomenAtlas's numbers, and one label that it has not
  Numbers numbers =
      NumbersOf(*std::find_if(LabelSchemes().begin(), LabelSchemes().end(), [](const LabelScheme& one) {
        return std::string(one.name) == "AbdomenAtlas";
      }));
  numbers[Structure::kHeart] = 400;
  const std::string said = ErrorOf(Numbered(numbers));
  EXPECT_THAT(said, AllOf(HasSubstr("fit no known scheme"), HasSubstr("label 5: 1"), HasSubstr(", right, "),
                          HasSubstr("--names"), HasSubstr("--gallbladder")));
  LabelOptions options;
  options.liver = 5, options.gallbladder = 2;
  const auto found = FindLabels(Numbered(numbers), options);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->convention, "named on request");
  EXPECT_EQ(found->taken[1].doubt, "");
  EXPECT_EQ(found->structures.size(), 2u) << "nothing is known of the neighbours";
  // a request wins, and the doubt is kept
  options.gallbladder = 4;
  const auto kidney = FindLabels(Numbered(numbers), options);
  ASSERT_TRUE(kidney.ok());
  EXPECT_EQ(kidney->gallbladder, 4);
  EXPECT_NE(kidney->taken[1].doubt, "");
}

TEST(FindLabels, TakesNeighboursOfARequestFromTheSchemeThatAgrees) {
  const LabelScheme& total = LabelSchemes()[1];
  LabelOptions options;
  options.liver = 5, options.gallbladder = 4;
  const auto found = FindLabels(Numbered(NumbersOf(total)), options);
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->structures.at(6), Structure::kStomach);
  EXPECT_EQ(found->spleen, 1);
  // one of them is enough
  options.gallbladder = 0;
  EXPECT_EQ(FindLabels(Numbered(NumbersOf(total)), options)->gallbladder, 4);
}

TEST(FindLabels, NamesDecideInManyLanguages) {
  using Pair = std::pair<const char*, const char*>;
  for (const auto& [liver, gallbladder] :
       {Pair{"liver", "gallbladder"}, Pair{"Liver mask", "Gall Bladder"},
        Pair{"LIVER.nii.gz", "gall_bladder"}, Pair{"Hepar", "Vesica biliaris"}, Pair{"Leber", "Gallenblase"},
        Pair{"foie", "vésicule biliaire"}, Pair{"Hígado", "Vesícula biliar"},
        Pair{"H\xedgado",
             "Ves\xed"
             "cula"},
        Pair{"fegato", "colecisti"}, Pair{"Fígado", "vesícula biliar"}, Pair{"lever", "galblaas"},
        Pair{"Печень", "Желчный пузырь"}, Pair{"肝脏", "胆囊"}, Pair{"肝臓", "胆嚢"}, Pair{"간", "담낭"}}) {
    const auto volume = Named({{Structure::kLiver, liver},
                               {Structure::kGallbladder, gallbladder},
                               {Structure::kKidneyRight, "Kidney, Right"}});
    const auto found = FindLabels(volume, {});
    ASSERT_TRUE(found.ok()) << liver << ": " << found.error().message;
    EXPECT_EQ(found->liver, 41) << liver;
    EXPECT_EQ(found->gallbladder, 42) << gallbladder;
    EXPECT_EQ(found->structures.at(43), Structure::kKidneyRight);
    EXPECT_EQ(found->convention, "the map's names");
  }
}

TEST(FindLabels, NumbersNeverReplaceNames) {
  // a chest whose right lung has the liver's number and whose spine has the gallbladder's
  images::LabelVolume chest =
      Numbered({{Structure::kLungRight, 5}, {Structure::kVertebra, 4}, {Structure::kRibsRight, 6}});
  chest.names = {{"right lung", 5}, {"spine", 4}, {"Rib R 8", 6}};
  EXPECT_THAT(ErrorOf(chest), AllOf(HasSubstr("none of them is the liver"), HasSubstr("5 \"right lung\""),
                                    HasSubstr("map of the chest")));
  // TotalSegmentator's numbers under names in a language that the table has not
  images::LabelVolume unknown = Numbered(NumbersOf(LabelSchemes()[1]));
  for (const auto& [structure, label] : NumbersOf(LabelSchemes()[1]))
    unknown.names.emplace_back("orgán " + std::string(1, char('a' + label % 26)), label);
  EXPECT_THAT(ErrorOf(unknown), AllOf(HasSubstr("none of them is the liver"), HasSubstr("--liver")));
  // no gallbladder among the names, though its number is there
  images::LabelVolume nameless =
      Numbered({{Structure::kLiver, 5}, {Structure::kGallbladder, 4}, {Structure::kSpleen, 1}});
  nameless.names = {{"liver", 5}, {"spleen", 1}};
  EXPECT_THAT(ErrorOf(nameless),
              AllOf(HasSubstr("none of them is the gallbladder"), HasSubstr("--gallbladder")));
  LabelOptions options;
  options.gallbladder = 4;
  EXPECT_EQ(FindLabels(nameless, options)->gallbladder, 4);
  // two livers
  nameless.names = {{"liver", 5}, {"Leber", 1}, {"gallbladder", 4}};
  EXPECT_THAT(ErrorOf(nameless), HasSubstr("both called liver"));
  // names that nobody gave are none
  nameless.names = {{"Segment_1", 5}, {"Label 4", 4}, {"region 0", 1}};
  EXPECT_EQ(ErrorOf(nameless), "liver 5, gallbladder 4");
}

TEST(FindLabels, CodesDecideOverFreeText) {
  const auto coded = [](const std::string& liver, const std::string& gallbladder, const std::string& kidney) {
    // numbered so that some scheme has these numbers for other organs
    images::LabelVolume volume =
        Numbered({{Structure::kLiver, 4}, {Structure::kGallbladder, 2}, {Structure::kKidneyRight, 1}});
    volume.codes = {{liver, 4}, {gallbladder, 2}, {kidney, 1}};
    return volume;
  };
  for (const bool is_srt : {false, true}) {
    images::LabelVolume volume = is_srt ? coded("T-62000", "T-63000", "T-71000 G-A100")
                                        : coded("10200004", "28231008", "64033007 24028007");
    const auto expect = [&](const char* what) {
      const auto found = FindLabels(volume, {});
      ASSERT_TRUE(found.ok()) << what << ": " << found.error().message;
      EXPECT_EQ(found->liver, 4) << what;
      EXPECT_EQ(found->gallbladder, 2) << what;
      EXPECT_EQ(found->structures.at(1), Structure::kKidneyRight) << what;
    };
    expect("no name at all");
    volume.names = {{"Segment_1", 4}, {"Segment_2", 2}, {"Segment_3", 1}};
    expect("names that nobody gave");
    volume.names = {{"orgán A", 4}, {"the bag", 2}, {"k", 1}};
    expect("names that nobody understands");
    volume.names = {{"liver", 4}, {"Gallenblase", 2}, {"kidney", 1}};
    expect("names that say the same or less");
  }
  // what a name says more than its code stays
  images::LabelVolume parts = coded("10200004", "28231008", "10200004");
  parts.names = {{"liver", 4}, {"gallbladder", 2}, {"liver tumor", 1}};
  EXPECT_EQ(FindLabels(parts, {})->joined, (std::map<int, int>{{1, 4}}));
  parts = coded("10200004", "28231008", "108369006 @10200004");
  EXPECT_EQ(FindLabels(parts, {})->joined, (std::map<int, int>{{1, 4}})) << "a neoplasm of the liver";
}

TEST(FindLabels, CodesAndNamesThatMeanDifferentOrgansAreAskedFor) {
  images::LabelVolume volume = Numbered({{Structure::kLiver, 4}, {Structure::kGallbladder, 2}});
  volume.names = {{"liver", 4}, {"kidney right", 2}};
  volume.codes = {{"10200004", 4}, {"28231008", 2}};
  EXPECT_THAT(ErrorOf(volume),
              HasSubstr("label 2 is called \"kidney right\", and its code 28231008 means the "
                        "gallbladder"));
  // a code that is not known is no name of a liver either, and numbers do not replace it
  volume = Numbered(NumbersOf(LabelSchemes()[1]));
  volume.codes = {{"69748006", 5}};
  EXPECT_THAT(ErrorOf(volume), HasSubstr("none of them is the liver"));
  // what 3D Slicer writes of a segment that nobody named
  volume.codes = {{"85756007", 5}, {"T-D0050", 4}};
  EXPECT_EQ(ErrorOf(volume), "liver 5, gallbladder 4");
}

TEST(FindLabels, DensitiesThatDisagreeAreAskedFor) {
  const images::LabelVolume volume = Numbered({{Structure::kLiver, 1}, {Structure::kGallbladder, 2}});
  const auto found = FindLabels(volume, {}, {{1, 104.0}, {2, 12.0}});
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_THAT(found->taken[1].reason, HasSubstr(" mL, 12 HU, "));
  EXPECT_EQ(found->taken[1].doubt, "");
  // as a kidney in the venous phase, fat, or bone
  for (const double hu : {182.0, -95.0, 700.0}) {
    const auto refused = FindLabels(volume, {}, {{1, 104.0}, {2, hu}});
    ASSERT_FALSE(refused.ok()) << hu;
    EXPECT_THAT(refused.error().message, AllOf(HasSubstr("label 2 would be the gallbladder, and has "),
                                               HasSubstr(" HU in the images"), HasSubstr("--names")));
  }
  EXPECT_FALSE(FindLabels(volume, {}, {{1, -700.0}, {2, 12.0}}).ok()) << "a lung is no liver";
  // names decide, and the doubt is kept
  const auto named =
      FindLabels(Named({{Structure::kLiver, "liver"}, {Structure::kGallbladder, "gallbladder"}}), {},
                 {{41, 104.0}, {42, 182.0}});
  ASSERT_TRUE(named.ok());
  EXPECT_THAT(named->taken[1].doubt, HasSubstr("has 182 HU in the images; -30 to 80 HU are usual"));
}

TEST(FindLabels, ASegmentsNameThatContradictsTheBodyIsDoubted) {
  const auto found = FindLabels(Named({{Structure::kLiver, "liver"},
                                       {Structure::kKidneyRight, "gallbladder"},
                                       {Structure::kSpleen, "spleen"}}),
                                {});
  ASSERT_TRUE(found.ok());
  EXPECT_THAT(found->taken[1].doubt, HasSubstr("would be the gallbladder"));
}

TEST(FindLabels, JoinsPartsOfAnOrgan) {
  images::LabelVolume volume = Numbered({{Structure::kLiver, 1}, {Structure::kGallbladder, 2}});
  // a tumour in the liver, and a stone in the gallbladder
  std::size_t at = 0, tumour = 0;
  for (int k = 0; k < volume.size[2]; ++k) {
    for (int j = 0; j < volume.size[1]; ++j) {
      for (int i = 0; i < volume.size[0]; ++i, ++at) {
        if (volume.labels[at] == 1 && std::hypot(i - 20, j - 30, k - 50) < 6) volume.labels[at] = 3, ++tumour;
        if (volume.labels[at] == 2 && std::hypot(i - 29, j - 16, k - 37) < 2) volume.labels[at] = 7;
      }
    }
  }
  ASSERT_GT(tumour, 100u);
  volume.names = {{"liver", 1}, {"gallbladder", 2}, {"liver_tumor", 3}, {"gallstones", 7}};
  const auto found = FindLabels(volume, {});
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->joined, (std::map<int, int>{{3, 1}, {7, 2}}));
  EXPECT_EQ(found->taken[0].doubt, "");
  JoinParts(*found, volume);
  EXPECT_EQ(volume.labels, Numbered({{Structure::kLiver, 1}, {Structure::kGallbladder, 2}}).labels);
}

/// A liver with a ball in it, as LiTS numbers them.
images::LabelVolume WithTumour(std::vector<std::array<double, 4>> balls) {
  images::LabelVolume volume = Numbered({{Structure::kLiver, 1}});
  std::size_t at = 0;
  for (int k = 0; k < volume.size[2]; ++k) {
    for (int j = 0; j < volume.size[1]; ++j) {
      for (int i = 0; i < volume.size[0]; ++i, ++at) {
        for (const auto& [r, a, s, radius] : balls) {
          if (volume.labels[at] == 1 && std::hypot(kVoxelMm * (39.5 - i) - r, kVoxelMm * (26.5 - j) - a,
                                                   kVoxelMm * (k - 50.5) - s) < radius)
            volume.labels[at] = 2;
        }
      }
    }
  }
  return volume;
}

TEST(FindLabels, ATumourIsNoGallbladder) {
  for (const auto& volume : {WithTumour({{60, 10, -20, 20}}),
                             WithTumour({{60, 10, -20, 18}, {80, -20, 20, 14}, {20, 20, 20, 12}})}) {
    EXPECT_THAT(ErrorOf(volume),
                AllOf(HasSubstr("no gallbladder"), HasSubstr("label 2 lies inside the liver, as a tumour")));
  }
  // at the liver's lower face, where a gallbladder may lie, too
  EXPECT_THAT(ErrorOf(WithTumour({{42, 40, -45, 16}})), AllOf(HasSubstr("LiTS"), HasSubstr("--names")));
  // the same numbers with a gallbladder
  EXPECT_EQ(ErrorOf(Numbered({{Structure::kLiver, 1}, {Structure::kGallbladder, 2}})),
            "liver 1, gallbladder 2");
}

TEST(FindLabels, AMirroredMapIsCalledSo) {
  for (const LabelScheme* scheme : {&LabelSchemes()[1], &LabelSchemes()[6]}) {
    images::LabelVolume mirrored = Numbered(NumbersOf(*scheme));
    mirrored.direction[0][0] = -kVoxelMm;
    EXPECT_THAT(ErrorOf(mirrored), HasSubstr("--mirrored")) << scheme->name;
    LabelOptions options;
    options.is_mirrored = true;
    const auto found = FindLabels(mirrored, options);
    ASSERT_TRUE(found.ok()) << found.error().message;
    ExpectNothingWrong(*found, NumbersOf(*scheme), scheme->name);
  }
}

TEST(FindLabels, RefusesAnImage) {
  images::LabelVolume image = Trunk();
  for (std::size_t i = 0; i < image.labels.size(); ++i) image.labels[i] = static_cast<int>(i % 3000);
  EXPECT_THAT(ErrorOf(image), HasSubstr("2999 different values"));
  std::fill(image.labels.begin(), image.labels.end(), 0);
  EXPECT_THAT(ErrorOf(image), HasSubstr("no label at all"));
}

TEST(Structures, AreFoundByTheirNames) {
  using enum Structure;
  for (const auto& [name, structure] :
       std::map<std::string, Structure>{{"kidney_right", kKidneyRight},
                                        {"Right Kidney", kKidneyRight},
                                        {"kidney (R)", kKidneyRight},
                                        {"rein droit", kKidneyRight},
                                        {"postcava", kVenaCava},
                                        {"arota", kAorta},
                                        {"vertebrae_L3", kVertebraL3},
                                        {"vertebrae_T9", kVertebra},
                                        {"vertebrae_C7", kUpperVertebra},
                                        {"rib_left_7", kRibsLeft},
                                        {"Rib right 7", kRibsRight},
                                        {"RightKidney", kKidneyRight},
                                        {"portal_vein_and_splenic_vein", kPortalVein},
                                        {"liver_segment_4", kLiverPart},
                                        {"Magen", kStomach},
                                        {"十二指肠", kDuodenum},
                                        {"門靜脈", kPortalVein},
                                        {"主動脈", kAorta},
                                        {"右腎臟", kKidneyRight},
                                        {"좌측 신장", kKidneyLeft},
                                        {"hepatic_veins", kLiverVessel},
                                        {"bile_ducts", kBileDuct},
                                        {"liver 2", kUnknown},
                                        {"not a liver", kUnknown},
                                        {"gallbladder bed", kUnknown},
                                        {"large bowel", kColon},
                                        {"sacrum", kSacrum},
                                        {"vesicula seminal", kUnknown}})
    EXPECT_EQ(NameOf(FindStructure(name)), std::string(NameOf(structure))) << name;
  // what a patient's parts are called is understood, too
  for (std::size_t i = 1; i < roles::kNeighbourRoleCount; ++i) {
    const auto role = static_cast<roles::NeighbourRole>(i);
    EXPECT_EQ(RoleOf(FindStructure(roles::NameOf(role))), role) << roles::NameOf(role);
  }
  for (const auto& [code, structure] :
       std::map<std::string, Structure>{{"10200004", kLiver},
                                        {"T-62000", kLiver},
                                        {"28231008", kGallbladder},
                                        {"T-63000", kGallbladder},
                                        {"64033007", kKidneys},
                                        {"64033007 7771000", kKidneyLeft},
                                        {"T-71000 G-A100", kKidneyRight},
                                        {"64033007 7771000 @818981001", kKidneyLeft},
                                        {"367643001 @64033007", kOther},
                                        {"M-8FFFF @T-62000", kLiverLesion},
                                        {"69748006", kUnknown},
                                        {"", kUnknown}})
    EXPECT_EQ(NameOf(FindCodedStructure(code)), std::string(NameOf(structure))) << code;
  EXPECT_TRUE(IsPlaceholder("Segment_12") && IsPlaceholder("Label 3") && IsPlaceholder("7") &&
              IsPlaceholder(""));
  EXPECT_FALSE(IsPlaceholder("L3") || IsPlaceholder("liver") || IsPlaceholder("tissue"));
}

}  // namespace
}  // namespace trocar::anatomy
