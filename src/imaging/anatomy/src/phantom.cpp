// SPDX-License-Identifier: Apache-2.0
#include "trocar/anatomy/phantom.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "phantom_tissue.h"
#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/files/patient_frame.h"
#include "trocar/geometry/tube.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/meshing/mesh_slice.h"
#include "trocar/meshing/volume.h"
#include "trocar/patient/patient.h"

namespace trocar::anatomy {
namespace {

using math::Vec2;
using math::Vec3;

constexpr int kTubeSides = 16;
constexpr int kSamples = 3;        // a pixel and direction: borders of organs are smooth
constexpr double kNudge = 1.3e-6;  // mm, moves the planes off the meshes' vertices
constexpr double kWallMm = 2.0;    // of the gallbladder, where the patient's file does not say
constexpr double kGrain = 2.6;     // standard deviation at noise 1, of 255
constexpr double kUnevenLight = 0.05, kFlicker = 0.012;  // at noise 1, of the light

/// What a structure's pixels are called, and the smallest contour that a person would draw [mm^2].
struct Target {
  roles::OrganRole organ;
  std::uint8_t label;
  int triangles;
  double smallest;
};
constexpr Target kTargets[] = {{roles::OrganRole::kLiver, kLiverLabel, 5132, 120.0},
                               {roles::OrganRole::kGallbladder, kGallbladderLabel, 1798, 30.0}};

base::Error Usage(const std::string& text) {
  return {base::ErrorCode::kUsage, text};
}

base::Status CheckOptions(const PhantomOptions& options) {
  const auto is_in = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!is_in(options.pixel_mm, 0.3, 4)) return Usage("a pixel must measure 0.3 to 4 mm");
  if (!is_in(options.slice_mm, 0.5, 8)) return Usage("the slices must lie 0.5 to 8 mm apart");
  if (!is_in(options.noise, 0, 5)) return Usage("noise must lie between 0 and 5");
  if (!is_in(options.blur_px, 0, 5)) return Usage("the blur must lie between 0 and 5 pixels");
  if (options.every < 1 || options.every > 64) return Usage("every must lie between 1 and 64 slices");
  if (options.points < 6 || options.points > 64) return Usage("a contour needs 6 to 64 points");
  if (!is_in(options.slip_mm, 0, 20)) return Usage("the slip must lie between 0 and 20 mm");
  return {};
}

/// Blurs the three channels along rows, then along columns.
void Blur(std::vector<float>& samples, int width, int height, double deviation) {
  if (deviation <= 0) return;
  const int reach = base::CeilTo<int>(3 * deviation);
  std::vector<float> kernel;
  float total = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(math::Exp(-0.5 * i * i / (deviation * deviation))));
    total += kernel.back();
  }
  for (float& weight : kernel) weight /= total;
  std::vector<float> blurred(samples.size());
  const auto pass = [&](int length, int count, std::ptrdiff_t along, std::ptrdiff_t across) {
    for (int line = 0; line < count; ++line) {
      for (int i = 0; i < length; ++i) {
        float sum[3] = {0, 0, 0};
        for (int k = -reach; k <= reach; ++k) {
          const auto at = line * across + std::clamp(i + k, 0, length - 1) * along;
          for (int c = 0; c < 3; ++c) sum[c] += kernel[k + reach] * samples[at + c];
        }
        for (int c = 0; c < 3; ++c) blurred[line * across + i * along + c] = sum[c];
      }
    }
    samples.swap(blurred);
  };
  const std::ptrdiff_t row = 3 * static_cast<std::ptrdiff_t>(width);
  pass(width, height, 3, row);
  pass(height, width, row, 3);
}

/// Nearly normal deviate of mean 0 and deviation 1.
double Deviate(math::Random& random) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += random.Uniform();
  return 2.0 * (sum - 1.5);
}

