// SPDX-License-Identifier: Apache-2.0
// Source of what parts a series: 3D Slicer's DICOMScalarVolumePlugin (a series is split where it is no volume as a whole, and is one in
// parts), dcm2niix' notes on stacking; DICOM PS3.3 sections C.7.3.1, C.7.6.1 and C.7.6.16.
#include "dicom_volumes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"

namespace trocar::images {
namespace {

using base::Error;
using base::ErrorCode;
using Pictures = std::vector<const DicomSlice*>;

constexpr std::size_t kMostListed = 8;
constexpr std::size_t kLeastInterleaved = 3;  // slices of a volume that is hidden in another
constexpr double kMostOverlap = 1.5;          // extents of the parts, in that of the whole

struct KeyName {
  DicomKey key;
  const char* name;
  double scale;      // of the value that is told; 0: it is a hash
  const char* unit;  // with its blank
  bool
      can_interleave;  // slices of different values between each other are two volumes, even if they fit as one
};
constexpr KeyName kKeys[] = {{DicomKey::kTemporalPosition, "temporal position", 1, "", true},
                             {DicomKey::kAcquisition, "acquisition", 1, "", true},
                             {DicomKey::kEcho, "echo", 1, "", true},
                             {DicomKey::kEchoTime, "echo time", 1e-3, " ms", true},
                             {DicomKey::kDiffusion, "b-value", 1e-3, "", true},
                             {DicomKey::kTriggerTime, "trigger time", 1e-3, " ms", false},
                             {DicomKey::kVoltage, "tube voltage", 1e-3, " kV", true},
                             {DicomKey::kStack, "stack", 0, "", false},
                             {DicomKey::kImageType, "image type", 0, "", false},
                             {DicomKey::kKernel, "kernel", 0, "", true},
                             {DicomKey::kAgent, "contrast agent", 0, "", true}};
constexpr KeyName kTimes[] = {{DicomKey::kAcquisitionTime, "acquisition time", 0, "", false},
                              {DicomKey::kContentTime, "content time", 0, "", false}};

/// How TranslateComposed finds what the names of parts and lists of volumes are made of.
[[maybe_unused]] constexpr const char* kShownPatterns[] = {host::Mark("{1}, temporal position {2}"),
                                                           host::Mark("{1}, acquisition {2}"),
                                                           host::Mark("{1}, echo {2}"),
                                                           host::Mark("{1}, echo time {2}"),
                                                           host::Mark("{1}, echo time {2} ms"),
                                                           host::Mark("{1}, b-value {2}"),
                                                           host::Mark("{1}, trigger time {2}"),
                                                           host::Mark("{1}, trigger time {2} ms"),
                                                           host::Mark("{1}, tube voltage {2}"),
                                                           host::Mark("{1}, tube voltage {2} kV"),
                                                           host::Mark("{1}, stack {2}"),
                                                           host::Mark("{1}, image type {2}"),
                                                           host::Mark("{1}, kernel {2}"),
                                                           host::Mark("{1}, contrast agent {2}"),
                                                           host::Mark("{1}, acquisition time {2}"),
                                                           host::Mark("{1}, content time {2}"),
                                                           host::Mark("{1}, order of instance numbers, {2}"),
                                                           host::Mark("{1}, localizer"),
                                                           host::Mark("{1}, of another patient"),
                                                           host::Mark("{1}, in another frame of reference"),
                                                           host::Mark("{1}, {2} x {3} pixels"),
                                                           host::Mark("{1}, of other pixels"),
                                                           host::Mark("{1}, turned or with pixels of {2} mm"),
                                                           host::Mark("{1} of {2}"),
                                                           host::Mark("not said"),
                                                           host::Mark("and {1} more"),
                                                           host::Mark("{1}, slices: {2}"),
                                                           host::Mark("{1} ({2}, slices: {3}); {4}"),
                                                           host::Mark("{1} ({2}, slices: {3})"),
                                                           host::Mark("{1} (slices: {2}); {3}"),
                                                           host::Mark("{1} (slices: {2})")};

std::int64_t KeyOf(const DicomSlice& slice, DicomKey key) {
  return slice.header.keys[static_cast<std::size_t>(key)];
}

/// Some slices of a series and what sets them apart.
struct Part {
  Pictures slices;
  std::string name;
};

void AddName(std::string& names, const std::string& name) {
  if (!name.empty()) names += (names.empty() ? "" : ", ") + name;
}

std::string CountedName(const char* name, std::size_t i, std::size_t count) {
  return std::string(name) + " " + std::to_string(i + 1) + " of " + std::to_string(count);
}

/// By value, ascending; hashes in the order of their first slices.
std::vector<Part> PartByKey(const Pictures& slices, const KeyName& key) {
  std::vector<std::pair<std::int64_t, Part>> parts;
  for (const DicomSlice* slice : slices) {
    const std::int64_t value = KeyOf(*slice, key.key);
    auto same =
        std::find_if(parts.begin(), parts.end(), [&](const auto& part) { return part.first == value; });
    if (same == parts.end()) same = parts.insert(parts.end(), {value, {}});
    same->second.slices.push_back(slice);
  }
  if (key.scale > 0)
    std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Part> result;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Part& part = parts[i].second;
    if (parts[i].first == kKeyNotSaid) {
      part.name = std::string(key.name) + " not said";
    } else if (key.scale > 0) {
      char value[48];
      std::snprintf(value, sizeof(value), " %.6g", key.scale * static_cast<double>(parts[i].first));
      part.name = std::string(key.name) + value + key.unit;
    } else {
      part.name = CountedName(key.name, i, parts.size());
    }
    result.push_back(std::move(part));
  }
  return result;
}

/// The largest number of slices that lie in one place.
std::size_t CountAtOnePlace(const Pictures& slices) {
  std::vector<std::size_t> counts(slices.size());
  for (const std::size_t place : FindPlaces(slices)) ++counts[place];
  return *std::max_element(counts.begin(), counts.end());
}

bool AreAllVolumes(const std::vector<Part>& parts) {
  return std::all_of(parts.begin(), parts.end(), [](const Part& part) {
    return part.slices.size() > 1 && OrderDicomSlices(part.slices).ok();
  });
}

/// How far is enough: every part is a volume, or at least no two slices of it lie in one place.
enum class Goal { kVolumes, kNoDoubles };

/// Parts by one key, and by further ones where those are still several volumes; nothing where no keys tell them apart.
std::optional<std::vector<Part>> PartByKeys(const Pictures& slices, std::size_t first_key, Goal goal) {
  const std::size_t at_one_place = CountAtOnePlace(slices);
  const bool is_done = goal == Goal::kVolumes ? OrderDicomSlices(slices).ok() : at_one_place == 1;
  if (is_done) return std::vector<Part>{{slices, ""}};
  for (std::size_t k = first_key; k < std::size(kKeys); ++k) {
    const std::vector<Part> parts = PartByKey(slices, kKeys[k]);
    // a value for nearly every slice tells no volumes apart
    if (parts.size() < 2 || parts.size() > 2 * std::max<std::size_t>(at_one_place, 2)) continue;
    std::vector<Part> found;
    bool are_told_apart = true;
    for (const Part& part : parts) {
      auto inside = PartByKeys(part.slices, k + 1, goal);
      if (!inside) {
        are_told_apart = false;
        break;
      }
      for (Part& one : *inside) {
        std::string name = part.name;
        AddName(name, one.name);
        found.push_back({std::move(one.slices), std::move(name)});
      }
    }
    if (are_told_apart) return found;
  }
  return std::nullopt;
}

/// The first at each place, the second at each place, ... by the order given; nothing where some places have fewer.
std::vector<Part> PartByOccurrence(const Pictures& ordered, std::size_t count, const char* name) {
  std::vector<Part> parts(count);
  for (std::size_t i = 0; i < count; ++i) parts[i].name = CountedName(name, i, count);
  const std::vector<std::size_t> places = FindPlaces(ordered);
  std::vector<std::size_t> seen(ordered.size());
  for (std::size_t i = 0; i < ordered.size(); ++i) parts[seen[places[i]]++].slices.push_back(ordered[i]);
  for (const Part& part : parts) {
    if (part.slices.size() != parts[0].slices.size()) return {};
  }
  return parts;
}

/// By times: cut where nothing was taken for longest, else one sweep after the other.
std::optional<std::vector<Part>> PartByTimes(const Pictures& slices) {
  const std::size_t count = CountAtOnePlace(slices);
  for (const KeyName& key : kTimes) {
    Pictures ordered = slices;
    const auto time = [&](const DicomSlice* slice) { return KeyOf(*slice, key.key); };
    if (std::any_of(slices.begin(), slices.end(),
                    [&](const auto* slice) { return time(slice) == kKeyNotSaid; }))
      continue;
    std::stable_sort(ordered.begin(), ordered.end(),
                     [&](const auto* a, const auto* b) { return time(a) < time(b); });
    std::vector<std::pair<std::int64_t, std::size_t>> pauses;
    for (std::size_t i = 1; i < ordered.size(); ++i)
      pauses.push_back({time(ordered[i]) - time(ordered[i - 1]), i});
    std::sort(pauses.rbegin(), pauses.rend());
    if (pauses.size() + 1 < count || pauses[count - 2].first == 0) continue;
    std::vector<std::size_t> cuts = {0, ordered.size()};
    for (std::size_t i = 0; i + 1 < count; ++i) cuts.push_back(pauses[i].second);
    std::sort(cuts.begin(), cuts.end());
    std::vector<Part> parts;
    for (std::size_t i = 0; i < count; ++i) {
      parts.push_back({{ordered.begin() + static_cast<std::ptrdiff_t>(cuts[i]),
                        ordered.begin() + static_cast<std::ptrdiff_t>(cuts[i + 1])},
                       CountedName(key.name, i, count)});
    }
    if (AreAllVolumes(parts)) return parts;
    parts = PartByOccurrence(ordered, count, key.name);
    if (!parts.empty() && AreAllVolumes(parts)) return parts;
  }
  return std::nullopt;
}

/// The last sign: of the slices at each place, the first by instance number, the second, ...
std::optional<std::vector<Part>> PartByInstances(const Pictures& slices) {
  Pictures ordered = slices;
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto* a, const auto* b) {
    return a->header.instance_number < b->header.instance_number;
  });
  for (std::size_t i = 1; i < ordered.size(); ++i) {
    if (ordered[i]->header.instance_number == ordered[i - 1]->header.instance_number) return std::nullopt;
  }
  std::vector<Part> parts = PartByOccurrence(ordered, CountAtOnePlace(slices), "order of instance numbers,");
  if (parts.empty() || !AreAllVolumes(parts)) return std::nullopt;
  return parts;
}

