// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "label_evidence.h"
#include "label_neighbours.h"
#include "label_plausibility.h"
#include "label_schemes.h"
#include "label_sights.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/host/printable.h"
#include "trocar/roles/roles.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;

Error Mismatch(const std::string& why) {
  return {ErrorCode::kLabelsMismatch, why};
}

/// A name of a label that occurs.
struct NamedLabel {
  int label = 0;
  std::string name;
  Structure structure = Structure::kUnknown;
};

/// The organ to operate on that a structure is or belongs to, else kOther.
Structure OrganOf(Structure structure) {
  switch (structure) {
    case Structure::kLiver:
    case Structure::kLiverPart:
    case Structure::kLiverLesion:
    case Structure::kLiverVessel:
      return Structure::kLiver;
    case Structure::kGallbladder:
    case Structure::kGallbladderPart:
      return Structure::kGallbladder;
    default:
      return Structure::kOther;
  }
}

/// Whether a name beside it may say more: which side, or which part.
bool IsCoarse(Structure structure) {
  using enum Structure;
  constexpr Structure kCoarse[] = {kLiver, kGallbladder, kKidneys, kAdrenals, kLungs, kRibs, kVertebra};
  return std::find(std::begin(kCoarse), std::end(kCoarse), structure) != std::end(kCoarse);
}

/// A scheme that has every label of the map and a liver among them.
struct Candidate {
  const LabelScheme* scheme = nullptr;
  Meanings meanings;
  int liver = 0, gallbladder = 0;
  std::vector<std::string> against;
};

class Decision {
 public:
  Decision(const images::LabelVolume& volume, const LabelOptions& options, const VoxelFrame& frame,
           const LabelDensities& densities)
      : volume_(volume), options_(options), frame_(frame), sights_(LookAtLabels(volume, frame)) {
    AddDensities(densities, sights_);
    for (const auto& [name, label] : volume.names) {
      if (IsPlaceholder(name)) continue;
      has_names_ = true;
      if (Occurs(label)) named_.push_back({label, name, FindStructure(name)});
    }
    for (const auto& [code, label] : volume.codes) {
      if (IsGenericCode(code)) continue;
      has_names_ = true;
      if (Occurs(label)) AddCode(label, code);
    }
  }

  base::Result<OrganLabels> Make() {
    if (sights_.labels.empty()) {
      const std::size_t count = FindLabelBoxes(volume_).size();
      if (count == 0) return Mismatch("the label map holds no label at all; choose another file");
      return Mismatch(
          "it has " + std::to_string(count) +
          " different values, more than a segmentation has labels; name a label map, not an image");
    }
    if (options_.liver != 0 && options_.gallbladder != 0) return ByRequest();
    return has_names_ ? ByNames() : ByNumbers();
  }

 private:
  static void AddDensities(const LabelDensities& densities, LabelSights& sights) {
    for (const auto& [label, hu] : densities) {
      if (const auto sight = sights.labels.find(label); sight != sights.labels.end())
        sight->second.density_hu = hu;
    }
  }

  bool Occurs(int label) const { return sights_.Find(label) != nullptr; }

  /// A code of SNOMED decides where the name beside it is free text. A name that is known to mean another organ contradicts it, unless it
  /// only says more, as "liver tumour" does beside the code of the liver.
  void AddCode(int label, const std::string& code) {
    const Structure coded = FindCodedStructure(code);
    bool is_named = false;
    for (NamedLabel& one : named_) {
      if (one.label != label) continue;
      is_named = true;
      if (coded == Structure::kUnknown || one.structure == coded) continue;
      if (one.structure == Structure::kUnknown) {
        one.structure = coded;
      } else if (OrganOf(one.structure) != OrganOf(coded)) {
        contradiction_ = "label " + std::to_string(label) + " is called \"" + host::Printable(one.name, 40) +
                         "\", and its code " + host::Printable(code, 40) + " means the " +
                         roles::SpokenName(NameOf(coded));
      } else if (!IsCoarse(coded)) {
        one.structure = coded;
      }
    }
    if (!is_named) named_.push_back({label, "code " + code, coded});
  }
  bool Is(int label, std::initializer_list<Structure> wanted, const Meanings& meanings) const {
    const auto found = meanings.find(label);
    return found != meanings.end() && std::find(wanted.begin(), wanted.end(), found->second) != wanted.end();
  }