/// `count` points evenly along a closed polygon, the first a share `phase` of their distance in.
std::vector<Vec2> Spread(const std::vector<Vec2>& loop, int count, double phase) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) length += Norm(loop[(i + 1) % loop.size()] - loop[i]);
  std::vector<Vec2> points;
  double passed = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const double step = Norm(b - a);
    while (static_cast<int>(points.size()) < count) {
      const double wanted = (static_cast<double>(points.size()) + phase) * length / count;
      if (wanted > passed + step) break;
      points.push_back(a + (step > 0 ? (wanted - passed) / step : 0.0) * (b - a));
    }
    passed += step;
  }
  return points;
}

bool IsInside(const Vec2& p, const std::vector<Vec2>& loop) {
  bool is_inside = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y))
      is_inside = !is_inside;
  }
  return is_inside;
}

}  // namespace

struct Phantom::Content {
  Content(const patient::Patient& from, const PhantomOptions& with)
      : patient(from), options(with), body(from, with.seed) {}

  patient::Patient patient;
  PhantomOptions options;
  PhantomBody body;
  meshing::SliceGrid grid;
  int slices = 0;
  Vec3 first;  // world place of pixel (0, 0) in slice 0 [mm]
  double wall_mm = kWallMm;
  geometry::TriangleMesh liver, gallbladder;  // frame of the pictures [mm]
  std::vector<std::pair<patient::TubeKind, geometry::TriangleMesh>> tubes;

  Vec3 ToPicture(const Vec3& world_metres) const {
    const Vec3 p = files::kMmPerMetre * world_metres;
    return {p.x - first.x, first.z - p.z, first.y - p.y};
  }
  Vec3 ToWorldMm(double column_mm, double row_mm, double slice_mm) const {
    return {first.x + column_mm, first.y - slice_mm, first.z - row_mm};
  }
  geometry::TriangleMesh ToPicture(geometry::TriangleMesh mesh) const {
    for (Vec3& p : mesh.positions) p = ToPicture(p);
    return mesh;
  }
  double Height(int slice) const { return options.slice_mm * slice + kNudge; }
};

