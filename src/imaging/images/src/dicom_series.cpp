// SPDX-License-Identifier: Apache-2.0
#include "dicom_series.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "trocar/base/to_integer.h"
#include "trocar/host/printable.h"
#include "trocar/host/translate.h"
#include "trocar/math/elementary.h"

namespace trocar::images {
namespace {

using base::Error;
using base::ErrorCode;
using math::Vec3;

using Pictures = std::span<const DicomSlice* const>;

constexpr double kSameDirection = 1e-3;  // of unit vectors
constexpr double kSameSpacing = 1e-3;    // mm
constexpr double kDoubledMm = 0.01;
constexpr double kUnevenShare = 0.05;  // of the slice distance; headers round to 0.01 mm
constexpr double kShearMm = 0.5;       // sideways from the first slice to the last
constexpr double kAsideMm = 0.5;       // sideways off the line from the first slice to the last
constexpr std::size_t kLeastRun = 3;   // equal distances one after the other are meant so
constexpr double kMostStretch = 5.0;   // the longest distance that is filled, in shortest ones
constexpr std::size_t kMostNamed = 6;

Vec3 Vector(const double (&numbers)[3]) {
  return {numbers[0], numbers[1], numbers[2]};
}

std::string Millimetres(double length) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g mm", length);
  return text;
}

Error Mixed(const DicomSlice& a, const DicomSlice& b, const char* what) {
  return Error{ErrorCode::kImageSeriesMixed,
               NameSlice(a) + " and " + NameSlice(b) + " " + what +
                   "; put one series into a folder of its own, or choose one with --series"};
}

struct Placed {
  std::size_t slice;
  double along;  // the normal [mm]
};

std::vector<Placed> Place(Pictures slices) {
  const Vec3 normal = Vector(slices[0]->header.direction[2]);
  std::vector<Placed> placed;
  for (std::size_t i = 0; i < slices.size(); ++i)
    placed.push_back({i, Dot(normal, Vector(slices[i]->header.origin))});
  std::stable_sort(placed.begin(), placed.end(),
                   [](const Placed& a, const Placed& b) { return a.along < b.along; });
  return placed;
}

/// Distances of one length between neighbours, from slice `first` to slice `last`, as they are placed.
struct Run {
  std::size_t first = 0, last = 0;
  double distance = 0;  // mean [mm]
  std::size_t Count() const { return last - first; }
};

/// The distances of a series, and what they mean.
class Distances {
 public:
  Distances(Pictures slices, std::span<const Placed> placed) : slices_(slices), placed_(placed) {
    for (std::size_t i = 1; i < placed.size(); ++i) {
      const double distance = placed[i].along - placed[i - 1].along;
      if (!runs_.empty() &&
          std::fabs(distance - runs_.back().distance) <= kUnevenShare * runs_.back().distance) {
        Run& run = runs_.back();
        run.last = i;
        run.distance = (placed[i].along - placed[run.first].along) / static_cast<double>(run.Count());
      } else {
        runs_.push_back({i - 1, i, distance});
      }
    }
  }

  /// The usual one: the lower median, because a gap makes distances longer, never shorter.
  double Usual() const {
    std::vector<double> steps;
    for (std::size_t i = 1; i < placed_.size(); ++i) steps.push_back(placed_[i].along - placed_[i - 1].along);
    std::sort(steps.begin(), steps.end());
    return steps[(steps.size() - 1) / 2];
  }
  bool AreEven() const {
    const double usual = Usual();
    return std::all_of(runs_.begin(), runs_.end(),
                       [&](const Run& run) { return std::fabs(run.distance / usual - 1) <= kUnevenShare; });
  }

  /// What keeps the slices from being a volume, even one whose distances change.
  std::optional<Error> FindFault() const {
    if (auto doubled = FindDoubled()) return doubled;
    const double usual = Usual();
    std::string gaps;
    std::size_t count = 0;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const Run& run = runs_[r];
      const double ratio = run.distance / usual;
      if (std::fabs(ratio - 1) <= kUnevenShare) continue;
      const double whole = std::round(ratio);
      const bool is_multiple = whole >= 2 && std::fabs(ratio - whole) <= kUnevenShare * whole;
      const bool is_long = run.Count() >= kLeastRun;
      const bool are_missing =
          is_multiple && (is_long ? NumbersJump(run, base::TruncateTo<int>(whole)) : !NumbersGoOn(run));
      if (!are_missing) {
        if (is_long || IsTransition(r)) continue;
        return Differ(run, usual);
      }
      for (std::size_t i = run.first + 1; i <= run.last; ++i) {
        if (++count > kMostNamed) break;
        char number[32];
        std::snprintf(number, sizeof(number), "%.0f", whole - 1);
        gaps += (gaps.empty() ? "" : "; ") + std::string(number) + " between " + NameSlice(At(i - 1)) +
                " and " + NameSlice(At(i));
      }
    }
    if (count == 0) return FindTooStretched();
    return Error{
        ErrorCode::kImageSeriesGap,
        "slices are missing: " + gaps + (count > kMostNamed ? "; and more" : "") + "; get the whole series"};
  }

