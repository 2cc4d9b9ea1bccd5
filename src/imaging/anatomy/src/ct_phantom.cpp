// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/ct_phantom.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "phantom_files.h"
#include "phantom_tissue.h"
#include "trocar/anatomy/patient_from_labels.h"
#include "trocar/anatomy/phantom.h"
#include "trocar/base/to_integer.h"
#include "trocar/files/patient_frame.h"
#include "trocar/meshing/volume.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using images::CtTissue;
using math::Vec3;

constexpr double kWallMm = 2.0, kDiaphragmMm = 3.0;
constexpr double kVesselDepthMm = 6.0;  // of vessels below the liver's surface
constexpr double kEndMm = 5.0;          // of the gallbladder, whose middle is fundus or neck
constexpr const char *kDucts = "bile_ducts", *kArteries = "arteries", *kHepaticVeins = "hepatic_veins";
constexpr int kSamples = 2;  // lattice voxels in a pixel's side

/// By Substance.
constexpr std::array<CtTissue, static_cast<std::size_t>(Substance::kCount)> kTissues = {{
    CtTissue::kAir,              // kGel
    CtTissue::kSkin,             // kSkin
    CtTissue::kFat,              // kFat
    CtTissue::kMuscle,           // kMuscle
    CtTissue::kBone,             // kBone
    CtTissue::kDisc,             // kDisc
    CtTissue::kNerve,            // kCord
    CtTissue::kLung,             // kLung
    CtTissue::kHeart,            // kHeart
    CtTissue::kVenousBlood,      // kBlood
    CtTissue::kMuscle,           // kVesselWall
    CtTissue::kBowelWall,        // kBowelWall
    CtTissue::kBowelContent,     // kBowelContent
    CtTissue::kRenalCortex,      // kKidney
    CtTissue::kRenalMedulla,     // kMedulla
    CtTissue::kSpleen,           // kSpleen
    CtTissue::kFat,              // kConnective
    CtTissue::kLiver,            // kLiver
    CtTissue::kGallbladderWall,  // kGallbladderWall
    CtTissue::kBile,             // kBile
    CtTissue::kBile,             // kDuct
    CtTissue::kArterialBlood,    // kArtery
    CtTissue::kArterialBlood,    // kAorticBlood
}};

/// A map's voxels by place, its labels by tissue.
class Map {
 public:
  Map(const images::LabelVolume& labels, const OrganLabels& organs) : labels_(labels), organs_(organs) {
    for (int axis = 0; axis < 3; ++axis)
      step_[axis] = {labels.direction[axis][0], labels.direction[axis][1], labels.direction[axis][2]};
    for (const auto& [label, structure] : organs.structures) {
      has_vessels_ = has_vessels_ || structure == Structure::kPortalVein;
      if (const auto tissue = FindTissue(structure)) others_.emplace_back(label, *tissue);
    }
  }

  bool HasVessels() const { return has_vessels_; }
  /// Place of a voxel: left, cranial, anterior [mm].
  Vec3 PlaceOf(std::size_t at) const {
    const std::size_t row = at / labels_.size[0];
    const Vec3 lps = Vec3{labels_.origin[0], labels_.origin[1], labels_.origin[2]} +
                     static_cast<double>(at % labels_.size[0]) * step_[0] +
                     static_cast<double>(row % labels_.size[1]) * step_[1] +
                     static_cast<double>(row / labels_.size[1]) * step_[2];
    return {lps.x, lps.z, -lps.y};
  }
  int LabelAt(const Vec3& lps) const { return images::LabelAt(labels_, {lps.x, lps.y, lps.z}); }
  bool IsLiver(int label) const { return label == organs_.liver; }
  bool IsGallbladder(int label) const { return label == organs_.gallbladder; }
  std::optional<CtTissue> TissueOf(int label) const {
    for (const auto& [other, tissue] : others_) {
      if (other == label) return tissue;
    }
    return std::nullopt;
  }

  BodyPlan PlanBody() const {
    BodyPlan plan;
    std::vector<Vec3> gallbladder;
    bool is_first = true;
    for (std::size_t i = 0; i < labels_.labels.size(); ++i) {
      const int label = labels_.labels[i];
      if (!IsLiver(label) && !IsGallbladder(label)) continue;
      const Vec3 p = PlaceOf(i);
      if (IsGallbladder(label)) {
        gallbladder.push_back(p);
        continue;
      }
      if (is_first) plan.liver = {p, p}, is_first = false;
      for (int axis = 0; axis < 3; ++axis) {
        plan.liver.min[axis] = std::min(plan.liver.min[axis], p[axis]);
        plan.liver.max[axis] = std::max(plan.liver.max[axis], p[axis]);
      }
    }
    const auto by_height = [](const Vec3& a, const Vec3& b) { return a.y < b.y; };
    const auto [low, high] = std::minmax_element(gallbladder.begin(), gallbladder.end(), by_height);
    plan.lowest = low->y;
    const auto middle = [&](double from, double to) {
      Vec3 sum{};
      int count = 0;
      for (const Vec3& p : gallbladder) {
        if (p.y >= from && p.y <= to) sum += p, ++count;
      }
      return (1.0 / count) * sum;
    };
    plan.fundus = middle(low->y, low->y + kEndMm), plan.porta = middle(high->y - kEndMm, high->y);
    return plan;
  }

