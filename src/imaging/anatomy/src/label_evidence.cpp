// SPDX-License-Identifier: Apache-2.0
#include "label_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "trocar/roles/roles.h"

namespace trocar::anatomy {
namespace {

using enum Structure;

struct VolumeRange {
  Structure structure;
  double least_ml, most_ml;
};
/// The largest of the public segmentations, and more. Below the least an organ is only where the map's border cuts it.
constexpr VolumeRange kVolumes[] = {
    {kLiver, 200, 8000},      {kGallbladder, 1, 500}, {kSpleen, 5, 4000},      {kStomach, 10, 4800},
    {kDuodenum, 5, 600},      {kColon, 20, 5000},     {kSmallBowel, 20, 5000}, {kPancreas, 5, 400},
    {kKidneyRight, 8, 900},   {kKidneyLeft, 8, 900},  {kKidneys, 8, 1800},     {kAdrenalRight, 0, 60},
    {kAdrenalLeft, 0, 60},    {kAdrenals, 0, 120},    {kVenaCava, 5, 400},     {kAorta, 5, 2200},
    {kPortalVein, 0, 250},    {kEsophagus, 1, 250},   {kLungRight, 20, 5000},  {kLungLeft, 20, 5000},
    {kLungs, 20, 10000},      {kHeart, 20, 3000},     {kBladder, 5, 3000},     {kRibsRight, 0, 120},
    {kRibsLeft, 0, 120},      {kVertebra, 5, 1500},   {kVertebraL3, 5, 250},   {kVertebraL4, 5, 250},
    {kUpperVertebra, 0, 200}, {kBileDuct, 0, 150},    {kArtery, 0, 150},       {kLiverVessel, 0, 600}};
/// Less is a speck that a program puts anywhere, and is not judged.
constexpr double kSpeckMl = 1.5;

struct DensityRange {
  Structure structure;
  double least_hu, most_hu;
};
/// Medians in CT, with and without contrast, from below severe steatosis to the arterial phase. Bile has 0 to 25 HU, sludge and pus some
/// tens; with contrast or milk of calcium in it a gallbladder has more, and is asked for. Hollow organs hold anything, from gas to
/// contrast. Margins round the tables of attenuation in textbooks of radiology [M].
constexpr DensityRange kDensities[] = {
    {kLiver, -40, 250},       {kGallbladder, -30, 80},    {kSpleen, 20, 260},    {kPancreas, -60, 220},
    {kKidneyRight, 0, 400},   {kKidneyLeft, 0, 400},      {kKidneys, 0, 400},    {kVenaCava, 10, 500},
    {kAorta, 10, 800},        {kPortalVein, 10, 400},     {kHeart, 0, 600},      {kLungRight, -1100, -200},
    {kLungLeft, -1100, -200}, {kLungs, -1100, -200},      {kVertebra, 40, 2000}, {kVertebraL3, 40, 2000},
    {kVertebraL4, 40, 2000},  {kUpperVertebra, 40, 2000}, {kSacrum, 20, 2000},   {kRibsRight, 60, 2000},
    {kRibsLeft, 60, 2000},    {kRibs, 60, 2000}};

enum class Axis { kLeft, kCranial, kAnterior };

/// The centre of `a` lies at least `least_mm` further along the axis than that of `b`.
struct Order {
  Structure a;
  Axis axis;
  Structure b;
  double least_mm;
};
constexpr Order kOrders[] = {
    // the gallbladder: right, in front, at the liver's lower face
    {kLiver, Axis::kCranial, kGallbladder, -10},
    {kGallbladder, Axis::kAnterior, kLiver, -20},
    {kGallbladder, Axis::kAnterior, kKidneyRight, 15},
    {kGallbladder, Axis::kAnterior, kKidneyLeft, 0},
    {kGallbladder, Axis::kAnterior, kKidneys, 15},
    {kGallbladder, Axis::kAnterior, kVertebra, 20},
    {kGallbladder, Axis::kAnterior, kVertebraL3, 20},
    {kGallbladder, Axis::kAnterior, kVertebraL4, 20},
    {kGallbladder, Axis::kAnterior, kVenaCava, 5},
    {kGallbladder, Axis::kAnterior, kAorta, 5},
    {kGallbladder, Axis::kAnterior, kAdrenalRight, 5},
    {kGallbladder, Axis::kAnterior, kAdrenalLeft, 5},
    {kGallbladder, Axis::kAnterior, kPortalVein, -5},
    {kGallbladder, Axis::kAnterior, kDuodenum, -10},
    {kGallbladder, Axis::kAnterior, kPancreas, -20},
    {kGallbladder, Axis::kAnterior, kSpleen, -20},
    {kSpleen, Axis::kLeft, kGallbladder, 40},
    {kKidneyLeft, Axis::kLeft, kGallbladder, 30},
    {kStomach, Axis::kLeft, kGallbladder, 0},
    {kPancreas, Axis::kLeft, kGallbladder, 0},
    {kAorta, Axis::kLeft, kGallbladder, 0},
    {kAdrenalLeft, Axis::kLeft, kGallbladder, 15},
    {kPortalVein, Axis::kLeft, kGallbladder, -15},
    {kGallbladder, Axis::kLeft, kRibsRight, -10},
    {kRibsLeft, Axis::kLeft, kGallbladder, 10},
    {kLungRight, Axis::kCranial, kGallbladder, 40},
    {kLungLeft, Axis::kCranial, kGallbladder, 40},
    {kLungs, Axis::kCranial, kGallbladder, 40},
    {kHeart, Axis::kCranial, kGallbladder, 40},
    {kEsophagus, Axis::kCranial, kGallbladder, 0},
    {kGallbladder, Axis::kCranial, kBladder, 50},
    {kGallbladder, Axis::kCranial, kPelvis, 20},
    {kGallbladder, Axis::kCranial, kSacrum, 20},
    // the liver: right, under the diaphragm
    {kSpleen, Axis::kLeft, kLiver, 40},
    {kKidneyLeft, Axis::kLeft, kLiver, 20},
    {kStomach, Axis::kLeft, kLiver, 0},
    {kPancreas, Axis::kLeft, kLiver, -20},
    {kEsophagus, Axis::kLeft, kLiver, 0},
    {kAorta, Axis::kLeft, kLiver, 0},
    {kVenaCava, Axis::kLeft, kLiver, -30},
    {kAdrenalLeft, Axis::kLeft, kLiver, 10},
    {kLungLeft, Axis::kLeft, kLiver, 0},
    {kLungRight, Axis::kCranial, kLiver, 0},
    {kLungLeft, Axis::kCranial, kLiver, 0},
    {kLungs, Axis::kCranial, kLiver, 0},
    {kHeart, Axis::kCranial, kLiver, 10},
    {kChest, Axis::kCranial, kLiver, 0},
    {kHead, Axis::kCranial, kLiver, 60},
    {kUpperVertebra, Axis::kCranial, kLiver, 30},
    {kLiver, Axis::kCranial, kBladder, 80},
    {kLiver, Axis::kCranial, kPelvis, 40},
    {kLiver, Axis::kCranial, kSacrum, 40},
    {kLiver, Axis::kCranial, kVertebraL4, 20},
    {kLiver, Axis::kCranial, kVertebraL3, 0},
    {kLiver, Axis::kCranial, kSmallBowel, 10},
    {kLiver, Axis::kCranial, kColon, -20},
    {kLiver, Axis::kCranial, kKidneyRight, -10},
    {kLiver, Axis::kAnterior, kKidneyRight, 10},
    {kLiver, Axis::kAnterior, kKidneyLeft, 5},
    {kLiver, Axis::kAnterior, kKidneys, 10},
    {kLiver, Axis::kAnterior, kVertebra, 10},
    {kLiver, Axis::kAnterior, kVertebraL3, 0},
    {kLiver, Axis::kAnterior, kAdrenalRight, 0},
    {kLiver, Axis::kAnterior, kAdrenalLeft, 0},
    // pairs, and what lies before or above what
    {kKidneyLeft, Axis::kLeft, kKidneyRight, 40},
    {kSpleen, Axis::kLeft, kKidneyRight, 40},
    {kAdrenalLeft, Axis::kLeft, kAdrenalRight, 15},
    {kLungLeft, Axis::kLeft, kLungRight, 30},
    {kRibsLeft, Axis::kLeft, kRibsRight, 10},
    {kAorta, Axis::kLeft, kVenaCava, -8},
    {kSpleen, Axis::kCranial, kKidneyLeft, -20},
    {kAdrenalLeft, Axis::kCranial, kKidneyLeft, 0},
    {kAdrenalRight, Axis::kCranial, kKidneyRight, 0},
    {kEsophagus, Axis::kCranial, kKidneyLeft, 0},
    {kEsophagus, Axis::kCranial, kPancreas, 0},
    {kEsophagus, Axis::kCranial, kDuodenum, 0},
    {kLungLeft, Axis::kCranial, kKidneyLeft, 20},
    {kLungRight, Axis::kCranial, kKidneyRight, 20},
    {kLungLeft, Axis::kCranial, kSpleen, 0},
    {kHeart, Axis::kCranial, kStomach, 0},
    {kHeart, Axis::kCranial, kSpleen, 0},
    {kKidneyLeft, Axis::kCranial, kBladder, 40},
    {kKidneyRight, Axis::kCranial, kBladder, 40},
    {kStomach, Axis::kCranial, kBladder, 40},
    {kSpleen, Axis::kCranial, kBladder, 80},
    {kStomach, Axis::kAnterior, kKidneyLeft, 10},
    {kStomach, Axis::kAnterior, kKidneyRight, 10},
    {kStomach, Axis::kAnterior, kSpleen, -5},
    {kStomach, Axis::kAnterior, kVertebra, 20},
    {kStomach, Axis::kAnterior, kAorta, 0},
    {kStomach, Axis::kAnterior, kAdrenalLeft, 5},
    {kStomach, Axis::kLeft, kPancreas, -10},
    {kStomach, Axis::kLeft, kDuodenum, 0},
    {kSpleen, Axis::kLeft, kStomach, 0},
    {kSpleen, Axis::kLeft, kPancreas, 10},
    {kSpleen, Axis::kLeft, kAorta, 20},
    {kSpleen, Axis::kLeft, kVenaCava, 30},
    {kSpleen, Axis::kLeft, kAdrenalLeft, 0},
    {kPancreas, Axis::kLeft, kDuodenum, 0},
    {kPancreas, Axis::kAnterior, kKidneyLeft, 0},
    {kPancreas, Axis::kAnterior, kKidneyRight, 0},
    {kPancreas, Axis::kAnterior, kVertebra, 10},
    {kPancreas, Axis::kAnterior, kAorta, -5},
    {kPancreas, Axis::kAnterior, kVenaCava, -5},
    {kKidneyLeft, Axis::kLeft, kAorta, 10},
    {kKidneyLeft, Axis::kLeft, kVenaCava, 20},
    {kVenaCava, Axis::kLeft, kKidneyRight, 10},
    {kAorta, Axis::kLeft, kKidneyRight, 20},
    {kKidneyLeft, Axis::kLeft, kDuodenum, 10},
    {kDuodenum, Axis::kAnterior, kKidneyRight, 0},
    {kDuodenum, Axis::kAnterior, kVenaCava, 0},
    {kDuodenum, Axis::kAnterior, kAorta, 0},
    {kDuodenum, Axis::kAnterior, kVertebra, 10},
    {kPortalVein, Axis::kAnterior, kVenaCava, 0},
    {kPortalVein, Axis::kAnterior, kAorta, 0},
    {kPortalVein, Axis::kAnterior, kKidneyLeft, 0},
    {kPortalVein, Axis::kAnterior, kKidneyRight, 0},
    {kColon, Axis::kAnterior, kVertebra, 10},
    {kColon, Axis::kAnterior, kKidneyRight, -5},
    {kSmallBowel, Axis::kAnterior, kKidneyLeft, 0},
    {kSmallBowel, Axis::kAnterior, kVertebra, 10},
    {kStomach, Axis::kCranial, kSmallBowel, 10},
    {kSpleen, Axis::kCranial, kSmallBowel, 10},
    {kVertebraL3, Axis::kCranial, kVertebraL4, 15},
    {kVertebraL4, Axis::kCranial, kSacrum, 15},
    {kAorta, Axis::kAnterior, kVertebraL3, 5},
    {kVenaCava, Axis::kAnterior, kVertebraL3, 5}};

/// Smaller than the liver in everybody whose liver is whole.
constexpr Structure kSmallerThanLiver[] = {kGallbladder, kSpleen,       kPancreas, kKidneyRight, kKidneyLeft,
                                           kDuodenum,    kAdrenalLeft,  kVenaCava, kAorta,       kPortalVein,
                                           kEsophagus,   kAdrenalRight, kVertebra, kVertebraL3,  kRibsRight,
                                           kRibsLeft,    kBladder,      kHeart};

/// Nothing else that is not in or behind the liver has so much of its surface at it as the gallbladder has.
constexpr Structure kLessAtLiver[] = {kStomach, kDuodenum,   kColon,       kSmallBowel, kPancreas,
                                      kSpleen,  kKidneyLeft, kKidneyRight, kEsophagus,  kAorta};

// Measured (label_sights, 3 mm): 0.26 to 0.43 in the Visible Human and generated patients, also cropped, oblique and warped.
constexpr double kLeastContact = 0.04, kMostContact = 0.70;
constexpr double kLeastLesionContact = 0.55;  // a lesion lies in the liver
constexpr double kMostLesionElongation = 2.5;
constexpr double kMostKidneyContact = 0.40;
// Measured: 1.9 to 3.6. A ball beside the liver may be a shrunken gallbladder or a cyst.
constexpr double kLeastElongation = 1.2, kMostElongation = 7.0;
constexpr double kLeastPart =
    0.45;  // of the gallbladder in one piece; two halves are for CheckParts to judge
constexpr double kMostAsideMm =
    90.0;  // of the gallbladder from the liver's middle, to either side; measured: 22
constexpr double kMostLengthMm = 220.0;  // along one axis
constexpr double kMostOfLiver = 0.35;    // of its volume

std::string Number(double value, const char* form = "%.0f") {
  char text[32];
  std::snprintf(text, sizeof text, form, value);
  return text;
}
std::string Ml(double value) {
  return Number(value, value < 10 ? "%.2g" : "%.0f");
}
std::string Spoken(Structure structure) {
  return roles::SpokenName(NameOf(structure));
}

class Court {
 public:
  Court(const LabelSights& sights, const Meanings& meanings, bool mirrored)
      : sights_(sights), meanings_(meanings), mirrored_(mirrored) {
    for (const auto& [label, structure] : meanings) {
      const LabelSight* sight = sights.Find(label);
      const bool is_organ = structure == kLiver || structure == kGallbladder;
      if (sight != nullptr && (is_organ || sight->volume_ml >= kSpeckMl)) labels_[structure].push_back(label);
    }
  }