  double Shortest() const {
    double shortest = 0;
    for (const Run& run : runs_) {
      if (IsMeant(run) && (shortest == 0 || run.distance < shortest)) shortest = run.distance;
    }
    return shortest;
  }
  /// "2.5 mm, then 5 mm"
  std::string Describe() const {
    std::string text;
    std::size_t told = 0;
    for (const Run& run : runs_) {
      if (!IsMeant(run)) continue;
      if (++told > kMostNamed) return text + ", ...";
      text += (text.empty() ? "" : ", then ") + Millimetres(run.distance);
    }
    return text;
  }

 private:
  /// Whether it is no single distance between two stretches.
  bool IsMeant(const Run& run) const {
    return run.Count() >= kLeastRun || std::fabs(run.distance / Usual() - 1) <= kUnevenShare;
  }
  const DicomSlice& At(std::size_t i) const { return *slices_[placed_[i].slice]; }
  int Jump(std::size_t i) const {
    return std::abs(At(i).header.instance_number - At(i - 1).header.instance_number);
  }
  /// Whether the instance numbers of a run leave out as many as its distances do.
  bool NumbersJump(const Run& run, int by) const {
    for (std::size_t i = run.first + 1; i <= run.last; ++i) {
      if (Jump(i) != by) return false;
    }
    return true;
  }
  /// Whether the instance numbers follow each other, in the run as beside it.
  bool NumbersGoOn(const Run& run) const {
    const std::size_t from = run.first > 0 ? run.first : run.first + 1;
    const std::size_t to = std::min(run.last + 1, placed_.size() - 1);
    for (std::size_t i = from; i <= to; ++i) {
      if (Jump(i) != 1) return false;
    }
    return true;
  }
  /// One distance between two long runs, of a length between theirs.
  bool IsTransition(std::size_t r) const {
    if (r == 0 || r + 1 == runs_.size() || runs_[r].Count() != 1) return false;
    const Run &before = runs_[r - 1], &after = runs_[r + 1];
    const auto [low, high] = std::minmax(before.distance, after.distance);
    return before.Count() >= kLeastRun && after.Count() >= kLeastRun && runs_[r].distance > low &&
           runs_[r].distance < high;
  }
  Error Differ(const Run& run, double usual) const {
    return Error{ErrorCode::kImageSeriesUneven,
                 NameSlice(At(run.first)) + " and " + NameSlice(At(run.first + 1)) + " are " +
                     Millimetres(run.distance) + " apart, others " + Millimetres(usual) +
                     "; resample the series to even distances"};
  }
  std::optional<Error> FindDoubled() const {
    std::size_t count = 0, first = 0;
    for (std::size_t i = 1; i < placed_.size(); ++i) {
      if (placed_[i].along - placed_[i - 1].along >= kDoubledMm) continue;
      if (++count == 1) first = i;
    }
    if (count == 0) return std::nullopt;
    const std::string both = NameSlice(At(first - 1)) + " and " + NameSlice(At(first));
    if (count == 1)
      return Error{
          ErrorCode::kImageSeriesUneven,
          both +
              " lie in the same place, and their headers do not tell two volumes apart; remove one of them"};
    return Error{
        ErrorCode::kImageSeriesUneven,
        both + " lie in the same place, as do " + std::to_string(count - 1) +
            " more pairs, and their headers do not tell two volumes apart; put each volume into a folder of "
            "its own"};
  }
  std::optional<Error> FindTooStretched() const {
    const double shortest = Shortest();
    for (const Run& run : runs_) {
      if (!AreEven() && run.distance > kMostStretch * shortest) return Differ(run, shortest);
    }
    return std::nullopt;
  }

