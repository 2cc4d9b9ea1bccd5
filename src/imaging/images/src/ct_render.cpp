// SPDX-License-Identifier: Apache-2.0
#include "trocar/images/ct_render.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/to_integer.h"
#include "trocar/math/elementary.h"
#include "trocar/math/random.h"
#include "trocar/math/vector.h"

namespace trocar::images {
namespace {

using math::Vec3;

struct Numbers {
  double none, arterial, portal;  // [HU]
};
constexpr std::array<Numbers, static_cast<std::size_t>(CtTissue::kCount)> kNumbers = {{
    {-1000, -1000, -1000},  // air
    {-860, -860, -850},     // lung
    {-100, -100, -100},     // fat
    {20, 25, 30},           // skin
    {55, 58, 65},           // muscle
    {420, 420, 425},        // bone
    {80, 80, 85},           // disc
    {30, 30, 35},           // nerve
    {45, 150, 115},         // heart: muscle and blood
    {45, 290, 150},         // arterial blood
    {42, 60, 130},          // venous blood
    {45, 85, 165},          // portal and hepatic veins
    {40, 70, 95},           // wall of stomach and bowel
    {15, 15, 15},           // what they hold
    {32, 160, 180},         // renal cortex
    {30, 60, 150},          // renal medulla
    {48, 115, 120},         // spleen
    {42, 105, 95},          // pancreas
    {58, 70, 110},          // liver
    {30, 55, 75},           // wall of the gallbladder
    {8, 8, 9},              // bile
}};

/// The noise is white noise smoothed, less most of the same smoothed further.
constexpr double kFineNoiseMm = 0.6, kCoarseNoiseMm = 1.2, kCoarsePart = 0.8;

base::Error Usage(const char* text) {
  return {base::ErrorCode::kUsage, text};
}

base::Status CheckSettings(const CtSettings& settings) {
  const auto is_in = [](double value, double low, double high) { return value >= low && value <= high; };
  if (!is_in(settings.pixel_mm, 0.3, 4)) return Usage("a pixel must measure 0.3 to 4 mm");
  if (!is_in(settings.slice_mm, 0.5, 10)) return Usage("the slices must lie 0.5 to 10 mm apart");
  if (!is_in(settings.blur_mm, 0, 3)) return Usage("the blur must lie between 0 and 3 mm");
  if (!is_in(settings.noise_hu, 0, 100)) return Usage("the noise must lie between 0 and 100 HU");
  return {};
}

/// Which voxels of a lattice a coarser or finer one's voxels overlap, and by what share of theirs.
struct Overlaps {
  struct Part {
    int from;
    float share;
  };
  std::vector<std::vector<Part>> parts;  // of each voxel

  Overlaps(int count, double step, double wanted) {
    const int made = std::max(1, base::TruncateTo<int>(count * step / wanted + 1e-9));
    for (int m = 0; m < made; ++m) {
      const double low = m * wanted, high = low + wanted;
      std::vector<Part>& list = parts.emplace_back();
      double total = 0;
      for (int i = base::TruncateTo<int>(low / step); i < count && i * step < high; ++i) {
        const double share = std::min(high, (i + 1) * step) - std::max(low, i * step);
        if (share > 1e-9) list.push_back({i, static_cast<float>(share)}), total += share;
      }
      for (Part& part : list) part.share /= static_cast<float>(total);
    }
  }
  int Count() const { return static_cast<int>(parts.size()); }
};

std::vector<float> MakeKernel(double deviation_px) {
  const int reach = base::CeilTo<int>(3 * deviation_px);
  std::vector<float> kernel;
  float total = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(deviation_px > 0
                         ? static_cast<float>(math::Exp(-0.5 * i * i / (deviation_px * deviation_px)))
                         : 1.0f);
    total += kernel.back();
  }
  for (float& weight : kernel) weight /= total;
  return kernel;
}

/// Smooths a picture along rows and columns. What lies beyond an edge is the other side's, or the edge's.
std::vector<float> Smooth(const std::vector<float>& picture, int width, int height,
                          const std::vector<float>& kernel, bool is_wrapping) {
  const int reach = static_cast<int>(kernel.size() / 2);
  std::vector<float> rows(picture.size()), both(picture.size());
  const auto place = [&](int at, int count) {
    return is_wrapping ? (at % count + count) % count : std::clamp(at, 0, count - 1);
  };
  const auto pass = [&](const std::vector<float>& from, std::vector<float>& to, int length, int lines,
                        std::size_t along, std::size_t across) {
    std::vector<float> line(static_cast<std::size_t>(length) + 2 * reach);
    for (int j = 0; j < lines; ++j) {
      for (int i = -reach; i < length + reach; ++i)
        line[i + reach] = from[j * across + place(i, length) * along];
      for (int i = 0; i < length; ++i) {
        float sum = 0;
        for (std::size_t k = 0; k < kernel.size(); ++k) sum += kernel[k] * line[i + k];
        to[j * across + i * along] = sum;
      }
    }
  };
  pass(picture, rows, width, height, 1, width);
  pass(rows, both, height, width, width, 1);
  return both;
}

/// Sum of the products of two kernels about the same middle.
double Product(const std::vector<float>& a, const std::vector<float>& b) {
  const std::size_t shorter = std::min(a.size(), b.size());
  const std::size_t from_a = (a.size() - shorter) / 2, from_b = (b.size() - shorter) / 2;
  double sum = 0;
  for (std::size_t i = 0; i < shorter; ++i) sum += static_cast<double>(a[from_a + i]) * b[from_b + i];
  return sum;
}

/// Noise of deviation 1 with the spectrum of a reconstruction.
class Noise {
 public:
  explicit Noise(double pixel_mm)
      : fine_(MakeKernel(kFineNoiseMm / pixel_mm)), coarse_(MakeKernel(kCoarseNoiseMm / pixel_mm)) {
    const double ff = Product(fine_, fine_), fc = Product(fine_, coarse_), cc = Product(coarse_, coarse_);
    scale_ = static_cast<float>(
        1 / std::sqrt(ff * ff - 2 * kCoarsePart * fc * fc + kCoarsePart * kCoarsePart * cc * cc));
  }