Phantom::Phantom(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Phantom::Phantom(Phantom&&) noexcept = default;
Phantom& Phantom::operator=(Phantom&&) noexcept = default;
Phantom::~Phantom() = default;

base::Result<Phantom> Phantom::Make(const patient::Patient& patient, const PhantomOptions& options) {
  if (const auto status = CheckOptions(options); !status) return status.error();
  for (const Target& target : kTargets) {
    if (patient.OrganOf(target.organ) < 0) {
      return base::Error{base::ErrorCode::kPatientInvalid, "the patient has no " + SpokenName(target.organ) +
                                                               "; a phantom shows liver and gallbladder"};
    }
  }
  auto content = std::make_unique<Content>(patient, options);
  Content& c = *content;
  const geometry::Box& box = c.body.Extent();
  c.first = {box.min.x, box.max.y + options.slice_mm, box.max.z};
  c.grid = {base::CeilTo<int>((box.max.x - box.min.x) / options.pixel_mm),
            base::CeilTo<int>((box.max.z - box.min.z) / options.pixel_mm), options.pixel_mm};
  c.slices = base::CeilTo<int>((box.max.y - box.min.y) / options.slice_mm);
  c.liver = c.ToPicture(patient.organs[patient.OrganOf(roles::OrganRole::kLiver)].mesh);
  c.gallbladder = c.ToPicture(patient.organs[patient.OrganOf(roles::OrganRole::kGallbladder)].mesh);
  for (const patient::Tube& tube : patient.tubes)
    c.tubes.emplace_back(tube.kind, c.ToPicture(geometry::MakeTube(tube.line, kTubeSides)));
  if (const patient::Parameter* wall = patient.FindParameter("gallbladder_wall"))
    if (const double* mm = std::get_if<double>(&wall->value)) c.wall_mm = *mm;
  return Phantom(std::move(content));
}

int Phantom::Width() const {
  return content_->grid.width;
}
int Phantom::Height() const {
  return content_->grid.height;
}
int Phantom::SliceCount() const {
  return content_->slices;
}

images::ColorImage Phantom::DrawSlice(int slice) const {
  const Content& c = *content_;
  TROCAR_ASSERT(slice >= 1 && slice <= c.slices);
  const int width = c.grid.width, height = c.grid.height;
  const double z = c.Height(slice);
  const auto liver = meshing::CalcCoverage(meshing::CutMesh(c.liver, z), c.grid, kSamples);
  const auto gallbladder = meshing::CalcCoverage(meshing::CutMesh(c.gallbladder, z), c.grid, kSamples);
  std::vector<std::vector<float>> duct_cover, artery_cover;
  for (const auto& [kind, mesh] : c.tubes) {
    const auto cut = meshing::CutMesh(mesh, z);
    // each for itself: where two skins overlap, the even-odd rule would leave a hole
    if (!cut.empty())
      (kind == patient::TubeKind::kDuct ? duct_cover : artery_cover)
          .push_back(meshing::CalcCoverage(cut, c.grid, kSamples));
  }
  const std::size_t count = liver.size();
  std::vector<std::uint8_t> is_organ(count), is_gallbladder(count);
  for (std::size_t i = 0; i < count; ++i) {
    is_organ[i] = liver[i] + gallbladder[i] > 0.5f;
    is_gallbladder[i] = gallbladder[i] > 0.5f;
  }
  const auto organ_depth = meshing::CalcSignedDistances(is_organ, width, height);
  const auto gallbladder_depth = meshing::CalcSignedDistances(is_gallbladder, width, height);

  const double y = c.ToWorldMm(0, 0, z).y;
  const auto pipes = c.body.FindPipes(y), veins = c.body.FindVeins(y);
  const NoiseField& noise = c.body.Noise();
  std::vector<float> samples(3 * count);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * width + column;
      const Vec3 p = c.ToWorldMm(column * c.grid.pixel, row * c.grid.pixel, z);
      Tint tint{};
      const auto lay_over = [&](const Tint& over, double share) {
        for (int k = 0; k < 3; ++k) tint[k] += share * (over[k] - tint[k]);
      };
      if (std::max(liver[i], gallbladder[i]) < 0.999f) {
        const double away = std::max(0.0, -organ_depth[i]) * c.grid.pixel;
        tint = CalcTint(c.body.Find(p, pipes, away), p, noise);
      }
      if (liver[i] > 0) lay_over(CalcTint(c.body.FindInLiver(p, veins), p, noise), liver[i]);
      if (gallbladder[i] > 0) {
        const bool is_wall = gallbladder_depth[i] * c.grid.pixel < c.wall_mm;
        lay_over(CalcTint(is_wall ? Substance::kGallbladderWall : Substance::kBile, p, noise),
                 gallbladder[i]);
      }
      for (const auto& cover : duct_cover) lay_over(CalcTint(Substance::kDuct, p, noise), cover[i]);
      for (const auto& cover : artery_cover) lay_over(CalcTint(Substance::kArtery, p, noise), cover[i]);
      for (int k = 0; k < 3; ++k) samples[3 * i + k] = static_cast<float>(tint[k]);
    }
  }
  Blur(samples, width, height, c.options.blur_px);

  math::Random random(c.options.seed * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(slice));
  const double flicker = 1 + kFlicker * c.options.noise * Deviate(random);
  images::ColorImage image{width, height, std::vector<std::uint8_t>(3 * count)};
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * width + column;
      const Vec3 p = c.ToWorldMm(column * c.grid.pixel, row * c.grid.pixel, z);
      const double light = flicker * (1 + kUnevenLight * c.options.noise * noise.At(p, 420));
      const double grain = kGrain * c.options.noise * Deviate(random);
      for (int k = 0; k < 3; ++k) {
        const double value =
            light * samples[3 * i + k] + grain + 0.5 * kGrain * c.options.noise * Deviate(random);
        image.samples[3 * i + k] = base::RoundTo<std::uint8_t>(value);
      }
    }
  }
  return image;
}