  Pictures slices_;
  std::span<const Placed> placed_;
  std::vector<Run> runs_;
};

/// Slices at even distances between those that there are.
std::vector<SlicePlace> SpreadEvenly(std::span<const Placed> placed, double step) {
  std::vector<SlicePlace> places;
  const double begin = placed.front().along, length = placed.back().along - begin;
  const auto count = base::FloorTo<std::size_t>(length / step + kUnevenShare) + 1;
  std::size_t below = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = begin + static_cast<double>(i) * step;
    while (below + 2 < placed.size() && placed[below + 1].along <= at) ++below;
    const double part = (at - placed[below].along) / (placed[below + 1].along - placed[below].along);
    const double tolerance = kUnevenShare * step / (placed[below + 1].along - placed[below].along);
    if (part <= tolerance)
      places.push_back({below, 0});
    else if (part >= 1 - tolerance)
      places.push_back({below + 1, 0});
    else
      places.push_back({below, part});
  }
  return places;
}

/// Whether the slices lie one above the other.
std::optional<Error> FindShift(Pictures slices, std::span<const Placed> placed, const Vec3& normal) {
  const auto origin = [&](std::size_t i) { return Vector(slices[placed[i].slice]->header.origin); };
  const Vec3 span = origin(placed.size() - 1) - origin(0);
  const double along = Dot(span, normal);
  const double sideways = Norm(span - along * normal);
  for (std::size_t i = 1; i + 1 < placed.size(); ++i) {
    const Vec3 from_first = origin(i) - origin(0);
    const Vec3 expected = (Dot(from_first, normal) / along) * span;
    const double aside = Norm(from_first - expected);
    if (aside <= kAsideMm) continue;
    return Error{ErrorCode::kImageSeriesUneven,
                 NameSlice(*slices[placed[i].slice]) + " lies " + Millimetres(aside) +
                     " aside of the line from the first slice to the last; resample "
                     "the series"};
  }
  if (sideways <= kShearMm) return std::nullopt;
  // what a gantry can be tilted by, to either side
  constexpr double kMostGantryTiltDeg = 31;
  const double tilt_deg = math::Atan2(sideways, std::fabs(along)) * 180 / std::numbers::pi;
  if (tilt_deg > kMostGantryTiltDeg) {
    return Error{ErrorCode::kImageSeriesUneven, "the slices are shifted against each other, by " +
                                                    Millimetres(sideways) + " in all; resample the series"};
  }
  char degrees[16];
  std::snprintf(degrees, sizeof degrees, "%.3g", tilt_deg);
  return Error{ErrorCode::kImageSeriesUneven,
               "the slices are shifted against each other, by " + Millimetres(sideways) +
                   " in all, as a gantry tilted by " + degrees +
                   " degrees leaves them; resample the series at right angles, for instance with 3D Slicer"};
}

/// Instance numbers that run along with the positions.
bool AreInstancesUsable(Pictures slices, std::span<const Placed> placed, int& sign) {
  sign = 1;
  if (placed.size() < 2) return slices[placed[0].slice]->header.instance_number >= 0;
  const auto number = [&](std::size_t i) { return slices[placed[i].slice]->header.instance_number; };
  sign = number(1) < number(0) ? -1 : 1;
  for (std::size_t i = 1; i < placed.size(); ++i) {
    if (number(i) - number(i - 1) != sign) return false;
  }
  return std::min(number(0), number(placed.size() - 1)) >= 0;
}

}  // namespace

std::string NameSlice(const DicomSlice& slice) {
  return "slice " + std::to_string(slice.header.instance_number) + " (" + host::Printable(slice.file, 80) +
         (slice.frames > 1 ? ", frame " + std::to_string(slice.frame + 1) : "") + ")";
}

const char* FindDifference(const ImageHeader& x, const ImageHeader& y) {
  if (x.patient_hash != y.patient_hash) return host::Mark("are of two patients");
  if (x.series_hash != y.series_hash) return host::Mark("are of two series");
  if (x.frame_hash != y.frame_hash) return host::Mark("have two frames of reference");
  if (x.width != y.width || x.height != y.height) return host::Mark("have different sizes");
  if (x.channels != y.channels || x.samples != y.samples || x.is_inverted != y.is_inverted)
    return host::Mark("have different kinds of pixels");
  for (int axis = 0; axis < 2; ++axis) {
    if (std::fabs(x.spacing[axis] - y.spacing[axis]) > kSameSpacing)
      return host::Mark("have pixels of different sizes");
    if (Norm(Vector(x.direction[axis]) - Vector(y.direction[axis])) > kSameDirection)
      return host::Mark("have different orientations");
  }
  if (x.is_localizer != y.is_localizer) return host::Mark("are a localizer and a slice");
  return nullptr;
}