 private:
  static std::optional<CtTissue> FindTissue(Structure structure) {
    switch (structure) {
      case Structure::kBileDuct:
        return CtTissue::kBile;
      case Structure::kArtery:
      case Structure::kAorta:
        return CtTissue::kArterialBlood;
      case Structure::kLiverVessel:
      case Structure::kPortalVein:
        return CtTissue::kHepaticBlood;
      case Structure::kVenaCava:
        return CtTissue::kVenousBlood;
      case Structure::kSpleen:
        return CtTissue::kSpleen;
      case Structure::kStomach:
      case Structure::kDuodenum:
      case Structure::kColon:
      case Structure::kSmallBowel:
        return CtTissue::kBowelContent;
      case Structure::kPancreas:
        return CtTissue::kPancreas;
      case Structure::kKidneyRight:
        return CtTissue::kRenalCortex;
      default:
        break;
    }
    const roles::NeighbourRole role = RoleOf(structure);
    if (role == roles::NeighbourRole::kRibs || role == roles::NeighbourRole::kSpine) return CtTissue::kBone;
    return std::nullopt;
  }

  const images::LabelVolume& labels_;
  OrganLabels organs_;
  std::array<Vec3, 3> step_;
  std::vector<std::pair<int, CtTissue>> others_;
  bool has_vessels_ = false;
};

/// One layer of the lattice, its body found once a pixel.
void FillLayer(const Map& map, const PhantomBody& body, const BodyPlan& plan, int k,
               images::TissueVolume& tissues) {
  const int width = tissues.size[0], height = tissues.size[1];
  const double step = tissues.step_mm[0];
  const double y = tissues.origin_mm[2] + k * tissues.step_mm[2];
  std::vector<int> labels(static_cast<std::size_t>(width) * height);
  std::vector<std::uint8_t> is_organ(labels.size()), is_gallbladder(labels.size());
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const std::size_t at = static_cast<std::size_t>(j) * width + i;
      labels[at] = map.LabelAt({tissues.origin_mm[0] + i * step, tissues.origin_mm[1] + j * step, y});
      is_gallbladder[at] = map.IsGallbladder(labels[at]);
      is_organ[at] = is_gallbladder[at] != 0 || map.IsLiver(labels[at]);
    }
  }
  const auto measure = [&](const std::vector<std::uint8_t>& set) {
    const bool is_empty = std::find(set.begin(), set.end(), 1) == set.end();
    return is_empty ? std::vector<double>(set.size(), -1e9)
                    : meshing::CalcSignedDistances(set, width, height);
  };
  const auto depth = measure(is_organ), gallbladder_depth = measure(is_gallbladder);
  const auto pipes = body.FindPipes(y), veins = body.FindVeins(y);
  const geometry::Box& liver = plan.liver;
  const double right_part = liver.min.x + 0.3 * (liver.max.x - liver.min.x);
  const double front_part = liver.min.z + 0.6 * (liver.max.z - liver.min.z);
  const double dome = liver.max.y - 0.25 * (liver.max.y - liver.min.y);
  CtTissue* layer = &tissues.tissues[tissues.Index(0, 0, k)];
  for (int j = 0; j < height; ++j) {
    const double posterior = tissues.origin_mm[1] + j * step;
    for (int i = 0; i < width; ++i) {
      const std::size_t at = static_cast<std::size_t>(j) * width + i;
      const Vec3 p = {tissues.origin_mm[0] + i * step, y, -posterior};
      if (is_gallbladder[at] != 0) {
        layer[at] = gallbladder_depth[at] * step < kWallMm ? CtTissue::kGallbladderWall : CtTissue::kBile;
        continue;
      }
      if (is_organ[at] != 0) {
        const bool is_vein = !map.HasVessels() && depth[at] * step > kVesselDepthMm &&
                             body.FindInLiver(p, veins) != Substance::kLiver;
        layer[at] = is_vein ? CtTissue::kHepaticBlood : CtTissue::kLiver;
        continue;
      }
      if (const auto tissue = map.TissueOf(labels[at])) {
        layer[at] = *tissue;
        continue;
      }
      const double away = std::max(0.0, -depth[at]) * step;
      // the same tissue as beside it in the pixel
      const std::size_t beside = at - (i % kSamples != 0 ? 1 : 0) - (j % kSamples != 0 ? width : 0);
      if (beside != at && is_organ[beside] == 0 && away > kDiaphragmMm + 1 && !map.TissueOf(labels[beside])) {
        layer[at] = layer[beside];
        continue;
      }
      CtTissue tissue = kTissues[static_cast<std::size_t>(body.Find(p, pipes, away))];
      // the diaphragm lies on the dome, on the right side and in front
      const bool is_soft =
          tissue == CtTissue::kFat || tissue == CtTissue::kHeart || tissue == CtTissue::kLung;
      const bool is_face = p.y > dome || (p.y > plan.porta.y && (p.x < right_part || p.z > front_part));
      if (is_soft && away < kDiaphragmMm && is_face) tissue = CtTissue::kMuscle;
      layer[at] = tissue;
    }
  }
}

}  // namespace

