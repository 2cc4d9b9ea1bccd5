// SPDX-License-Identifier: Apache-2.0
#include "label_schemes.h"

#include <initializer_list>

namespace trocar::anatomy {
namespace {

using enum Structure;

struct Range {
  int first, last;
  Structure structure;
};

LabelScheme Make(const char* name, const char* source, std::initializer_list<Range> ranges) {
  LabelScheme scheme{name, source, {}};
  for (const Range& range : ranges) {
    for (int label = range.first; label <= range.last; ++label)
      scheme.numbers.emplace(label, range.structure);
  }
  return scheme;
}

/// Structures whose labels follow each other from 1 on.
LabelScheme Count(const char* name, const char* source, std::initializer_list<Structure> structures) {
  LabelScheme scheme{name, source, {}};
  int label = 0;
  for (const Structure structure : structures) scheme.numbers.emplace(++label, structure);
  return scheme;
}

}  // namespace

const std::vector<LabelScheme>& LabelSchemes() {
  static const std::vector<LabelScheme> schemes = {
      Count("Trocar", "docs/patients.md, the phantom's labels.nrrd",
            {kLiver, kGallbladder, kBileDuct, kArtery, kPortalVein, kLiverVessel}),
      Make("TotalSegmentator 2",
           "github.com/wasserth/TotalSegmentator, totalsegmentator/map_to_binary.py, class map total",
           {{1, 1, kSpleen},       {2, 2, kKidneyRight},     {3, 3, kKidneyLeft},   {4, 4, kGallbladder},
            {5, 5, kLiver},        {6, 6, kStomach},         {7, 7, kPancreas},     {8, 8, kAdrenalRight},
            {9, 9, kAdrenalLeft},  {10, 11, kLungLeft},      {12, 14, kLungRight},  {15, 15, kEsophagus},
            {16, 16, kChest},      {17, 17, kHead},          {18, 18, kSmallBowel}, {19, 19, kDuodenum},
            {20, 20, kColon},      {21, 21, kBladder},       {22, 22, kPelvis},     {23, 24, kOther},
            {25, 26, kSacrum},     {27, 27, kVertebra},      {28, 28, kVertebraL4}, {29, 29, kVertebraL3},
            {30, 37, kVertebra},   {38, 50, kUpperVertebra}, {51, 51, kHeart},      {52, 52, kAorta},
            {53, 56, kChest},      {57, 58, kHead},          {59, 62, kChest},      {63, 63, kVenaCava},
            {64, 64, kPortalVein}, {65, 68, kPelvis},        {69, 74, kChest},      {75, 78, kPelvis},
            {79, 79, kOther},      {80, 85, kPelvis},        {86, 89, kOther},      {90, 91, kHead},
            {92, 103, kRibsLeft},  {104, 115, kRibsRight},   {116, 116, kChest},    {117, 117, kOther}}),
      Make("TotalSegmentator 1",
           "github.com/wasserth/TotalSegmentator, totalsegmentator/map_to_binary.py, class map total_v1",
           {{1, 1, kSpleen},       {2, 2, kKidneyRight},  {3, 3, kKidneyLeft},      {4, 4, kGallbladder},
            {5, 5, kLiver},        {6, 6, kStomach},      {7, 7, kAorta},           {8, 8, kVenaCava},
            {9, 9, kPortalVein},   {10, 10, kPancreas},   {11, 11, kAdrenalRight},  {12, 12, kAdrenalLeft},
            {13, 14, kLungLeft},   {15, 17, kLungRight},  {18, 18, kVertebra},      {19, 19, kVertebraL4},
            {20, 20, kVertebraL3}, {21, 28, kVertebra},   {29, 41, kUpperVertebra}, {42, 42, kEsophagus},
            {43, 43, kChest},      {44, 48, kHeart},      {49, 49, kChest},         {50, 50, kHead},
            {51, 54, kPelvis},     {55, 55, kSmallBowel}, {56, 56, kDuodenum},      {57, 57, kColon},
            {58, 69, kRibsLeft},   {70, 81, kRibsRight},  {82, 87, kChest},         {88, 91, kPelvis},
            {92, 92, kSacrum},     {93, 93, kHead},       {94, 99, kPelvis},        {100, 103, kOther},
            {104, 104, kBladder}}),
      Make("TotalSegmentator MRI",
           "github.com/wasserth/TotalSegmentator, totalsegmentator/map_to_binary.py, class map total_mr",
           {{1, 1, kSpleen},       {2, 2, kKidneyRight}, {3, 3, kKidneyLeft},   {4, 4, kGallbladder},
            {5, 5, kLiver},        {6, 6, kStomach},     {7, 7, kPancreas},     {8, 8, kAdrenalRight},
            {9, 9, kAdrenalLeft},  {10, 10, kLungLeft},  {11, 11, kLungRight},  {12, 12, kEsophagus},
            {13, 13, kSmallBowel}, {14, 14, kDuodenum},  {15, 15, kColon},      {16, 16, kBladder},
            {17, 17, kPelvis},     {18, 18, kSacrum},    {19, 21, kOther},      {22, 22, kHeart},
            {23, 23, kAorta},      {24, 24, kVenaCava},  {25, 25, kPortalVein}, {26, 29, kPelvis},
            {30, 35, kChest},      {36, 45, kPelvis},    {46, 49, kOther},      {50, 50, kHead}}),
      Make("MRSegmentator", "github.com/hhaentze/MRSegmentator, README, class details",
           {{1, 1, kSpleen},      {2, 2, kKidneyRight},  {3, 3, kKidneyLeft},   {4, 4, kGallbladder},
            {5, 5, kLiver},       {6, 6, kStomach},      {7, 7, kPancreas},     {8, 8, kAdrenalRight},
            {9, 9, kAdrenalLeft}, {10, 10, kLungLeft},   {11, 11, kLungRight},  {12, 12, kHeart},
            {13, 13, kAorta},     {14, 14, kVenaCava},   {15, 15, kPortalVein}, {16, 19, kPelvis},
            {20, 20, kEsophagus}, {21, 21, kSmallBowel}, {22, 22, kDuodenum},   {23, 23, kColon},
            {24, 24, kBladder},   {25, 25, kOther},      {26, 26, kSacrum},     {27, 30, kPelvis},
            {31, 34, kOther},     {35, 40, kPelvis}}),
      Make("AbdomenAtlas", "github.com/MrGiovanni/AbdomenAtlas/issues/9, class maps of versions 1.0 and 1.1",
           {{1, 1, kAorta},       {2, 2, kGallbladder},   {3, 3, kKidneyLeft},     {4, 4, kKidneyRight},
            {5, 5, kLiver},       {6, 6, kPancreas},      {7, 7, kVenaCava},       {8, 8, kSpleen},
            {9, 9, kStomach},     {10, 10, kAdrenalLeft}, {11, 11, kAdrenalRight}, {12, 12, kBladder},
            {13, 13, kOther},     {14, 14, kColon},       {15, 15, kDuodenum},     {16, 16, kEsophagus},
            {17, 18, kPelvis},    {19, 19, kLiverVessel}, {20, 20, kSmallBowel},   {21, 21, kLungLeft},
            {22, 22, kLungRight}, {23, 23, kPortalVein},  {24, 25, kPelvis}}),
      Make("BTCV",
           "synapse.org, syn3193805, Beyond the Cranial Vault; with the duodenum: zenodo.org/record/1169361; "
           "numbers: "
           "github.com/uni-medical/A-Eval, Evaluation/label_systems.py, and "
           "github.com/ljwztc/CLIP-Driven-Universal-Model, label_transfer.py, templates 01 and 02",
           {{1, 1, kSpleen},
            {2, 2, kKidneyRight},
            {3, 3, kKidneyLeft},
            {4, 4, kGallbladder},
            {5, 5, kEsophagus},
            {6, 6, kLiver},
            {7, 7, kStomach},
            {8, 8, kAorta},
            {9, 9, kVenaCava},
            {10, 10, kPortalVein},
            {11, 11, kPancreas},
            {12, 12, kAdrenalRight},
            {13, 13, kAdrenalLeft},
            {14, 14, kDuodenum}}),
      Count("BTCV with eight organs", "github.com/Beckschen/TransUNet, the prepared Synapse data",
            {kAorta, kGallbladder, kKidneyLeft, kKidneyRight, kLiver, kPancreas, kSpleen, kStomach}),
      Count("AMOS",
            "amos22.grand-challenge.org, dataset.json (Ji et al., NeurIPS 2022); numbers: A-Eval's "
            "label_systems.py, CLIP-Driven-Universal-Model's template 09",
            {kSpleen, kKidneyRight, kKidneyLeft, kGallbladder, kEsophagus, kLiver, kStomach, kAorta,
             kVenaCava, kPancreas, kAdrenalRight, kAdrenalLeft, kDuodenum, kBladder, kPelvis}),
      Count("FLARE 2022",
            "flare22.grand-challenge.org; from 2023 on with 14, a tumour of any organ; numbers: A-Eval's "
            "label_systems.py, huggingface.co/datasets/YongchengYAO/FLARE22-Lite",
            {kLiver, kKidneyRight, kSpleen, kPancreas, kAorta, kVenaCava, kAdrenalRight, kAdrenalLeft,
             kGallbladder, kEsophagus, kStomach, kDuodenum, kKidneyLeft, kOther}),
      Make("WORD",
           "github.com/HiLab-git/WORD (Luo et al., Medical Image Analysis 2022); numbers: A-Eval's "
           "label_systems.py, CLIP-Driven-Universal-Model's template 07",
           {{1, 1, kLiver},
            {2, 2, kSpleen},
            {3, 3, kKidneyLeft},
            {4, 4, kKidneyRight},
            {5, 5, kStomach},
            {6, 6, kGallbladder},
            {7, 7, kEsophagus},
            {8, 8, kPancreas},
            {9, 9, kDuodenum},
            {10, 10, kColon},
            {11, 11, kSmallBowel},
            {12, 12, kAdrenals},
            {13, 13, kPelvis},
            {14, 14, kBladder},
            {15, 16, kPelvis}}),
      // the 50 cases of AbdomenCT-1K with twelve organs
      Count("AbdomenCT-12organ",
            "github.com/JunMa11/AbdomenCT-1K, README; numbers: CLIP-Driven-Universal-Model's template 13",
            {kLiver, kKidneys, kSpleen, kPancreas, kAorta, kVenaCava, kStomach, kGallbladder, kEsophagus,
             kAdrenalRight, kAdrenalLeft, kOther}),
      Make("VISTA3D", "github.com/Project-MONAI/VISTA, vista3d/data/jsons/label_dict.json",
           {{1, 1, kLiver},         {2, 2, kKidneys},         {3, 3, kSpleen},       {4, 4, kPancreas},
            {5, 5, kKidneyRight},   {6, 6, kAorta},           {7, 7, kVenaCava},     {8, 8, kAdrenalRight},
            {9, 9, kAdrenalLeft},   {10, 10, kGallbladder},   {11, 11, kEsophagus},  {12, 12, kStomach},
            {13, 13, kDuodenum},    {14, 14, kKidneyLeft},    {15, 15, kBladder},    {16, 16, kPelvis},
            {17, 17, kPortalVein},  {18, 18, kPelvis},        {19, 19, kSmallBowel}, {20, 20, kLungs},
            {21, 21, kOther},       {22, 22, kHead},          {23, 23, kChest},      {24, 24, kOther},
            {25, 25, kLiverVessel}, {26, 26, kLiverLesion},   {27, 27, kOther},      {28, 29, kLungLeft},
            {30, 32, kLungRight},   {33, 33, kVertebra},      {34, 34, kVertebraL4}, {35, 35, kVertebraL3},
            {36, 43, kVertebra},    {44, 56, kUpperVertebra}, {57, 57, kChest},      {58, 61, kPelvis},
            {62, 62, kColon},       {63, 74, kRibsLeft},      {75, 86, kRibsRight},  {87, 92, kChest},
            {93, 96, kPelvis},      {97, 97, kSacrum},        {98, 103, kPelvis},    {104, 107, kOther},
            {108, 111, kChest},     {112, 113, kHead},        {114, 114, kOther},    {115, 115, kHeart},
            {116, 117, kOther},     {118, 118, kPelvis},      {119, 119, kChest},    {120, 120, kHead},
            {121, 121, kOther},     {122, 125, kChest},       {126, 126, kHead},     {127, 127, kSacrum},
            {128, 129, kOther},     {130, 130, kLiverLesion}, {131, 131, kVertebra}, {132, 132, kChest}}),
      Make("3D Slicer's GenericAnatomyColors",
           "github.com/Slicer/Slicer, Base/Logic/Resources/ColorFiles/GenericAnatomyColors.txt",
           {{1, 15, kOther},           {16, 35, kOther},         {36, 163, kHead},
            {164, 168, kHead},         {169, 171, kChest},       {172, 172, kLungRight},
            {173, 173, kLungLeft},     {174, 174, kLungRight},   {175, 175, kLungLeft},
            {176, 177, kLungRight},    {178, 178, kLungLeft},    {179, 179, kChest},
            {180, 182, kHeart},        {183, 184, kHeart},       {185, 186, kHeart},
            {187, 190, kChest},        {191, 191, kAorta},       {192, 193, kChest},
            {194, 194, kEsophagus},    {195, 200, kChest},       {201, 201, kRibs},
            {202, 204, kChest},        {205, 210, kOther},       {211, 211, kStomach},
            {212, 212, kDuodenum},     {213, 213, kSmallBowel},  {214, 214, kColon},
            {215, 215, kPelvis},       {216, 216, kLiver},       {217, 217, kBileDuct},
            {218, 218, kGallbladder},  {219, 219, kPancreas},    {220, 220, kSpleen},
            {221, 221, kOther},        {222, 222, kKidneyRight}, {223, 223, kKidneyLeft},
            {224, 225, kOther},        {226, 226, kBladder},     {227, 227, kPelvis},
            {228, 228, kAdrenalRight}, {229, 229, kAdrenalLeft}, {230, 242, kPelvis},
            {243, 245, kOther},        {246, 246, kVertebra},    {247, 248, kPelvis},
            {249, 309, kOther}}),
      Make("3D Slicer's AbdomenColors",
           "github.com/Slicer/Slicer, Base/Logic/Resources/ColorFiles/AbdomenColors.txt",
           {{2, 2, kOther},
            {3, 3, kLiver},
            {4, 4, kSpleen},
            {6, 6, kPancreas},
            {7, 7, kAorta},
            {8, 8, kVenaCava},
            {9, 9, kColon},
            {10, 10, kGallbladder},
            {12, 12, kPortalVein},
            {13, 13, kStomach},
            {16, 18, kOther},
            {19, 20, kArtery},
            {21, 23, kOther},
            {24, 25, kArtery},
            {29, 29, kOther},
            {32, 32, kOther},
            {51, 51, kKidneyRight},
            {52, 52, kKidneyLeft},
            {111, 111, kAdrenalRight},
            {112, 112, kAdrenalLeft},
            {126, 143, kOther},
            {151, 153, kLiverVessel},
            {227, 241, kOther}}),
      // without a gallbladder: so that their numbers are not taken for it
      Count("LiTS",
            "Bilic et al., Medical Image Analysis 2023; the same in medicaldecathlon.com, Task03_Liver",
            {kLiver, kLiverLesion}),
      Count("CHAOS counted from 1 on",
            "github.com/MIC-DKFZ/nnUNet, nnunetv2/dataset_conversion/Dataset047_Chaos_Challenge.py",
            {kLiver, kKidneyRight, kKidneyLeft, kSpleen}),
      Make("CHAOS",
           "chaos.grand-challenge.org/Data; the ranges as in nnU-Net's Dataset047_Chaos_Challenge.py",
           {{55, 70, kLiver}, {110, 135, kKidneyRight}, {175, 200, kKidneyLeft}, {240, 255, kSpleen}}),
      Count("AbdomenCT-1K",
            "Ma et al., IEEE TPAMI 2022; the same in FLARE 2021; numbers: CLIP-Driven-Universal-Model's "
            "template 08, huggingface.co/datasets/MedOtter/FLARE21",
            {kLiver, kKidneys, kSpleen, kPancreas}),
      Count("CT-ORG",
            "Rister et al., Scientific Data 2020; numbers: the data set's README (cancerimagingarchive.net)",
            {kLiver, kBladder, kLungs, kKidneys, kOther, kHead})};
  return schemes;
}

}  // namespace trocar::anatomy