base::Result<DicomOrder> OrderDicomSlices(std::span<const DicomSlice> slices) {
  std::vector<const DicomSlice*> pointers;
  for (const DicomSlice& slice : slices) pointers.push_back(&slice);
  return OrderDicomSlices(Pictures(pointers));
}

base::Result<DicomOrder> OrderDicomSlices(Pictures slices) {
  TROCAR_ASSERT(!slices.empty());
  for (const DicomSlice* slice : slices) {
    if (slice->header.has_position == 0 || slice->header.spacing[0] == 0) {
      return Error{ErrorCode::kImageGeometryInvalid,
                   NameSlice(*slice) +
                       " does not say where it lies (Image Position, Image Orientation, Pixel Spacing); "
                       "export the original series"};
    }
    if (const char* difference = FindDifference(slices[0]->header, slice->header))
      return Mixed(*slices[0], *slice, difference);
  }
  const Vec3 normal = Vector(slices[0]->header.direction[2]);
  std::vector<Placed> placed = Place(slices);
  DicomOrder order;
  if (placed.size() > 1) {
    const Distances distances(slices, placed);
    if (auto fault = distances.FindFault()) return *fault;
    if (auto shift = FindShift(slices, placed, normal)) return *shift;
    if (distances.AreEven()) {
      order.slice_mm = (placed.back().along - placed.front().along) / static_cast<double>(placed.size() - 1);
    } else {
      order.slice_mm = distances.Shortest();
      order.places = SpreadEvenly(placed, order.slice_mm);
      order.note = Note("its slice distance changes (" + distances.Describe() + "): slices " +
                        Millimetres(order.slice_mm) + " apart were interpolated and numbered from 1 on");
    }
  }
  int sign = 1;
  const bool is_numbered = order.places.empty() && AreInstancesUsable(slices, placed, sign);
  if (!is_numbered) sign = 1;
  if (sign < 0) std::reverse(placed.begin(), placed.end());
  order.direction = static_cast<double>(sign) * normal;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    order.slices.push_back(placed[i].slice);
    if (order.places.empty())
      order.numbers.push_back(is_numbered ? slices[placed[i].slice]->header.instance_number
                                          : static_cast<int>(i) + 1);
  }
  for (std::size_t i = 0; i < order.places.size(); ++i) order.numbers.push_back(static_cast<int>(i) + 1);
  return order;
}

std::vector<std::size_t> FindPlaces(Pictures slices) {
  const std::vector<Placed> placed = Place(slices);
  std::vector<std::size_t> places(slices.size());
  std::size_t begin = 0, place = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed[i].along - placed[begin].along >= kDoubledMm) begin = i, ++place;
    places[placed[i].slice] = place;
  }
  return places;
}

std::optional<Error> FindStrayInGap(std::span<const DicomSlice> volume, std::span<const DicomSlice> others) {
  if (volume.size() < 3) return std::nullopt;
  std::vector<const DicomSlice*> pointers;
  for (const DicomSlice& slice : volume) pointers.push_back(&slice);
  const std::vector<Placed> placed = Place(pointers);
  const double usual = Distances(pointers, placed).Usual();
  if (usual < kDoubledMm) return std::nullopt;
  for (std::size_t i = 1; i < placed.size(); ++i) {
    const DicomSlice &below = volume[placed[i - 1].slice], &above = volume[placed[i].slice];
    const Vec3 from = Vector(below.header.origin), span = Vector(above.header.origin) - from;
    const double distance = placed[i].along - placed[i - 1].along;
    if (distance < (1 + kUnevenShare) * usual) continue;
    for (const DicomSlice& other : others) {
      const Vec3 place = Vector(other.header.origin) - from;
      const double part = Dot(place, span) / Dot(span, span);
      const bool is_between = part * distance > kDoubledMm && (1 - part) * distance > kDoubledMm;
      if (!is_between || Norm(place - part * span) > kAsideMm) continue;
      if (const char* difference = FindDifference(below.header, other.header))
        return Mixed(below, other, difference);
    }
  }
  return std::nullopt;
}

}  // namespace trocar::images