double ExtentOf(const Pictures& slices) {
  const auto& normal = slices[0]->header.direction[2];
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const DicomSlice* slice : slices) {
    double along = 0;
    for (int k = 0; k < 3; ++k) along += normal[k] * slice->header.origin[k];
    low = std::min(low, along), high = std::max(high, along);
  }
  return high - low;
}

/// Volumes whose slices lie between each other, so that together they pass for one.
std::optional<std::vector<Part>> PartInterleaved(const Pictures& slices) {
  for (const KeyName& key : kKeys) {
    if (!key.can_interleave) continue;
    // in magnetic resonance the slices of one volume are often acquired in several turns
    if (key.key == DicomKey::kAcquisition && slices[0]->header.is_ct == 0) continue;
    std::vector<Part> parts = PartByKey(slices, key);
    if (parts.size() < 2 || parts.size() > kMostListed) continue;
    double extents = 0;
    bool are_large = true;
    for (const Part& part : parts) {
      are_large = are_large && part.slices.size() >= kLeastInterleaved;
      extents += ExtentOf(part.slices);
    }
    if (are_large && extents > kMostOverlap * ExtentOf(slices) && AreAllVolumes(parts)) return parts;
  }
  return std::nullopt;
}

/// Slices of one kind and series.
std::vector<Part> PartStack(const Pictures& slices) {
  const auto order = OrderDicomSlices(slices);
  const bool is_doubled = CountAtOnePlace(slices) > 1;
  if (order.ok()) {
    if (auto parts = PartInterleaved(slices)) return *parts;
  } else if (is_doubled || order.error().code == ErrorCode::kImageSeriesUneven) {
    if (auto parts = PartByKeys(slices, 0, Goal::kVolumes)) return *parts;
    if (is_doubled) {
      if (auto parts = PartByTimes(slices)) return *parts;
      if (auto parts = PartByInstances(slices)) return *parts;
      if (auto parts = PartByKeys(slices, 0, Goal::kNoDoubles)) return *parts;
    }
  }
  return {{slices, ""}};
}