base::Result<CtPhantom> MakeCtPhantom(const images::LabelVolume& labels, const images::CtSettings& settings,
                                      std::stop_token stop, const images::Progress& progress) {
  const auto organs = FindLabels(labels, {});
  if (!organs) return organs.error();
  if (!organs->joined.empty()) {
    images::LabelVolume whole = labels;
    JoinParts(*organs, whole);
    return MakeCtPhantom(whole, settings, stop, progress);
  }
  if (images::IsOblique(labels)) {
    return base::Error{base::ErrorCode::kLabelsMismatch,
                       "the label map's axes are not at right angles; resample it, in 3D Slicer for example"};
  }
  const Map map(labels, *organs);
  const BodyPlan plan = map.PlanBody();
  const PhantomBody body(plan, settings.seed);
  const geometry::Box& box = body.Extent();
  images::TissueVolume tissues;
  const double layer = settings.slice_mm / std::max(1.0, std::round(settings.slice_mm));
  tissues.step_mm = {settings.pixel_mm / kSamples, settings.pixel_mm / kSamples, layer};
  const double extent[3] = {box.max.x - box.min.x, box.max.z - box.min.z, box.max.y - box.min.y};
  for (int axis = 0; axis < 3; ++axis)
    tissues.size[axis] = base::CeilTo<int>(extent[axis] / tissues.step_mm[axis]);
  tissues.origin_mm = {box.min.x, -box.max.z, box.min.y};
  tissues.tissues.resize(tissues.Index(0, 0, tissues.size[2]));
  constexpr int kBatch = 8;
  for (int first = 0; first < tissues.size[2]; first += kBatch) {
    if (stop.stop_requested()) return base::Error{base::ErrorCode::kCancelled, "drawing was given up"};
    if (progress) progress("drawing the body", 0.7 * first / tissues.size[2]);
    oneapi::tbb::parallel_for(first, std::min(first + kBatch, tissues.size[2]),
                              [&](int k) { FillLayer(map, body, plan, k, tissues); });
  }
  auto ct = images::RenderCt(tissues, settings, stop, [&](std::string_view what, double part) {
    if (progress) progress(what, 0.7 + 0.3 * part);
  });
  if (!ct) return ct.error();
  images::LabelVolume truth = images::LabelsOn(*ct, labels);
  return CtPhantom{std::move(*ct), std::move(truth)};
}

std::vector<std::pair<std::string, int>> VisibleHumanLabels() {
  return {{NameOf(roles::OrganRole::kLiver), 1},
          {NameOf(roles::OrganRole::kGallbladder), 2},
          {kDucts, 3},
          {kArteries, 4},
          {NameOf(roles::NeighbourRole::kPortalVein), 5},
          {kHepaticVeins, 6}};
}

base::Result<images::LabelVolume> DrawLabels(const patient::Patient& patient,
                                             const images::Progress& progress, double pixel_mm,
                                             double slice_mm) {
  PhantomOptions options;
  options.pixel_mm = pixel_mm, options.slice_mm = slice_mm;
  const auto phantom = Phantom::Make(patient, options);
  if (!phantom) return phantom.error();
  return phantom->MakeLabels(progress);
}

base::Status WriteCtPhantom(const std::filesystem::path& folder, const CtPhantom& phantom,
                            const images::Progress& progress) {
  return WriteNewFolder(folder, [&](const std::filesystem::path& part) -> base::Status {
    std::error_code failure;
    std::filesystem::create_directories(part / "slices", failure);
    if (failure)
      return base::Error{
          base::ErrorCode::kFileUnwritable,
          part.string() + ": " + failure.message() + "; check the folder, its rights and the space left"};
    if (auto status = images::WriteDicom(part / "slices", phantom.ct, progress); !status) return status;
    return WriteLabelVolume(part / "labels.nrrd", phantom.labels);
  });
}

}  // namespace trocar::anatomy