  std::vector<std::string> Judge() {
    const int liver = LabelOf(meanings_, kLiver), gallbladder = LabelOf(meanings_, kGallbladder);
    JudgeVolumes();
    JudgeLongVessels();
    if (liver != 0) JudgeLiver(liver);
    if (liver != 0 && gallbladder != 0) JudgeGallbladder(liver, gallbladder);
    if (liver != 0) JudgeLesions(liver);
    JudgeOrders();
    JudgeDensities();
    return std::move(against_);
  }

 private:
  const LabelSight& Sight(int label) const { return sights_.labels.at(label); }
  std::string Would(int label) const {
    return "label " + std::to_string(label) + " would be the " + Spoken(meanings_.at(label)) + ", and ";
  }
  /// Along left, cranial, anterior.
  double Offset(int a, int b, Axis axis) const {
    const auto at = static_cast<int>(axis);
    const double offset = Sight(a).centre[at] - Sight(b).centre[at];
    return axis == Axis::kLeft && mirrored_ ? -offset : offset;
  }

  void JudgeVolumes() {
    for (const VolumeRange& range : kVolumes) {
      for (const int label : labels_[range.structure]) {
        const double ml = Sight(label).volume_ml;
        const bool may_be_cut =
            Sight(label).is_at_border && range.structure != kLiver && range.structure != kGallbladder;
        if ((ml >= range.least_ml || may_be_cut) && ml <= range.most_ml) continue;
        against_.push_back(Would(label) + "has " + Ml(ml) + " mL; " + Ml(range.least_ml) + " to " +
                           Ml(range.most_ml) + " mL are possible");
      }
    }
  }