/// How a stack of slices differs from the first of its series.
std::string NameKind(const ImageHeader& first, const ImageHeader& other) {
  if (other.is_localizer != 0) return "localizer";
  if (first.patient_hash != other.patient_hash) return "of another patient";
  if (first.frame_hash != other.frame_hash) return "in another frame of reference";
  if (first.width != other.width || first.height != other.height)
    return std::to_string(other.width) + " x " + std::to_string(other.height) + " pixels";
  if (first.channels != other.channels || first.samples != other.samples ||
      first.is_inverted != other.is_inverted)
    return "of other pixels";
  if (FindDifference(first, other) != nullptr) {
    char text[64];
    std::snprintf(text, sizeof(text), "turned or with pixels of %.3g mm", other.spacing[0]);
    return text;
  }
  return {};
}

/// FNV-1a.
void AddTo(std::uint64_t& hash, std::uint64_t number) {
  for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (number >> (8 * byte) & 0xFF)) * 1099511628211ull;
}

int MakeId(const DicomVolume& volume) {
  const ImageHeader& header = volume.slices[0].header;
  std::uint64_t hash = 14695981039346656037ull;
  AddTo(hash, header.series_hash);
  for (const std::uint32_t number : {header.width, header.height, header.is_localizer}) AddTo(hash, number);
  for (int axis = 0; axis < 2; ++axis) {
    for (int k = 0; k < 3; ++k)
      AddTo(hash,
            static_cast<std::uint64_t>(base::RoundTo<std::int64_t>(100 * header.direction[axis][k]) + 1000));
  }
  for (const char c : volume.part) AddTo(hash, static_cast<unsigned char>(c));
  constexpr std::uint64_t kLeast = 100001, kGreatest = 999999999;
  return static_cast<int>(kLeast + hash % (kGreatest - kLeast + 1));
}