std::vector<std::uint8_t> Phantom::LabelSlice(int slice) const {
  const Content& c = *content_;
  TROCAR_ASSERT(slice >= 1 && slice <= c.slices);
  std::vector<std::uint8_t> labels(static_cast<std::size_t>(c.grid.width) * c.grid.height, 0);
  const auto mark = [&](const geometry::TriangleMesh& mesh, std::uint8_t label) {
    const auto cut = meshing::CutMesh(mesh, c.Height(slice));
    if (cut.empty()) return;
    const auto inside = meshing::CalcCoverage(cut, c.grid, 1);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (inside[i] > 0.5f) labels[i] = label;
    }
  };
  mark(c.liver, kLiverLabel);
  mark(c.gallbladder, kGallbladderLabel);
  for (const auto& [kind, mesh] : c.tubes) {
    if (kind == patient::TubeKind::kDuct) mark(mesh, kDuctLabel);
  }
  for (const auto& [kind, mesh] : c.tubes) {
    if (kind == patient::TubeKind::kArtery) mark(mesh, kArteryLabel);
  }
  return labels;
}

contours::ControlPoints Phantom::MakeControlPoints() const {
  const Content& c = *content_;
  contours::ControlPoints points;
  points.name = "Phantom of: " + c.patient.name;
  points.provenance =
      "Pictures drawn by a computer; control points beside the true contours. " + c.patient.provenance;
  points.image_pattern = "phantom-{slice:04}.png";
  points.first_slice = 1;
  points.last_slice = c.slices;
  points.width = c.grid.width;
  points.height = c.grid.height;
  points.pixel_mm = c.options.pixel_mm;
  points.slice_mm = c.options.slice_mm;
  points.axes = {"left", "posterior", "inferior"};
  if (const patient::Landmark* fundus = c.patient.LandmarkOf(roles::LandmarkRole::kFundus)) {
    points.origin_landmark = NameOf(fundus->role);
    for (int axis = 0; axis < 3; ++axis) points.origin_mm[axis] = files::kMmPerMetre * fundus->position[axis];
  }
  const auto in_picture = [&](const Vec2& mm) {
    return Vec2{std::clamp(mm.x / c.grid.pixel, 0.0, c.grid.width - 1.0),
                std::clamp(mm.y / c.grid.pixel, 0.0, c.grid.height - 1.0)};
  };
  for (const Target& target : kTargets) {
    const auto& mesh = target.label == kLiverLabel ? c.liver : c.gallbladder;
    contours::Structure structure;
    structure.name = NameOf(target.organ);
    structure.triangle_budget = target.triangles;
    structure.reference_label = target.label;
    structure.adaption.max_shift_px =
        std::max(structure.adaption.max_shift_px, std::ceil(1.5 * c.options.slip_mm / c.grid.pixel));
    math::Random random(c.options.seed * 0xd1342543de82ef95ULL + target.label);
    std::vector<contours::SliceContours> all;
    for (int slice = 1; slice <= c.slices; ++slice) {
      auto loops = meshing::JoinLoops(meshing::CutMesh(mesh, c.Height(slice)));
      std::erase_if(loops, [&](const auto& loop) {
        return std::fabs(meshing::CalcPolygonArea(loop)) < target.smallest;
      });
      if (loops.empty()) continue;
      contours::SliceContours contours;
      contours.slice = slice;
      double longest = 0;
      for (const auto& loop : loops) longest = std::max(longest, std::fabs(meshing::CalcPolygonArea(loop)));
      for (std::size_t i = 0; i < loops.size(); ++i) {
        const double share = std::sqrt(std::fabs(meshing::CalcPolygonArea(loops[i])) / longest);
        const int count = std::max(6, base::RoundTo<int>(share * c.options.points));
        auto placed = Spread(loops[i], count, random.Uniform());
        for (Vec2& p : placed) {
          const double turn = random.Uniform(0, 2 * M_PI);
          p = in_picture(p + c.options.slip_mm * Vec2{math::Cos(turn), math::Sin(turn)});
        }
        const auto around = std::count_if(loops.begin(), loops.end(), [&](const auto& other) {
          return &other != &loops[i] && IsInside(loops[i].front(), other);
        });
        (around % 2 == 0 ? contours.contours : contours.holes).push_back(std::move(placed));
      }
      all.push_back(std::move(contours));
    }
    // every n-th slice, and the last
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i % static_cast<std::size_t>(c.options.every) == 0 || i + 1 == all.size())
        structure.slices.push_back(std::move(all[i]));
    }
    points.structures.push_back(std::move(structure));
  }
  constexpr double kTubeSpacing = 0.004;  // m
  // the structures have their conventional names here, whatever the patient calls its organs
  const auto end_name = [&](const std::string& end) {
    const roles::OrganRole role = c.patient.FindOrganRole(end);
    return role != roles::OrganRole::kOther ? NameOf(role) : end.empty() ? "outside" : end;
  };
  for (const patient::Tube& tube : c.patient.tubes) {
    contours::TubePoints placed{
        tube.name, patient::KindName(tube.kind), end_name(tube.from), end_name(tube.to), true, {}};
    const auto line = geometry::Resample(tube.line, kTubeSpacing);
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Vec3 p = c.ToPicture(line.points[i]);
      const double slice = p.z / c.options.slice_mm;
      // what runs out of the pictures ends where they do
      if (slice < points.first_slice || slice > points.last_slice) continue;
      placed.points.push_back({slice, in_picture({p.x, p.y}), files::kMmPerMetre * line.radii[i]});
    }
    if (placed.points.size() >= 2) points.tubes.push_back(std::move(placed));
  }
  for (const patient::Landmark& landmark : c.patient.landmarks) {
    // the others are found again from the meshes
    if (landmark.role != roles::LandmarkRole::kUmbilicalFissure &&
        landmark.role != roles::LandmarkRole::kUmbilicus)
      continue;
    const Vec3 p = c.ToPicture(landmark.position);
    const double slice = p.z / c.options.slice_mm;
    if (slice >= points.first_slice && slice <= points.last_slice)
      points.landmarks.push_back({NameOf(landmark.role), slice, in_picture({p.x, p.y})});
  }
  return points;
}