  /// They run along the spine, whatever the map cuts off them.
  void JudgeLongVessels() {
    for (const Structure structure : {kAorta, kVenaCava, kEsophagus}) {
      for (const int label : labels_[structure]) {
        const math::Vec3 length = Sight(label).max - Sight(label).min;
        if (length.y < length.x && !Sight(label).is_at_border)
          against_.push_back(Would(label) + "does not run up and down");
      }
    }
  }

  void JudgeLiver(int liver) {
    for (const Structure smaller : kSmallerThanLiver) {
      for (const int label : labels_[smaller]) {
        if (Sight(label).volume_ml < Sight(liver).volume_ml) continue;
        against_.push_back(Would(liver) + "is smaller than label " + std::to_string(label) +
                           ", which would be the " + Spoken(smaller));
      }
    }
    for (const Structure kidney : {kKidneyRight, kKidneyLeft, kKidneys}) {
      for (const int label : labels_[kidney]) {
        if (Sight(label).ContactWith(liver) <= kMostKidneyContact) continue;
        against_.push_back(Would(label) + "lies in the liver");
      }
    }
  }

  void JudgeGallbladder(int liver, int gallbladder) {
    const LabelSight &it = Sight(gallbladder), &organ = Sight(liver);
    const double contact = it.ContactWith(liver);
    const auto object = [&](const std::string& what) { against_.push_back(Would(gallbladder) + what); };
    if (contact < kLeastContact) object("does not lie at the liver");
    if (contact > kMostContact)
      object("lies inside the liver with " + Number(100 * contact) +
             " % of its surface, as a tumour or a cyst does");
    if (it.volume_ml > kMostOfLiver * organ.volume_ml) object("is too large beside that liver");
    if (it.largest_part < kLeastPart) object("is in several pieces");
    const bool is_whole = it.largest_part > 0.9;
    if (is_whole && it.elongation < kLeastElongation) object("is as round as a cyst");
    if (is_whole && it.elongation > kMostElongation) object("is too long and thin");
    if (std::fabs(Offset(gallbladder, liver, Axis::kLeft)) > kMostAsideMm)
      object("lies too far beside the liver's middle");
    const math::Vec3 length = it.max - it.min;
    if (std::max({length.x, length.y, length.z}) > kMostLengthMm) object("is too long");
    for (const Structure other : kLessAtLiver) {
      for (const int label : labels_[other]) {
        if (Sight(label).ContactWith(liver) <= contact) continue;
        object("has less of its surface at the liver than label " + std::to_string(label) +
               ", which would be the " + Spoken(other));
      }
    }
  }