  /// "1, 2, 5", the first of them where there are many.
  std::string ListLabels() const {
    constexpr std::size_t kMostNamed = 20;
    std::string text;
    std::size_t named = 0;
    for (const auto& [label, sight] : sights_.labels) {
      if (named++ == kMostNamed) return text + ", ...";
      text += (text.empty() ? "" : ", ") + std::to_string(label);
    }
    return text;
  }

  /// Whether a map shows the chest: by its names, or because most of it are lungs by the numbers of a scheme that all labels fit.
  bool IsOfChest() const {
    for (const NamedLabel& one : named_) {
      for (const Structure structure :
           {Structure::kLungs, Structure::kLungLeft, Structure::kLungRight, Structure::kHeart}) {
        if (one.structure == structure) return true;
      }
    }
    if (has_names_) return false;
    return std::any_of(LabelSchemes().begin(), LabelSchemes().end(), [&](const LabelScheme& scheme) {
      double all = 0, lungs = 0;
      for (const auto& [label, sight] : sights_.labels) {
        if (!scheme.Holds(label)) return false;
        all += sight.volume_ml;
        if (Is(label, {Structure::kLungs, Structure::kLungLeft, Structure::kLungRight}, scheme.numbers))
          lungs += sight.volume_ml;
      }
      return 2 * lungs > all;
    });
  }

  /// What it means that an organ's label is not there.
  std::string ExplainAbsence(bool is_liver_there) const {
    const bool is_of_chest = IsOfChest();
    if (is_liver_there) {
      return std::string(". Where the gallbladder was taken out before") +
             (is_of_chest ? ", or a scan of the chest ends above it" : "") +
             ", there is nothing to take out: operate on a patient who has one (trocar anatomy generate), or "
             "practise without a patient (trocar play --list names the tasks)";
    }
    return is_of_chest ? ". It looks like a map of the chest, with lungs or a heart: take one of the abdomen"
                       : ". If the map shows another region of the body, take one of the abdomen";
  }

  Error Ask(const std::string& why, const std::string& absence = "") const {
    return Mismatch("which labels are liver and gallbladder is not certain: " + why + ". Seen are " +
                    ListSights(sights_) +
                    ". Say which is which with --names, or with --liver and --gallbladder" + absence);
  }

  /// What of the map's names is understood. The gallbladder's and the liver's labels are those that are given.
  Meanings NamedMeanings(int liver, int gallbladder) const {
    Meanings meanings;
    for (const NamedLabel& one : named_) {
      const bool is_organ = one.structure == Structure::kLiver || one.structure == Structure::kGallbladder;
      if (one.structure != Structure::kUnknown && !is_organ) meanings.emplace(one.label, one.structure);
    }
    meanings[liver] = Structure::kLiver, meanings[gallbladder] = Structure::kGallbladder;
    return meanings;
  }

  base::Result<OrganLabels> ByRequest() {
    const int liver = options_.liver, gallbladder = options_.gallbladder;
    if (auto status = CheckOccur(liver, gallbladder, "named on request"); !status.ok()) return status.error();
    Meanings meanings = NamedMeanings(liver, gallbladder);
    if (!has_names_) {
      for (const Candidate& candidate : FindCandidates()) {
        if (candidate.liver != liver || candidate.gallbladder != gallbladder || !candidate.against.empty())
          continue;
        meanings = candidate.meanings;
        break;
      }
    }
    return Conclude(liver, gallbladder, std::move(meanings), {}, "named on request", "named on request",
                    "named on request");
  }

  base::Status CheckOccur(int liver, int gallbladder, const std::string& convention) const {
    const std::pair<const char*, int> both[] = {{NameOf(roles::OrganRole::kLiver), liver},
                                                {NameOf(roles::OrganRole::kGallbladder), gallbladder}};
    for (const auto& [name, label] : both) {
      if (Occurs(label)) continue;
      return Mismatch("the label map has no label " + std::to_string(label) + ", which should be the " +
                      name + " (found by: " + convention + "); it has " + ListLabels() +
                      "; name the right one with --" + name + ExplainAbsence(Occurs(liver)));
    }
    if (liver == gallbladder) {
      return Mismatch("liver and gallbladder have the same label " + std::to_string(liver) +
                      "; name two different ones");
    }
    return {};
  }