images::LabelVolume Phantom::MakeLabels(const images::Progress& progress) const {
  const Content& c = *content_;
  images::LabelVolume volume;
  volume.size = {c.grid.width, c.grid.height, c.slices};
  // LPS: left, posterior, superior
  volume.direction = {{{c.options.pixel_mm, 0, 0}, {0, c.options.pixel_mm, 0}, {0, 0, -c.options.slice_mm}}};
  const Vec3 corner = c.ToWorldMm(0, 0, c.options.slice_mm);
  volume.origin = {corner.x, -corner.z, corner.y};
  volume.names = {{NameOf(roles::OrganRole::kLiver), kLiverLabel},
                  {NameOf(roles::OrganRole::kGallbladder), kGallbladderLabel},
                  {"bile_ducts", kDuctLabel},
                  {"arteries", kArteryLabel}};
  const std::size_t plane = static_cast<std::size_t>(c.grid.width) * c.grid.height;
  volume.labels.resize(plane * c.slices);
  for (int slice = 1; slice <= c.slices; ++slice) {
    const auto labels = LabelSlice(slice);
    std::copy(labels.begin(), labels.end(),
              volume.labels.begin() + static_cast<std::ptrdiff_t>(plane * (slice - 1)));
    if (progress) progress("labels", static_cast<double>(slice) / c.slices);
  }
  return volume;
}

}  // namespace trocar::anatomy
