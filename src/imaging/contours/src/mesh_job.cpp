// SPDX-License-Identifier: Apache-2.0
#include "trocar/contours/mesh_job.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "trocar/base/to_integer.h"
#include "trocar/contours/contour_fill.h"
#include "trocar/contours/contour_morph.h"
#include "trocar/geometry/mesh_measures.h"
#include "trocar/host/clock.h"
#include "trocar/meshing/volume.h"
#include "trocar/meshing/volume_mesher.h"

namespace trocar::contours {

using math::Vec2;

namespace {

using base::Error;
using base::ErrorCode;

constexpr int kCoarseSamples = 56, kFineSamples = 112;  // along the longest side
constexpr double kCubicMmPerMl = 1000.0;
constexpr double kCoarseOversampling = 3;

/// Slices between slices, where single contours can be matched: thin lobes then have no teeth.
std::vector<meshing::FilledSlice> InsertMatched(const std::vector<meshing::FilledSlice>& slices,
                                                const std::vector<std::vector<std::vector<Vec2>>>& curves,
                                                double step_mm) {
  std::vector<meshing::FilledSlice> dense;
  for (std::size_t s = 0; s < slices.size(); ++s) {
    dense.push_back(slices[s]);
    if (s + 1 == slices.size() || curves[s].size() != 1 || curves[s + 1].size() != 1) continue;
    const double gap = slices[s + 1].position_mm - slices[s].position_mm;
    const int parts = base::CeilTo<int>(gap / step_mm - 1e-9);
    if (parts < 2) continue;
    const ContourMatch match = MatchContours(curves[s][0], curves[s + 1][0]);
    for (int part = 1; part < parts; ++part) {
      const double t = static_cast<double>(part) / parts;
      meshing::FilledSlice between{slices[s].position_mm + t * gap, FillArea({match.At(t)}, {})};
      if (between.mask.Count() > 0) dense.push_back(std::move(between));
    }
  }
  return dense;
}

}  // namespace

double CalcPreviewSpacing(double extent_mm, double pixel_mm, MeshLevel level) {
  const int samples = level == MeshLevel::kCoarse ? kCoarseSamples : kFineSamples;
  // the files' own limits of spacing keep a lattice of one point or of millions away
  return std::clamp(extent_mm / samples, std::max(pixel_mm, 0.05), 50.0);
}

base::Result<OrganMesh> MakePreviewMesh(const MeshRequest& request, SliceFits& fits, MeshLevel level,
                                        const MeshProgress& progress) {
  const host::Stopwatch stopwatch;
  const Error given_up{ErrorCode::kCancelled, "the preview was given up"};
  const auto report_progress = [&](std::string_view what, double fraction) {
    return !progress || progress(what, fraction);
  };
  const auto& slices = request.content.slices;
  std::vector<meshing::FilledSlice> filled;
  std::vector<std::vector<std::vector<Vec2>>> curves;  // of each slice; empty where it has holes
  int low_x = 1 << 30, low_y = low_x, high_x = -low_x, high_y = -low_x;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    if (!report_progress("following contours",
                         0.4 * static_cast<double>(i) / static_cast<double>(slices.size()))) {
      return given_up;
    }
    if (slices[i].contours.empty()) continue;
    const auto fit = fits.Find(request.structure, slices[i], request.content.adaption);
    if (!fit.ok()) return fit.error();
    meshing::FilledSlice slice{request.slice_mm * slices[i].slice,
                               FillArea((*fit)->ContourCurves(), (*fit)->HoleCurves())};
    // a sliver between pixel centres encloses none; the build says so, the preview goes on without it
    if (slice.mask.Count() == 0) continue;
    low_x = std::min(low_x, slice.mask.x0), high_x = std::max(high_x, slice.mask.x0 + slice.mask.width);
    low_y = std::min(low_y, slice.mask.y0), high_y = std::max(high_y, slice.mask.y0 + slice.mask.height);
    filled.push_back(std::move(slice));
    curves.push_back((*fit)->holes.empty() ? (*fit)->ContourCurves() : std::vector<std::vector<Vec2>>{});
  }
  if (filled.size() < 2) {
    return Error{ErrorCode::kContourTooShort,
                 request.content.name + ": a volume needs closed contours in two slices; " +
                     (filled.empty() ? "there is none yet" : "there is one so far")};
  }
  const double extent = std::max({request.pixel_mm * (high_x - low_x), request.pixel_mm * (high_y - low_y),
                                  filled.back().position_mm - filled.front().position_mm});
  OrganMesh organ;
  organ.level = level;
  organ.spacing_mm = CalcPreviewSpacing(extent, request.pixel_mm, level);