  void JudgeLesions(int liver) {
    for (const int label : labels_[kLiverLesion]) {
      const LabelSight& lesion = Sight(label);
      if (lesion.ContactWith(liver) < kLeastLesionContact) {
        against_.push_back(Would(label) + "does not lie in the liver");
      } else if (lesion.largest_part > 0.95 && lesion.elongation > kMostLesionElongation) {
        against_.push_back(Would(label) + "is too long and thin");
      }
    }
  }

  void JudgeOrders() {
    constexpr const char* kSaid[3] = {"to the left of", "above", "in front of"};
    for (const Order& order : kOrders) {
      for (const int a : labels_[order.a]) {
        for (const int b : labels_[order.b]) {
          if (Offset(a, b, order.axis) >= order.least_mm) continue;
          against_.push_back(Would(a) + "does not lie " + kSaid[static_cast<int>(order.axis)] + " label " +
                             std::to_string(b) + ", which would be the " + Spoken(order.b));
        }
      }
    }
  }

  void JudgeDensities() {
    for (const DensityRange& range : kDensities) {
      for (const int label : labels_[range.structure]) {
        const auto& hu = Sight(label).density_hu;
        if (!hu || (*hu >= range.least_hu && *hu <= range.most_hu)) continue;
        against_.push_back(Would(label) + "has " + Number(*hu) + " HU in the images; " +
                           Number(range.least_hu) + " to " + Number(range.most_hu) + " HU are usual");
      }
    }
  }