  base::Result<OrganLabels> ByNames() {
    if (!contradiction_.empty()) return Ask(contradiction_);
    // a table that a person gives may call several labels the same, and means one organ
    const bool may_join = !options_.names.empty();
    std::set<int> livers, gallbladders, parts, stones;
    std::map<int, Structure> seen;
    for (const NamedLabel& one : named_) {
      const auto [before, is_new] = seen.emplace(one.label, one.structure);
      if (!is_new && before->second != one.structure && one.structure != Structure::kUnknown) {
        if (before->second == Structure::kUnknown) {
          before->second = one.structure;
        } else {
          return Ask("label " + std::to_string(one.label) + " has two names that mean different things");
        }
      }
    }
    for (const auto& [label, structure] : seen) {
      if (structure == Structure::kLiver) livers.insert(label);
      if (structure == Structure::kGallbladder) gallbladders.insert(label);
      if (structure == Structure::kLiverPart || structure == Structure::kLiverLesion) parts.insert(label);
      if (structure == Structure::kGallbladderPart) stones.insert(label);
    }
    if (options_.liver != 0) livers = {options_.liver};
    if (options_.gallbladder != 0) gallbladders = {options_.gallbladder};
    // lobes or segments, and nothing that is called the whole liver
    if (livers.empty()) {
      for (const int part : parts) {
        if (seen.at(part) == Structure::kLiverPart) livers.insert(part);
      }
      if (!livers.empty()) livers = {*livers.begin()};
    }
    for (const auto& [name, labels] : {std::pair{NameOf(roles::OrganRole::kLiver), &livers},
                                       {NameOf(roles::OrganRole::kGallbladder), &gallbladders}}) {
      if (labels->size() < 2 || may_join) continue;
      return Ask("labels " + std::to_string(*labels->begin()) + " and " + std::to_string(*labels->rbegin()) +
                 " are both called " + name);
    }
    if (livers.empty() || gallbladders.empty()) {
      const std::string missing =
          NameOf(livers.empty() ? roles::OrganRole::kLiver : roles::OrganRole::kGallbladder);
      std::string lesion;
      for (const int part : parts) {
        if (seen.at(part) == Structure::kLiverLesion)
          lesion = "; label " + std::to_string(part) + " is called a tumour of the liver";
      }
      return Mismatch("the label map names its labels, and none of them is the " + missing +
                      "; say which one it is with --" + missing + lesion + ". Seen are " + ListNamedSights() +
                      ExplainAbsence(!livers.empty()));
    }
    const int liver = *livers.begin(), gallbladder = *gallbladders.begin();
    if (auto status = CheckOccur(liver, gallbladder, "the map's names"); !status.ok()) return status.error();
    parts.insert(livers.begin(), livers.end());
    stones.insert(gallbladders.begin(), gallbladders.end());
    std::map<int, int> joined;
    for (const int part : parts) joined.emplace(part, liver);
    for (const int part : stones) joined.emplace(part, gallbladder);
    joined.erase(liver), joined.erase(gallbladder);
    Meanings meanings = NamedMeanings(liver, gallbladder);
    const auto reason = [&](int label, int requested) {
      return std::string(label == requested ? "named on request" : "so the map calls it");
    };
    return Conclude(liver, gallbladder, std::move(meanings), std::move(joined), "the map's names",
                    reason(liver, options_.liver), reason(gallbladder, options_.gallbladder));
  }