std::string ListVolumes(std::span<const DicomVolume> volumes) {
  std::string list;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    if (i == kMostListed) return list + "; and " + std::to_string(volumes.size() - i) + " more";
    list += (list.empty() ? "" : "; ") + std::to_string(volumes[i].number) + " (" +
            DescribeVolume(volumes[i]) + ")";
  }
  return list;
}

}  // namespace

std::vector<DicomVolume> SplitVolumes(std::span<const DicomSlice> slices,
                                      std::span<const DicomSlice> placeless) {
  std::vector<const DicomSlice*> all;
  for (const auto some : {slices, placeless}) {
    for (const DicomSlice& slice : some) all.push_back(&slice);
  }
  if (!placeless.empty())
    std::stable_sort(all.begin(), all.end(), [](const auto* a, const auto* b) { return a->file < b->file; });
  std::vector<Pictures> series;
  std::map<std::uint64_t, std::size_t> index_of;
  for (const DicomSlice* slice : all) {
    const auto [at, is_new] = index_of.emplace(slice->header.series_hash, series.size());
    if (is_new) series.emplace_back();
  }
  for (const DicomSlice& slice : slices) series[index_of[slice.header.series_hash]].push_back(&slice);
  std::vector<DicomVolume> first, further;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Pictures& one = series[i];
    std::vector<Part> stacks;
    for (const DicomSlice* slice : one) {
      auto same = std::find_if(stacks.begin(), stacks.end(), [&](const Part& stack) {
        return FindDifference(stack.slices[0]->header, slice->header) == nullptr;
      });
      if (same == stacks.end()) same = stacks.insert(same, Part{{}, NameKind(one[0]->header, slice->header)});
      same->slices.push_back(slice);
    }
    bool is_first = true;
    for (const Part& stack : stacks) {
      for (const Part& part : PartStack(stack.slices)) {
        DicomVolume volume;
        // the first stack of a series needs a name only where it is a localizer or comes in parts
        AddName(volume.part, stack.name);
        AddName(volume.part, part.name);
        for (const DicomSlice* slice : part.slices) volume.slices.push_back(*slice);
        volume.order = OrderDicomSlices(part.slices);
        volume.is_volume = stack.slices[0]->header.is_localizer == 0 && part.slices.size() > 1 &&
                           CountAtOnePlace(part.slices) < part.slices.size();
        volume.id = MakeId(volume);
        volume.number = static_cast<int>(is_first ? i + 1 : series.size() + further.size() + 1);
        (is_first ? first : further).push_back(std::move(volume));
        is_first = false;
      }
    }
  }
  for (DicomVolume& volume : further) first.push_back(std::move(volume));
  return first;
}

std::string DescribeVolume(const DicomVolume& volume) {
  std::string text = host::Printable(volume.slices[0].header.description, 80);
  AddName(text, volume.part);
  AddName(text, "slices: " + std::to_string(volume.slices.size()));
  return text;
}

base::Result<std::size_t> ChooseVolume(std::span<const DicomVolume> volumes, int number, std::string& note) {
  note.clear();
  if (number > 0) {
    for (std::size_t i = 0; i < volumes.size(); ++i) {
      if (volumes[i].number == number || volumes[i].id == number) return i;
    }
    return Error{ErrorCode::kImageSliceMissing, "there is no series " + std::to_string(number) +
                                                    "; the folder holds " + ListVolumes(volumes)};
  }
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    if (volumes[i].is_volume) candidates.push_back(i);
  }
  if (candidates.empty() && volumes.size() == 1) return 0;
  if (candidates.size() == 1) {
    const std::size_t chosen = candidates[0];
    if (volumes.size() == 1) return chosen;
    std::vector<DicomVolume> others;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
      if (i != chosen) others.push_back(volumes[i]);
    }
    note = Note("series " + std::to_string(volumes[chosen].number) + " (" + DescribeVolume(volumes[chosen]) +
                ") was taken, because it alone is a volume; beside it: " + ListVolumes(others));
    return chosen;
  }
  return Error{ErrorCode::kImageSeriesMixed, "the folder holds " + std::to_string(volumes.size()) +
                                                 " series or parts of series: " + ListVolumes(volumes) +
                                                 "; choose one with --series"};
}

}  // namespace trocar::images