  std::vector<float> Draw(int width, int height, std::uint64_t seed) const {
    math::Random random(seed);
    std::vector<float> white(static_cast<std::size_t>(width) * height);
    for (float& value : white) {
      // the sum of twelve even numbers is nearly normal, of variance one
      double sum = -6;
      for (int i = 0; i < 12; ++i) sum += random.Uniform();
      value = static_cast<float>(sum);
    }
    std::vector<float> noise = Smooth(white, width, height, fine_, true);
    const std::vector<float> coarse = Smooth(white, width, height, coarse_, true);
    for (std::size_t i = 0; i < noise.size(); ++i)
      noise[i] = scale_ * (noise[i] - static_cast<float>(kCoarsePart) * coarse[i]);
    return noise;
  }

 private:
  std::vector<float> fine_, coarse_;
  float scale_ = 1;
};

/// Mean of the CT numbers in each pixel of a slice.
std::vector<float> MeanNumbers(const TissueVolume& tissues, CtPhase phase, const Overlaps& columns,
                               const Overlaps& rows, const std::vector<Overlaps::Part>& layers) {
  std::array<float, static_cast<std::size_t>(CtTissue::kCount)> numbers;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = static_cast<float>(FindHounsfield(static_cast<CtTissue>(i), phase));
  const std::size_t width = tissues.size[0], height = tissues.size[1], plane = width * height;
  std::vector<float> whole(plane, 0.0f);
  for (const auto& layer : layers) {
    const CtTissue* from = &tissues.tissues[layer.from * plane];
    for (std::size_t i = 0; i < plane; ++i)
      whole[i] += layer.share * numbers[static_cast<std::size_t>(from[i])];
  }
  const std::size_t made = columns.parts.size();
  std::vector<float> narrow(made * height, 0.0f), picture(made * rows.parts.size(), 0.0f);
  for (std::size_t j = 0; j < height; ++j) {
    for (std::size_t m = 0; m < made; ++m) {
      for (const auto& part : columns.parts[m])
        narrow[j * made + m] += part.share * whole[j * width + part.from];
    }
  }
  for (std::size_t n = 0; n < rows.parts.size(); ++n) {
    for (const auto& part : rows.parts[n]) {
      for (std::size_t m = 0; m < made; ++m)
        picture[n * made + m] += part.share * narrow[part.from * made + m];
    }
  }
  return picture;
}

Vec3 StepOf(const LabelVolume& labels, int axis) {
  return {labels.direction[axis][0], labels.direction[axis][1], labels.direction[axis][2]};
}

}  // namespace

std::optional<CtPhase> FindCtPhase(std::string_view name) {
  for (const CtPhase phase : {CtPhase::kNone, CtPhase::kArterial, CtPhase::kPortalVenous}) {
    if (NameOf(phase) == name) return phase;
  }
  return std::nullopt;
}

std::string_view NameOf(CtPhase phase) {
  return phase == CtPhase::kNone ? "none" : phase == CtPhase::kArterial ? "arterial" : "portal";
}

double FindHounsfield(CtTissue tissue, CtPhase phase) {
  const Numbers& numbers = kNumbers[static_cast<std::size_t>(tissue)];
  return phase == CtPhase::kNone       ? numbers.none
         : phase == CtPhase::kArterial ? numbers.arterial
                                       : numbers.portal;
}

