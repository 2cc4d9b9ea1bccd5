// SPDX-License-Identifier: Apache-2.0
// Codes of SNOMED CT, and those of SRT that DICOM had before. Sources: TotalSegmentator's resources/totalsegmentator_snomed_mapping.csv;
// pairs of SCT and SRT: pydicom, src/pydicom/sr/_snomed_dict.py (from DICOM PS3.16, annex O).
#include <algorithm>
#include <iterator>
#include <string_view>

#include "trocar/anatomy/structure.h"

namespace trocar::anatomy {
namespace {

using enum Structure;

constexpr std::string_view kLeft[] = {"7771000", "G-A101"}, kRight[] = {"24028007", "G-A100"};

struct Coded {
  std::string_view sct, srt;  ///< srt may be empty
  Structure structure;
  Structure right = kUnknown, left = kUnknown;  ///< with a side, where that matters
};
constexpr Coded kCodes[] = {{"10200004", "T-62000", kLiver},
                            {"28231008", "T-63000", kGallbladder},
                            {"78961009", "T-C3000", kSpleen},
                            {"69695003", "T-57000", kStomach},
                            {"38848004", "T-58200", kDuodenum},
                            {"71854001", "T-59300", kColon},
                            {"30315005", "T-58000", kSmallBowel},
                            {"15776009", "T-65000", kPancreas},
                            {"64033007", "T-71000", kKidneys, kKidneyRight, kKidneyLeft},
                            {"23451007", "T-B3000", kAdrenals, kAdrenalRight, kAdrenalLeft},
                            {"64131007", "T-48710", kVenaCava},
                            {"15825003", "T-42000", kAorta},
                            {"110765007", "", kPortalVein},
                            {"32764006", "T-48810", kPortalVein},
                            {"8993003", "T-48720", kLiverVessel},
                            {"76015000", "T-46420", kArtery},
                            {"28273000", "T-60610", kBileDuct},
                            {"32849002", "T-56000", kEsophagus},
                            {"39607008", "T-28000", kLungs, kLungRight, kLungLeft},
                            {"45653009", "", kLungs, kLungRight, kLungLeft},
                            {"90572001", "", kLungs, kLungRight, kLungLeft},
                            {"72481006", "", kLungRight},
                            {"80891009", "T-32000", kHeart},
                            {"89837001", "T-74000", kBladder},
                            {"113197003", "T-11300", kRibs, kRibsRight, kRibsLeft},
                            {"51282000", "T-11510", kVertebra},
                            {"36470004", "T-11930", kVertebraL3},
                            {"11994002", "T-11940", kVertebraL4},
                            {"54735007", "T-11AD0", kSacrum}};

/// Of what has changed an organ: neoplasm, mass, lesion, cyst.
constexpr std::string_view kChanges[] = {"108369006", "M-8FFFF", "4147007",   "M-03000",
                                         "52988006",  "M-01100", "367643001", "M-3340A"};

/// Tissue, organ, anatomical structure.
constexpr std::string_view kGeneric[] = {"85756007", "T-D0050",   "113343008",
                                         "T-D0060",  "123037004", "T-D000A"};

template <std::size_t kCount>
bool IsOneOf(const std::string_view (&codes)[kCount], std::string_view code) {
  return std::find(std::begin(codes), std::end(codes), code) != std::end(codes);
}

const Coded* FindCode(std::string_view code) {
  if (code.empty()) return nullptr;
  const auto found = std::find_if(std::begin(kCodes), std::end(kCodes),
                                  [&](const Coded& one) { return one.sct == code || one.srt == code; });
  return found == std::end(kCodes) ? nullptr : found;
}

}  // namespace

Structure FindCodedStructure(std::string_view code) {
  const std::string_view type = code.substr(0, code.find(' '));
  std::string_view side = code.substr(std::min(code.size(), type.size() + 1)), region;
  if (const auto at = side.find('@'); at != std::string_view::npos) {
    region = side.substr(at + 1);
    side = side.substr(0, at);
    if (side.ends_with(' ')) side.remove_suffix(1);
  }
  if (IsOneOf(kChanges, type)) {
    const Coded* organ = FindCode(region);
    if (organ == nullptr || organ->structure == kGallbladder) return kUnknown;
    return organ->structure == kLiver ? kLiverLesion : kOther;
  }
  const Coded* found = FindCode(type);
  if (found == nullptr) return kUnknown;
  if (found->right != kUnknown && IsOneOf(kRight, side)) return found->right;
  if (found->left != kUnknown && IsOneOf(kLeft, side)) return found->left;
  return found->structure;
}

bool IsGenericCode(std::string_view code) {
  return IsOneOf(kGeneric, code.substr(0, code.find(' ')));
}

}  // namespace trocar::anatomy