  if (!report_progress("interpolating slices", 0.4)) return given_up;
  if (level == MeshLevel::kFine) filled = InsertMatched(filled, curves, organ.spacing_mm);
  auto volume = meshing::MakeVolume(filled, request.pixel_mm, organ.spacing_mm);
  if (!volume.ok()) return Error{volume.error().code, request.content.name + ": " + volume.error().message};
  if (!report_progress("making the surface", 0.7)) return given_up;
  meshing::MeshingSettings settings;
  settings.triangle_budget = request.content.triangle_budget;
  settings.distance_samples = 0;
  if (level == MeshLevel::kCoarse) settings.oversampling = kCoarseOversampling;
  auto meshed = meshing::MeshVolume(std::move(*volume), settings);
  if (!meshed.ok()) return Error{meshed.error().code, request.content.name + ": " + meshed.error().message};
  organ.mesh = std::move(meshed->mesh);
  const geometry::MeshReport& report = meshed->quality.surface;
  organ.is_closed = report.closed;
  organ.is_manifold = report.manifold;
  organ.volume_ml = report.volume / kCubicMmPerMl;
  organ.seconds = stopwatch.Seconds();
  return organ;
}

MeshJob::MeshJob(std::shared_ptr<SliceFits> fits, std::function<void()> on_change)
    : fits_(std::move(fits)), on_change_(std::move(on_change)), thread_([this] { Run(); }) {}

MeshJob::~MeshJob() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void MeshJob::Request(MeshRequest request) {
  {
    const std::lock_guard lock(mutex_);
    const int structure = request.structure;
    if (state_.is_busy && state_.structure == structure) is_given_up_ = true;
    // what an older request of it gave is out of date
    std::erase_if(outcomes_, [structure](const MeshOutcome& o) { return o.structure == structure; });
    waiting_[structure] = {std::move(request), MeshLevel::kCoarse, ++requests_};
  }
  wake_.notify_all();
}

void MeshJob::Cancel() {
  const std::lock_guard lock(mutex_);
  waiting_.clear();
  is_given_up_ = state_.is_busy;
}

std::vector<MeshOutcome> MeshJob::Take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(outcomes_, {});
}

MeshJob::State MeshJob::GetState() const {
  const std::lock_guard lock(mutex_);
  State state = state_;
  state.is_busy = state.is_busy || !waiting_.empty();
  return state;
}

std::optional<MeshJob::Waiting> MeshJob::NextWaiting() const {
  const Waiting* next = nullptr;
  for (const auto& [structure, waiting] : waiting_) {
    // coarse ones first, and among equals what was asked for last
    if (next == nullptr || std::pair(waiting.level != MeshLevel::kCoarse, next->number) <
                               std::pair(next->level != MeshLevel::kCoarse, waiting.number)) {
      next = &waiting;
    }
  }
  if (next == nullptr) return std::nullopt;
  return *next;
}

void MeshJob::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return is_ending_ || !waiting_.empty(); });
    if (is_ending_) return;
    const Waiting task = *NextWaiting();
    const int structure = task.request.structure;
    waiting_.erase(structure);
    is_given_up_ = false;
    state_ = {true, structure, "", 0};
    lock.unlock();
    on_change_();
    auto result =
        MakePreviewMesh(task.request, *fits_, task.level, [this](std::string_view what, double fraction) {
          bool goes_on;
          {
            const std::lock_guard progress_lock(mutex_);
            state_.what = what;
            state_.fraction = fraction;
            goes_on = !is_given_up_ && !is_ending_;
          }
          on_change_();
          return goes_on;
        });
    lock.lock();
    state_ = {};
    if (!is_given_up_ && !is_ending_) {
      if (result.ok() && task.level == MeshLevel::kCoarse) {
        waiting_.emplace(structure, Waiting{task.request, MeshLevel::kFine, task.number});
      }
      outcomes_.push_back({structure, std::move(result)});
    }
    const bool is_over = is_ending_;
    lock.unlock();
    if (!is_over) on_change_();
    lock.lock();
  }
}

}  // namespace trocar::contours