base::Result<CtVolume> RenderCt(const TissueVolume& tissues, const CtSettings& settings, std::stop_token stop,
                                const Progress& progress) {
  if (auto status = CheckSettings(settings); !status) return status.error();
  TROCAR_ASSERT(tissues.tissues.size() == tissues.Index(0, 0, tissues.size[2]));
  const Overlaps columns(tissues.size[0], tissues.step_mm[0], settings.pixel_mm);
  const Overlaps rows(tissues.size[1], tissues.step_mm[1], settings.pixel_mm);
  const Overlaps slices(tissues.size[2], tissues.step_mm[2], settings.slice_mm);
  CtVolume volume;
  volume.size = {columns.Count(), rows.Count(), slices.Count()};
  volume.pixel_mm = settings.pixel_mm, volume.slice_mm = settings.slice_mm, volume.phase = settings.phase;
  const double wanted[3] = {settings.pixel_mm, settings.pixel_mm, settings.slice_mm};
  // both lattices begin at the same edge, not at the same centre
  for (int axis = 0; axis < 3; ++axis)
    volume.origin_mm[axis] = tissues.origin_mm[axis] + 0.5 * (wanted[axis] - tissues.step_mm[axis]);
  const std::size_t plane = static_cast<std::size_t>(volume.size[0]) * volume.size[1];
  volume.hounsfield.resize(plane * volume.size[2]);
  const Noise noise(settings.pixel_mm);
  const std::vector<float> spread = MakeKernel(settings.blur_mm / settings.pixel_mm);
  // some slices at a time, so that progress is told from one thread
  constexpr int kBatch = 8;
  for (int first = 0; first < volume.size[2]; first += kBatch) {
    if (stop.stop_requested()) return base::Error{base::ErrorCode::kCancelled, "rendering was given up"};
    if (progress) progress("rendering slices", static_cast<double>(first) / volume.size[2]);
    oneapi::tbb::parallel_for(first, std::min(first + kBatch, volume.size[2]), [&](int k) {
      auto picture = MeanNumbers(tissues, settings.phase, columns, rows, slices.parts[k]);
      picture = Smooth(picture, volume.size[0], volume.size[1], spread, false);
      const auto grain = noise.Draw(volume.size[0], volume.size[1],
                                    settings.seed * 0x9e3779b97f4a7c15ULL + static_cast<std::uint64_t>(k));
      for (std::size_t i = 0; i < plane; ++i) {
        const double value = picture[i] + settings.noise_hu * grain[i];
        volume.hounsfield[k * plane + i] =
            static_cast<std::int16_t>(std::clamp(base::RoundTo<int>(value), -1024, 3071));
      }
    });
  }
  return volume;
}

int LabelAt(const LabelVolume& labels, const std::array<double, 3>& p) {
  const Vec3 from_first = Vec3{p[0], p[1], p[2]} - Vec3{labels.origin[0], labels.origin[1], labels.origin[2]};
  std::size_t at = 0, stride = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step = StepOf(labels, axis);
    const int place = base::RoundTo<int>(Dot(from_first, step) / Dot(step, step));
    if (place < 0 || place >= labels.size[axis]) return 0;
    at += stride * static_cast<std::size_t>(place);
    stride *= labels.size[axis];
  }
  return labels.labels[at];
}

bool IsOblique(const LabelVolume& labels) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 a = StepOf(labels, axis), b = StepOf(labels, (axis + 1) % 3);
    if (std::fabs(Dot(a, b)) > 1e-3 * Norm(a) * Norm(b)) return true;
  }
  return false;
}

LabelVolume LabelsOn(const CtVolume& volume, const LabelVolume& labels) {
  TROCAR_ASSERT(!IsOblique(labels));
  LabelVolume on;
  on.size = volume.size;
  on.direction = {{{volume.pixel_mm, 0, 0}, {0, volume.pixel_mm, 0}, {0, 0, volume.slice_mm}}};
  on.origin = volume.origin_mm;
  on.names = labels.names;
  on.labels.resize(volume.hounsfield.size());
  oneapi::tbb::parallel_for(0, on.size[2], [&](int k) {
    std::size_t at = static_cast<std::size_t>(k) * on.size[0] * on.size[1];
    for (int j = 0; j < on.size[1]; ++j) {
      for (int i = 0; i < on.size[0]; ++i, ++at)
        on.labels[at] =
            LabelAt(labels, {on.origin[0] + i * volume.pixel_mm, on.origin[1] + j * volume.pixel_mm,
                             on.origin[2] + k * volume.slice_mm});
    }
  });
  return on;
}

}  // namespace trocar::images