  /// Names and labels as the file has them, the largest first.
  std::string ListNamedSights() const {
    constexpr std::size_t kMostListed = 12;
    std::vector<std::pair<double, const NamedLabel*>> by_volume;
    for (const NamedLabel& one : named_)
      by_volume.emplace_back(-sights_.labels.at(one.label).volume_ml, &one);
    std::stable_sort(by_volume.begin(), by_volume.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::string text;
    for (std::size_t i = 0; i < by_volume.size() && i < kMostListed; ++i) {
      text += (i == 0 ? "" : ", ") + std::to_string(by_volume[i].second->label) + " \"" +
              host::Printable(by_volume[i].second->name, 40) + "\"";
    }
    if (by_volume.empty()) return ListSights(sights_);
    return text + (by_volume.size() > kMostListed ? ", ..." : "");
  }

  std::vector<Candidate> FindCandidates(bool mirrored = false) const {
    std::vector<Candidate> candidates;
    for (const LabelScheme& scheme : LabelSchemes()) {
      Candidate candidate{&scheme, {}, 0, 0, {}};
      for (const auto& [label, sight] : sights_.labels) {
        if (!scheme.Holds(label)) break;
        candidate.meanings.emplace(label, scheme.numbers.at(label));
      }
      candidate.liver = LabelOf(candidate.meanings, Structure::kLiver);
      candidate.gallbladder = LabelOf(candidate.meanings, Structure::kGallbladder);
      const bool is_wanted = (options_.liver == 0 || options_.liver == candidate.liver) &&
                             (options_.gallbladder == 0 || options_.gallbladder == candidate.gallbladder);
      if (candidate.meanings.size() != sights_.labels.size() || candidate.liver == 0 || !is_wanted) continue;
      candidate.against = FindContradictions(sights_, candidate.meanings, mirrored);
      candidates.push_back(std::move(candidate));
    }
    return candidates;
  }

  base::Result<OrganLabels> ByNumbers() {
    const std::vector<Candidate> candidates = FindCandidates();
    std::vector<const Candidate*> fitting;
    for (const Candidate& candidate : candidates) {
      if (candidate.against.empty()) fitting.push_back(&candidate);
    }
    if (fitting.empty()) return Refuse(candidates);
    const Candidate& first = *fitting.front();
    for (const Candidate* other : fitting) {
      if (other->liver == first.liver && other->gallbladder == first.gallbladder) continue;
      return Ask("by the numbers of " + Describe(first) + ", by those of " + Describe(*other) +
                 ", and sizes and places fit both");
    }
    if (first.gallbladder == 0) return WithoutGallbladder(first);
    // of the neighbours what all schemes say alike
    Meanings meanings = first.meanings;
    std::map<int, int> joined;
    std::string names;
    for (const Candidate* other : fitting) {
      std::erase_if(meanings,
                    [&](const auto& entry) { return other->meanings.at(entry.first) != entry.second; });
      names += (names.empty() ? "" : ", ") + std::string(other->scheme->name);
    }
    for (const auto& [label, structure] : meanings) {
      if (structure == Structure::kLiverLesion) joined.emplace(label, first.liver);
    }
    const std::string reason = "the numbers of " + names + ", which all labels fit";
    return Conclude(first.liver, first.gallbladder, std::move(meanings), std::move(joined),
                    "the numbers of " + names, reason, reason);
  }

  static std::string Describe(const Candidate& candidate) {
    return std::string(candidate.scheme->name) + " the liver is " + std::to_string(candidate.liver) +
           (candidate.gallbladder == 0 ? " and there is no gallbladder"
                                       : " and the gallbladder " + std::to_string(candidate.gallbladder));
  }

  Error WithoutGallbladder(const Candidate& candidate) const {
    std::string lesions;
    for (const auto& [label, structure] : candidate.meanings) {
      if (structure == Structure::kLiverLesion)
        lesions += (lesions.empty() ? "; label " : ", ") + std::to_string(label);
    }
    if (!lesions.empty()) lesions += " lies inside the liver, as a tumour or a cyst does";
    return Mismatch("the label map has a liver (label " + std::to_string(candidate.liver) +
                    ", by the numbers of " + candidate.scheme->name + ") and no gallbladder" + lesions +
                    ". Seen are " + ListSights(sights_) +
                    ". If one of them is the gallbladder, name both with --liver and --gallbladder" +
                    ExplainAbsence(true));
  }

  /// Why no scheme is taken.
  Error Refuse(const std::vector<Candidate>& candidates) const {
    if (candidates.empty()) {
      const bool is_known =
          std::any_of(LabelSchemes().begin(), LabelSchemes().end(), [&](const LabelScheme& scheme) {
            return std::all_of(sights_.labels.begin(), sights_.labels.end(),
                               [&](const auto& entry) { return scheme.Holds(entry.first); });
          });
      return Ask(is_known ? "its labels have no names, and by none of the known schemes of numbers there is "
                            "a liver; it has " +
                                ListLabels()
                          : "its labels have no names, and their numbers fit no known scheme; it has " +
                                ListLabels(),
                 ExplainAbsence(false));
    }
    // a body that is whole but mirrored, upside down or in another unit has its own message
    for (const Candidate& candidate : FindCandidates(true)) {
      if (candidate.against.empty() && candidate.gallbladder != 0) {
        if (auto status = CheckAsBody(candidate); !status.ok()) return status.error();
        return ExplainMirrored(
            "by the numbers of " + std::string(candidate.scheme->name) + " the organs lie on the wrong sides",
            options_.is_mirrored);
      }
    }
    const Candidate* best = nullptr;
    bool is_single = true;
    for (const Candidate& candidate : candidates) {
      if (candidate.gallbladder == 0) continue;
      is_single = best == nullptr;
      if (best == nullptr || candidate.against.size() < best->against.size()) best = &candidate;
    }
    if (best != nullptr && (is_single || sights_.labels.size() == 2)) {
      if (auto status = CheckAsBody(*best); !status.ok()) return status.error();
    }
    const bool has_none = best == nullptr;
    if (has_none) best = &candidates.front();
    return Ask("its labels have no names, and by the numbers of " + std::string(best->scheme->name) + " " +
                   best->against.front(),
               has_none ? ExplainAbsence(true) : "");
  }

  base::Status CheckAsBody(const Candidate& candidate) const {
    OrganLabels organs;
    organs.liver = candidate.liver, organs.gallbladder = candidate.gallbladder;
    organs.spleen = LabelOf(candidate.meanings, Structure::kSpleen);
    return CheckBody(MeasureOrgans(volume_, organs, frame_), options_.is_mirrored);
  }

  base::Result<OrganLabels> Conclude(int liver, int gallbladder, Meanings meanings, std::map<int, int> joined,
                                     std::string convention, const std::string& liver_reason,
                                     const std::string& gallbladder_reason) const {
    OrganLabels found;
    found.liver = liver, found.gallbladder = gallbladder;
    found.spleen = LabelOf(meanings, Structure::kSpleen);
    found.convention = std::move(convention);
    found.joined = std::move(joined);
    LabelSights joint;
    if (!found.joined.empty()) {
      images::LabelVolume whole = volume_;
      JoinParts(found, whole);
      joint = LookAtLabels(whole, frame_);
      for (auto& [label, sight] : joint.labels) sight.density_hu = sights_.labels.at(label).density_hu;
    }
    const LabelSights& sights = found.joined.empty() ? sights_ : joint;
    std::erase_if(meanings, [](const auto& entry) { return entry.second == Structure::kUnknown; });
    // left and right are for CheckBody to judge
    auto against = FindContradictions(sights, meanings),
         mirrored = FindContradictions(sights, meanings, true);
    if (mirrored.size() < against.size()) against = std::move(mirrored);
    const auto doubt = [&](int label) {
      const std::string subject = "label " + std::to_string(label) + " ";
      for (const std::string& clause : against) {
        if (clause.starts_with(subject)) return clause;
      }
      return std::string();
    };
    const auto take = [&](int label, Structure structure, const std::string& reason) {
      const bool is_organ = label == liver || label == gallbladder;
      found.taken.push_back({label, NameOf(structure), reason, is_organ ? doubt(label) : ""});
    };
    take(liver, Structure::kLiver, liver_reason);
    take(gallbladder, Structure::kGallbladder,
         gallbladder_reason + ": " + DescribeGallbladder(sights, liver, gallbladder));
    for (const auto& [part, organ] : found.joined)
      take(part, meanings.at(organ), "it is part of it, and joined with it");
    for (const auto& [label, structure] : meanings) {
      if (RoleOf(structure) == roles::NeighbourRole::kOther && structure != Structure::kSpleen) continue;
      take(label, structure, has_names_ ? "so the map calls it" : found.convention);
    }
    found.structures = std::move(meanings);
    return found;
  }

  const images::LabelVolume& volume_;
  const LabelOptions& options_;
  const VoxelFrame& frame_;
  LabelSights sights_;
  std::vector<NamedLabel> named_;
  bool has_names_ = false;
  std::string contradiction_;  // of a label's name and its code
};

}  // namespace

base::Result<OrganLabels> FindLabels(const images::LabelVolume& volume, const LabelOptions& options,
                                     const LabelDensities& densities) {
  const auto frame = MakeVoxelFrame(volume, options.is_mirrored);
  if (!frame.ok()) return frame.error();
  return Decision(volume, options, *frame, densities).Make();
}

void JoinParts(const OrganLabels& organs, images::LabelVolume& volume) {
  if (organs.joined.empty()) return;
  for (std::int32_t& label : volume.labels) {
    if (label == 0) continue;
    if (const auto part = organs.joined.find(label); part != organs.joined.end()) label = part->second;
  }
}

}  // namespace trocar::anatomy
