// SPDX-License-Identifier: Apache-2.0
#include "label_plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "trocar/math/elementary.h"

namespace trocar::anatomy {
namespace {

using base::Error;
using base::ErrorCode;

// No living body's: far beyond what patient_lint calls unusual, so that a sick or small person's is taken.
constexpr double kLeastLiverMl = 200.0, kMostLiverMl = 8000.0;
constexpr double kLeastGallbladderMl = 1.0, kMostGallbladderMl = 500.0;
constexpr double kUsualLiverMl = 1500.0;
constexpr double kMostGapMm = 30.0;     // between the boxes of the two organs
constexpr double kUpsideDownMm = 15.0;  // the gallbladder's centre above the liver's; it lies 30 to 65 below
constexpr double kMirroredSkewness = -0.3;  // a liver has 0.6 to 0.8, its mirror image the negative
constexpr double kMostLostPart = 0.05;      // of an organ, in parts that do not hang together with it
constexpr double kNamedPartMl = 0.5;        // smaller ones are noise of the segmentation
constexpr double kNamedCutMm2 = 100.0;

std::string Format(const char* form, double value) {
  char text[48];
  std::snprintf(text, sizeof text, form, value);
  return text;
}
std::string Ml(double volume) {
  return Format(volume < 10 ? "%.2g mL" : "%.0f mL", volume);
}

Error Mismatch(std::string why) {
  return {ErrorCode::kLabelsMismatch, std::move(why)};
}

bool IsLiver(double ml) {
  return ml >= kLeastLiverMl && ml <= kMostLiverMl;
}
bool IsGallbladder(double ml) {
  return ml >= kLeastGallbladderMl && ml <= kMostGallbladderMl;
}

/// Why a liver is so small or large, by the factor of its lengths.
std::string GuessUnit(double liver_ml) {
  struct Guess {
    double factor;
    const char* reason;
  };
  constexpr Guess kGuesses[] = {{1000, "its lengths look like micrometres"},
                                {10, "its voxels look ten times too large"},
                                {0.1, "its lengths look like centimetres; they must be millimetres"},
                                {1 / 25.4, "its lengths look like inches; they must be millimetres"},
                                {0.001, "its lengths look like metres; they must be millimetres"}};
  const double factor = math::Cbrt(liver_ml / kUsualLiverMl);
  for (const Guess& guess : kGuesses) {
    if (std::fabs(math::Log(factor / guess.factor)) < math::Log(1.4)) return guess.reason;
  }
  return "the label is another organ, or the distance of its voxels is wrong along one axis";
}

/// Length of the gap between two boxes; 0 where they overlap.
double GapOf(const LabelMeasures& a, const LabelMeasures& b) {
  const auto along = [](double min_a, double max_a, double min_b, double max_b) {
    return std::max({0.0, min_b - max_a, min_a - max_b});
  };
  return Norm(math::Vec3{along(a.min.x, a.max.x, b.min.x, b.max.x), along(a.min.y, a.max.y, b.min.y, b.max.y),
                         along(a.min.z, a.max.z, b.min.z, b.max.z)});
}

base::Status CheckSizes(const MeasuredLabels& measured) {
  const double liver = measured.liver.volume_ml, gallbladder = measured.gallbladder.volume_ml;
  if (IsLiver(liver) && IsGallbladder(gallbladder) && gallbladder < liver) return {};
  if (IsLiver(gallbladder) && IsGallbladder(liver)) {
    return Mismatch("the labels look swapped: the liver's (" + std::to_string(measured.labels.liver) +
                    ") has " + Ml(liver) + ", the gallbladder's (" +
                    std::to_string(measured.labels.gallbladder) + ") " + Ml(gallbladder) + "; give --liver " +
                    std::to_string(measured.labels.gallbladder) + " --gallbladder " +
                    std::to_string(measured.labels.liver));
  }
  if (!IsLiver(liver)) {
    return Mismatch("the liver has " + Ml(liver) + ", and people's have " + Ml(kLeastLiverMl) + " to " +
                    Ml(kMostLiverMl) + ": " + GuessUnit(liver));
  }
  return Mismatch("the gallbladder has " + Ml(gallbladder) + ", and people's have " +
                  Ml(kLeastGallbladderMl) + " to " + Ml(kMostGallbladderMl) +
                  ": the label is another organ, or a fragment; name the right one with --gallbladder");
}

}  // namespace

MeasuredLabels MeasureOrgans(const images::LabelVolume& volume, const OrganLabels& labels,
                             const VoxelFrame& frame) {
  MeasuredLabels measured;
  measured.labels = labels;
  measured.liver = MeasureLabel(volume, labels.liver, frame);
  measured.gallbladder = MeasureLabel(volume, labels.gallbladder, frame);
  if (labels.spleen > 0) {
    const LabelMeasures spleen = MeasureLabel(volume, labels.spleen, frame);
    if (spleen.volume_ml > 0) measured.spleen = spleen.centre;
  }
  return measured;
}

base::Status CheckBody(const MeasuredLabels& measured, bool is_mirrored) {
  if (auto status = CheckSizes(measured); !status.ok()) return status;
  const LabelMeasures &liver = measured.liver, &gallbladder = measured.gallbladder;
  if (const double gap = GapOf(liver, gallbladder); gap > kMostGapMm) {
    return Mismatch(
        "the gallbladder lies " + Format("%.0f mm", gap) +
        " away from the liver: the two come from different images, or one label is another organ");
  }
  if (gallbladder.centre.y > liver.centre.y + kUpsideDownMm) {
    return Mismatch(
        "the gallbladder lies above the liver's middle: the slices are in the wrong order, or the "
        "header's direction from foot to head is wrong");
  }
  const bool is_spleen_right = measured.spleen && measured.spleen->x < liver.centre.x;
  const bool is_spleen_left = measured.spleen && !is_spleen_right;
  if (is_spleen_right || (!is_spleen_left && liver.skewness_left < kMirroredSkewness)) {
    return ExplainMirrored(is_spleen_right ? "the spleen lies to the right of the liver"
                                           : "the liver's thin lobe lies to the right",
                           is_mirrored);
  }
  return {};
}

base::Error ExplainMirrored(const std::string& sign, bool is_mirrored) {
  return Mismatch(
      sign +
      (is_mirrored
           ? ": left and right were right as they are in the map; leave --mirrored out"
           : ": left and right are swapped (RAS read as LPS?), or this is situs inversus; with --mirrored "
             "the map is taken the other way round, so that a body with situs inversus becomes its mirror "
             "image"));
}

base::Status CheckParts(const std::string& organ, const std::vector<double>& parts_ml, bool takes_largest) {
  double lost = 0;
  for (std::size_t i = 1; i < parts_ml.size(); ++i) lost += parts_ml[i];
  if (takes_largest || parts_ml.empty() || lost <= kMostLostPart * (lost + parts_ml[0])) return {};
  return Mismatch("the " + organ + " is in " + std::to_string(parts_ml.size()) +
                  " parts that do not hang together, the largest of " + Ml(parts_ml[0]) + " and " +
                  Ml(parts_ml[1]) +
                  ": two bodies, or a map that cuts it; join or remove parts, or take the largest "
                  "one alone with --largest-part");
}

std::vector<std::string> DescribeLosses(const std::string& organ, const std::vector<double>& parts_ml,
                                        const std::vector<CutSide>& cuts) {
  std::vector<std::string> notes;
  double lost = 0;
  for (std::size_t i = 1; i < parts_ml.size(); ++i) lost += parts_ml[i];
  if (lost >= kNamedPartMl) {
    notes.push_back("The " + organ + " is in " + std::to_string(parts_ml.size()) + " parts; the largest, " +
                    Ml(parts_ml[0]) + ", is taken, and " + Ml(lost) + " are left out.");
  }
  for (const CutSide& cut : cuts) {
    if (cut.area_mm2 < kNamedCutMm2) continue;
    notes.push_back("The map's " + cut.side + " border cuts the " + organ + " off over " +
                    Format("%.0f cm2", cut.area_mm2 / 100.0) + ": there the model has a flat face.");
  }
  return notes;
}

}  // namespace trocar::anatomy