  const LabelSights& sights_;
  const Meanings& meanings_;
  bool mirrored_;
  std::map<Structure, std::vector<int>> labels_;
  std::vector<std::string> against_;
};

}  // namespace

std::vector<std::string> FindContradictions(const LabelSights& sights, const Meanings& meanings,
                                            bool mirrored) {
  return Court(sights, meanings, mirrored).Judge();
}

int LabelOf(const Meanings& meanings, Structure structure) {
  int found = 0;
  for (const auto& [label, meaning] : meanings) {
    if (meaning != structure) continue;
    if (found != 0) return 0;
    found = label;
  }
  return found;
}

std::string DescribeGallbladder(const LabelSights& sights, int liver, int gallbladder) {
  const LabelSight *organ = sights.Find(liver), *it = sights.Find(gallbladder);
  if (organ == nullptr || it == nullptr) return "";
  const math::Vec3 offset = it->centre - organ->centre;
  const std::string density = it->density_hu ? Number(*it->density_hu) + " HU, " : "";
  return Ml(it->volume_ml) + " mL, " + density + Number(100 * it->ContactWith(liver)) +
         " % of its surface at the liver, " + Number(std::fabs(offset.y)) +
         (offset.y > 0 ? " mm above and " : " mm below and ") + Number(std::fabs(offset.z)) +
         (offset.z < 0 ? " mm behind the liver's middle" : " mm in front of the liver's middle");
}

}  // namespace trocar::anatomy
