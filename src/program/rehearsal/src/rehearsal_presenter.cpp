// SPDX-License-Identifier: Apache-2.0
#include "trocar/rehearsal/rehearsal_presenter.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <system_error>
#include <utility>

#include "trocar/base/state_archive.h"
#include "trocar/base/state_hash.h"
#include "trocar/files/patient_file.h"
#include "trocar/host/log.h"
#include "trocar/host/partial_path.h"
#include "trocar/host/safe_file.h"
#include "trocar/host/translate.h"
#include "trocar/math/rotation_angle.h"
#include "trocar/patient/patient.h"

namespace trocar::rehearsal {
namespace {

namespace fs = std::filesystem;
using base::Error;
using base::ErrorCode;

constexpr std::size_t kLeastSlices = 2;  // with contours, of each organ

constexpr const char* kTitles[kRehearsalSteps] = {
    host::Mark("1 Images"), host::Mark("2 Liver and gallbladder"), host::Mark("3 Patient"),
    host::Mark("4 Ports and table"), host::Mark("5 Operate")};

std::string Number(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof(text), format, value);
  return host::LocalNumber(text);
}

RehearsalSeries Describe(const images::ListedSeries& listed) {
  RehearsalSeries shown;
  shown.title = host::TranslateComposed(listed.description);
  shown.about = listed.format + ", " + host::TranslateCount("{1} slice", "{1} slices", listed.slices) + ", " +
                std::to_string(listed.width) + " \u00d7 " + std::to_string(listed.height);
  if (listed.pixel_mm > 0 && listed.slice_mm > 0) {
    shown.about +=
        ", " + host::TranslateWith("pixels of {1} mm, {2} mm apart",
                                   {Number("%.2f", listed.pixel_mm), Number("%.2f", listed.slice_mm)});
  } else {
    shown.about += ", " + host::Translate("size not said: it is asked for");
  }
  if (listed.problem) shown.problem = host::ShownText(*listed.problem);
  shown.preview = listed.preview;
  return shown;
}

/// From the navel, where the patient's frame begins. Directions are the patient's.
std::string SpokenPlace(const math::Vec3& p) {
  const std::string across = Number("%.0f", std::fabs(1000 * p.x)),
                    along = Number("%.0f", std::fabs(1000 * p.y));
  const auto say = [&](const char* text) { return host::TranslateWith(text, {across, along}); };
  const bool is_left = p.x >= 0, is_up = p.y >= 0;
  if (is_up)
    return is_left ? say(host::Mark("{1} mm left, {2} mm up from the navel"))
                   : say(host::Mark("{1} mm right, {2} mm up from the navel"));
  return is_left ? say(host::Mark("{1} mm left, {2} mm down from the navel"))
                 : say(host::Mark("{1} mm right, {2} mm down from the navel"));
}

}  // namespace

RehearsalPresenter::RehearsalPresenter(fs::path folder, fs::path patients, RehearsalScreen& screen,
                                       std::function<void()> on_news)
    : folder_(std::move(folder)), patients_(std::move(patients)), screen_(screen), job_(std::move(on_news)) {}

RehearsalPresenter::~RehearsalPresenter() {
  stop_.request_stop();
}

// work beside the window, one piece after the other

void RehearsalPresenter::Run(const std::string& doing, Work work) {
  waiting_.push_back({doing, std::move(work)});
  if (!job_.IsRunning()) Begin();
}

void RehearsalPresenter::Begin() {
  Request request = std::move(waiting_.front());
  waiting_.erase(waiting_.begin());
  stop_ = {};
  progress_->Set(request.doing, -1);
  page_.doing = request.doing;
  page_.fraction = -1;
  job_.Start([work = std::move(request.work), progress = progress_, stop = stop_.get_token()] {
    return work([progress](std::string_view what,
                           double part) { progress->Set(host::TranslateComposed(what), part); },
                stop);
  });
}

void RehearsalPresenter::FinishWork() {
  const Then then = job_.Take();
  page_.doing.clear();
  then();
  if (!waiting_.empty() && !job_.IsRunning()) Begin();
  Refresh();
}

void RehearsalPresenter::ShowProgress() {
  if (!job_.IsRunning()) return;
  const gui::JobProgress::Value value = progress_->Get();
  page_.doing = stop_.stop_requested() ? host::Translate("Giving it up") : value.what;
  page_.fraction = value.fraction;
  screen_.Show(page_);
}

void RehearsalPresenter::Cancel() {
  waiting_.clear();
  stop_.request_stop();
  ShowProgress();
}

// what is kept

fs::path RehearsalPresenter::ContoursFile() const {
  base::StateHash hash;
  base::AddStateTo(hash, state_.series.string() + " " + std::to_string(state_.options.series) + " " +
                             state_.options.pattern);
  return folder_ / ("contours-" + hash.Text() + ".json");
}

void RehearsalPresenter::Keep() {
  if (!lock_) return;
  if (const auto saved = SaveRehearsal(StateFile(), state_); !saved.ok()) Complain(saved.error());
}

void RehearsalPresenter::Complain(const Error& error) {
  host::Log(host::LogLevel::kError, error.Text());
  page_.problem = error;
}

void RehearsalPresenter::Start() {
  page_.problem.reset();
  if (!lock_) {
    std::error_code ignored;
    fs::create_directories(folder_, ignored);
    auto taken = host::FileLock::Take(folder_ / "rehearsal.lock");
    if (!taken.ok()) {
      Complain({taken.error().code,
                "another window is on its way from images to an operation; go on there, or close it"});
      return Refresh();
    }
    lock_.emplace(std::move(*taken));
    auto loaded = LoadRehearsal(StateFile());
    if (loaded.ok()) {
      state_ = std::move(*loaded);
    } else {
      // it is left beside, for whoever wants to look at it
      fs::rename(StateFile(), StateFile().string() + ".unreadable", ignored);
      Complain(loaded.error());
    }
    if (!state_.images.empty()) List();
    if (!state_.built_from.empty()) LoadDraft();
  }
  Refresh();
}

void RehearsalPresenter::Forget() {
  Cancel();
  const RehearsalStep step = RehearsalStep::kImages;
  CloseSlices();
  std::error_code ignored;
  fs::remove_all(Draft(), ignored);
  state_ = {};
  state_.step = step;
  listed_.clear();
  built_.reset();
  ports_.Forget();
  page_.series.clear();
  page_.problem.reset();
  Keep();
  Refresh();
}

void RehearsalPresenter::Leave() {
  if (series_) {
    if (const auto saved = screen_.SaveContours(); !saved.ok()) Complain(saved.error());
  }
  ReleasePort();
  Keep();
}

// steps

bool RehearsalPresenter::IsStale() const {
  if (state_.built_from.empty()) return false;
  const std::string now = Fingerprint(state_, ContoursFile());
  return !now.empty() && now != state_.built_from;
}

bool RehearsalPresenter::CanOpen(RehearsalStep step) const {
  if (!lock_) return false;
  const bool has_organs = state_.source == OrganSource::kLabels
                              ? labels_ && !labels_->problem
                              : state_.source == OrganSource::kContours &&
                                    std::all_of(contoured_.begin(), contoured_.end(),
                                                [](std::size_t n) { return n >= kLeastSlices; });
  switch (step) {
    case RehearsalStep::kImages:
      return true;
    case RehearsalStep::kOrgans:
      return series_.has_value();
    case RehearsalStep::kPatient:
      return (series_ && has_organs) || IsBuilt();
    case RehearsalStep::kPorts:
    case RehearsalStep::kOperate:
      return IsBuilt() && !page_.is_stale;
  }
  return false;
}

void RehearsalPresenter::GoTo(RehearsalStep step) {
  if (!CanOpen(step)) return Refresh();
  page_.problem.reset();
  if (state_.step == RehearsalStep::kOrgans && series_) {
    if (const auto saved = screen_.SaveContours(); !saved.ok()) Complain(saved.error());
  }
  ReleasePort();
  page_.is_stale = IsStale();
  state_.step = step;
  Keep();
  const bool is_due = !IsBuilt() || page_.is_stale;
  if (step == RehearsalStep::kPatient && is_due && !IsBusy()) return Build();
  ShowPorts();
  Refresh();
}

void RehearsalPresenter::GoOn() {
  if (state_.step == RehearsalStep::kOperate) return Operate();
  GoTo(static_cast<RehearsalStep>(static_cast<int>(state_.step) + 1));
}

void RehearsalPresenter::GoBack() {
  if (state_.step != RehearsalStep::kImages)
    GoTo(static_cast<RehearsalStep>(static_cast<int>(state_.step) - 1));
}

// images

void RehearsalPresenter::ChooseImages(const fs::path& path) {
  if (!lock_ || path.empty()) return;
  page_.problem.reset();
  Leave();
  CloseSlices();
  state_.images = path;
  state_.series.clear();
  state_.options = {};
  state_.step = RehearsalStep::kImages;
  Keep();
  List();
  Refresh();
}

void RehearsalPresenter::List() {
  listed_.clear();
  page_.series.clear();
  Run(host::Translate("Looking for images"),
      [this, path = state_.images](const auto& progress, const auto& stop) -> Then {
        auto listed = images::ListSeries(path, progress, stop);
        return [this, path, listed = std::move(listed)]() mutable {
          if (path == state_.images) TakeSeries(std::move(listed));
        };
      });
}

void RehearsalPresenter::TakeSeries(base::Result<std::vector<images::ListedSeries>> listed) {
  if (!listed.ok()) {
    if (listed.error().code != ErrorCode::kCancelled) Complain(listed.error());
    if (state_.step <= RehearsalStep::kOrgans) state_.step = RehearsalStep::kImages;
    return;
  }
  listed_ = std::move(*listed);
  for (const images::ListedSeries& one : listed_) page_.series.push_back(Describe(one));
  // the one that was looked at before, or the only one that is a volume
  const auto volumes =
      std::count_if(listed_.begin(), listed_.end(), [](const auto& one) { return one.is_volume; });
  for (std::size_t i = 0; i < listed_.size(); ++i) {
    const images::ListedSeries& one = listed_[i];
    const bool is_same = one.path == state_.series && one.options.series == state_.options.series;
    const bool is_only = state_.series.empty() && volumes == 1 && one.is_volume && !one.problem;
    if (!is_same && !is_only) continue;
    if (is_only) return ChooseSeries(i);
    page_.chosen_series = i;
    return OpenSlices();
  }
}

void RehearsalPresenter::ChooseSeries(std::size_t index) {
  if (index >= listed_.size() || listed_[index].problem) return;
  const images::ListedSeries& one = listed_[index];
  if (page_.chosen_series == index && series_) return;
  page_.problem.reset();
  Leave();
  CloseSlices();
  page_.chosen_series = index;
  state_.series = one.path;
  state_.options = one.options;
  state_.source = OrganSource::kNone;
  state_.labels.clear();
  state_.liver = state_.gallbladder = 0;
  Keep();
  OpenSlices();
  Refresh();
}

void RehearsalPresenter::OpenSlices() {
  editor::ContourOptions options;
  options.images = state_.series;
  options.series = state_.options;
  options.points = ContoursFile();
  screen_.ShowSlices(options);
}

void RehearsalPresenter::CloseSlices() {
  series_.reset();
  labels_.reset();
  contoured_ = {0, 0};
  page_.chosen_series.reset();
  screen_.ShowSlices(std::nullopt);
}

void RehearsalPresenter::SlicesOpened(const images::ImageSeriesInfo& series,
                                      const images::ImageSeriesOptions& options) {
  series_ = series;
  // which series it is stays as it was chosen
  state_.options.pixel_mm = options.pixel_mm, state_.options.slice_mm = options.slice_mm;
  state_.options.axes = options.axes;
  Keep();
  if (state_.source == OrganSource::kLabels) CheckLabels();
  page_.is_stale = IsStale();
  Refresh();
}

// organs

void RehearsalPresenter::ChooseLabels(const fs::path& file) {
  if (!series_ || file.empty()) return;
  page_.problem.reset();
  state_.source = OrganSource::kLabels;
  state_.labels = file;
  state_.liver = state_.gallbladder = 0;
  Keep();
  CheckLabels();
  Refresh();
}

void RehearsalPresenter::NameLabels(int liver, int gallbladder) {
  if (state_.source != OrganSource::kLabels || (liver == state_.liver && gallbladder == state_.gallbladder))
    return;
  page_.problem.reset();
  state_.liver = liver, state_.gallbladder = gallbladder;
  Keep();
  if (liver != 0 && gallbladder != 0) CheckLabels();
  Refresh();
}

void RehearsalPresenter::CheckLabels() {
  labels_.reset();
  screen_.ShowOverlay(std::nullopt);
  Run(host::Translate("Looking at the label map"),
      [this, file = state_.labels, liver = state_.liver, gallbladder = state_.gallbladder, series = *series_,
       slices = state_.series, opening = state_.options](const auto&, const auto&) -> Then {
        auto map = ReadLabelMap(file, liver, gallbladder, series, slices, opening);
        return [this, file, map = std::move(map)]() mutable {
          if (file == state_.labels && state_.source == OrganSource::kLabels && series_)
            TakeLabels(std::move(map));
        };
      });
}

void RehearsalPresenter::TakeLabels(base::Result<LabelMap> map) {
  if (!map.ok()) {
    Complain(map.error());
    state_.source = OrganSource::kNone;
    state_.labels.clear();
    if (state_.step > RehearsalStep::kOrgans && !IsBuilt()) state_.step = RehearsalStep::kOrgans;
    Keep();
    return;
  }
  screen_.ShowOverlay(std::move(map->aligned));
  map->aligned = {};
  if (map->problem) Complain(*map->problem);
  labels_ = std::move(*map);
  page_.is_stale = IsStale();
}

void RehearsalPresenter::DrawContours() {
  if (!series_) return;
  page_.problem.reset();
  labels_.reset();
  screen_.ShowOverlay(std::nullopt);
  state_.source = OrganSource::kContours;
  Keep();
  Refresh();
}

void RehearsalPresenter::SetContoured(std::size_t liver_slices, std::size_t gallbladder_slices) {
  if (contoured_ == std::array{liver_slices, gallbladder_slices}) return;
  contoured_ = {liver_slices, gallbladder_slices};
  Refresh();
}

// patient

void RehearsalPresenter::Build() {
  if (!lock_ || IsBusy() || state_.source == OrganSource::kNone) return Refresh();
  page_.problem.reset();
  if (series_) {
    if (const auto saved = screen_.SaveContours(); !saved.ok()) {
      Complain(saved.error());
      return Refresh();
    }
  }
  const std::string fingerprint = Fingerprint(state_, ContoursFile());
  Run(host::Translate("Building the patient"),
      [this, state = state_, contours = ContoursFile(), draft = Draft(), fingerprint](
          const auto& progress, const auto& stop) -> Then {
        auto built = BuildRehearsed(state, contours, draft, progress, stop);
        return [this, fingerprint, built = std::move(built)]() mutable {
          TakeBuilt(std::move(built), fingerprint);
        };
      });
  Refresh();
}

void RehearsalPresenter::UseBuilt(RehearsedPatient built) {
  built_ = std::move(built);
  ports_.Begin(built_->patient);
  page_.check = DescribeCheck(*built_);
  page_.origin = DescribeOrigin(built_->patient);
  screen_.ShowFigure(built_->patient);
}

void RehearsalPresenter::TakeBuilt(base::Result<RehearsedPatient> built, const std::string& built_from) {
  if (!built.ok()) {
    if (built.error().code != ErrorCode::kCancelled) Complain(built.error());
    return;
  }
  UseBuilt(std::move(*built));
  state_.built_from = built_from;
  state_.notes = built_->notes;
  state_.plan.reset();
  state_.kept.clear();
  page_.is_stale = IsStale();
  page_.ports.chosen = 0;
  Keep();
  ShowPorts();
}

void RehearsalPresenter::LoadDraft() {
  Run(host::Translate("Reading the patient"),
      [this, draft = Draft(), notes = state_.notes](const auto&, const auto&) -> Then {
        auto read = ReadRehearsed(draft, notes);
        return [this, read = std::move(read)]() mutable {
          if (!read.ok()) {
            Complain({read.error().code, read.error().message + "; build the patient again"});
            state_.built_from.clear();
            if (state_.step > RehearsalStep::kImages)
              state_.step = series_ ? RehearsalStep::kOrgans : RehearsalStep::kImages;
            return Keep();
          }
          UseBuilt(std::move(*read));
          if (state_.plan) PortEditor::Use(*state_.plan, built_->patient);
          page_.is_stale = IsStale();
          ShowPorts();
        };
      });
}

void RehearsalPresenter::ShowPorts() {
  if (!IsBuilt()) return;
  const bool has_ports = state_.step >= RehearsalStep::kPorts;
  screen_.ShowPorts(built_->patient, has_ports ? std::optional(page_.ports.chosen) : std::nullopt);
}

// ports and table

/// After whatever may have moved one.
void RehearsalPresenter::KeepPorts() {
  auto change = ports_.FindChange(built_->patient);
  if (change != state_.plan) {
    state_.plan = std::move(change);
    Keep();
  }
  ShowPorts();
  Refresh();
}

void RehearsalPresenter::ChoosePort(std::size_t port) {
  if (!IsBuilt() || port >= built_->patient.ports.size()) return;
  page_.ports.chosen = port;
  ShowPorts();
  Refresh();
}

void RehearsalPresenter::MovePort(double left_mm, double up_mm) {
  if (!IsBuilt() || page_.ports.chosen >= built_->patient.ports.size()) return;
  const math::Vec3 place = built_->patient.ports[page_.ports.chosen].position;
  const auto moved =
      ports_.Move(built_->patient, page_.ports.chosen, place.x + 0.001 * left_mm, place.y + 0.001 * up_mm);
  page_.problem = moved.ok() ? std::nullopt : std::optional(moved.error());
  KeepPorts();
}

void RehearsalPresenter::GrabPort(std::size_t port) {
  if (!IsBuilt() || port >= built_->patient.ports.size()) return;
  page_.problem.reset();
  page_.ports.chosen = port;
  ports_.Grab(built_->patient);
  ShowPorts();
  Refresh();
}

void RehearsalPresenter::DragPort(const math::Vec3& p_world) {
  if (!ports_.IsGrabbed() || !IsBuilt()) return;
  const auto moved = ports_.Move(built_->patient, page_.ports.chosen, p_world.x, p_world.y);
  page_.problem = moved.ok() ? std::nullopt : std::optional(moved.error());
  if (moved.ok()) ShowPorts();
  Refresh();
}

void RehearsalPresenter::ReleasePort() {
  if (!ports_.IsGrabbed() || !IsBuilt()) return;
  ports_.Release(built_->patient);
  KeepPorts();
}

void RehearsalPresenter::TiltTable(double head_up_deg, double right_up_deg) {
  if (IsBuilt() && ports_.Tilt(built_->patient, head_up_deg, right_up_deg)) KeepPorts();
}

void RehearsalPresenter::Undo() {
  if (!IsBuilt() || !ports_.Undo(built_->patient)) return;
  page_.problem.reset();
  KeepPorts();
}

void RehearsalPresenter::Redo() {
  if (!IsBuilt() || !ports_.Redo(built_->patient)) return;
  page_.problem.reset();
  KeepPorts();
}

void RehearsalPresenter::ResetPorts() {
  if (!IsBuilt()) return;
  page_.problem.reset();
  ports_.Reset(built_->patient);
  KeepPorts();
}

// the operation

/// The patient among those that are operated on; one that was there already where nothing has changed since, so that attempts stay
/// those of the same patient.
base::Result<fs::path> RehearsalPresenter::KeepPatient() {
  std::error_code failure;
  fs::create_directories(patients_, failure);
  const host::PartialPath part(patients_ / "from-images");
  if (auto status = files::WritePatient(part.Path(), built_->patient); !status.ok()) return status.error();
  if (!state_.kept.empty()) {
    const auto now = host::ReadFile(part.Path() / "patient.json"),
               kept = host::ReadFile(state_.kept / "patient.json");
    if (now.ok() && kept.ok() && *now == *kept) return state_.kept;
  }
  fs::path target = patients_ / "from-images";
  for (int n = 2; fs::exists(target, failure); ++n) target = patients_ / ("from-images-" + std::to_string(n));
  fs::rename(part.Path(), target, failure);
  if (failure)
    return Error{ErrorCode::kFileUnwritable, target.string() + " cannot be written: " + failure.message()};
  return target;
}

void RehearsalPresenter::Operate() {
  if (!CanOpen(RehearsalStep::kOperate)) return Refresh();
  page_.problem.reset();
  auto kept = KeepPatient();
  if (!kept.ok()) {
    Complain(kept.error());
    return Refresh();
  }
  state_.kept = *kept;
  state_.step = RehearsalStep::kOperate;
  Leave();
  Refresh();
  screen_.Operate(*kept);
}

// what is shown

std::string RehearsalPresenter::HintText() const {
  if (!lock_) return {};
  switch (state_.step) {
    case RehearsalStep::kImages:
      if (listed_.empty())
        return host::Translate(
            "Choose the folder of a DICOM study or of numbered pictures, or a NIfTI, NRRD or MetaImage file. "
            "It "
            "is read here and stays on this computer.");
      if (!series_)
        return page_.chosen_series
                   ? host::Translate(
                         "The series is being opened. Where the pictures do not say how large they are and "
                         "how "
                         "they lie, say it above them.")
                   : host::Translate("Choose the series that shows liver and gallbladder best.");
      return host::Translate(
          "Look through the slices with the wheel or the bar below. Go on if liver and gallbladder are "
          "whole.");
    case RehearsalStep::kOrgans:
      if (state_.source == OrganSource::kLabels && labels_ && labels_->problem)
        return host::Translate("Say which labels are liver and gallbladder, take another map, or draw them.");
      if (state_.source == OrganSource::kLabels && labels_)
        return host::Translate(
            "Does the blue line follow the organs on every slice? Then go on; else take another map, or "
            "draw.");
      if (state_.source == OrganSource::kContours) {
        return host::TranslateWith(
            "Draw the liver on at least two slices, and the gallbladder (now: {1} and {2}). Click points, "
            "Enter closes; F1 "
            "shows all keys. It is kept by itself.",
            {std::to_string(contoured_[0]), std::to_string(contoured_[1])});
      }
      return host::Translate(
          "Take a label map that was drawn or computed on this series, or draw the outlines yourself.");
    case RehearsalStep::kPatient:
      if (IsBusy())
        return host::Translate("The patient is being built. You may give it up; then nothing is left of it.");
      if (!IsBuilt()) return host::Translate("Build the patient, or go back and take another map, or draw.");
      if (page_.is_stale)
        return host::Translate("What the patient was built from has changed: build it again.");
      return host::Translate(
          "Turn the patient with the mouse. Look at what was found; go back to mend it, or go on.");
    case RehearsalStep::kPorts:
      return host::Translate(
          "Drag a port in the picture, or choose it and press the arrow keys (with Shift: 5 mm). Undo takes "
          "back.");
    case RehearsalStep::kOperate:
      return host::Translate(
          "This is what the patient is made of. Operate starts the whole operation on it.");
  }
  return {};
}

void RehearsalPresenter::RefreshPorts() {
  RehearsalPorts& shown = page_.ports;
  shown.list.clear();
  shown.can_undo = ports_.CanUndo(), shown.can_redo = ports_.CanRedo();
  if (!IsBuilt()) return;
  const patient::Patient& patient = built_->patient;
  for (const patient::Port& port : patient.ports) {
    shown.list.push_back({SpokenUse(port.use), SpokenPlace(port.position), SpokenReason(port.reason)});
  }
  const patient::Table table = patient.table.value_or(patient::Table{});
  shown.head_up_deg = table.head_up / math::kDegree, shown.right_up_deg = table.right_up / math::kDegree;
  shown.table_reason = SpokenReason(table.reason);
  shown.is_proposal = !ports_.FindChange(patient);
}

void RehearsalPresenter::RefreshSteps() {
  for (std::size_t i = 0; i < kRehearsalSteps; ++i) {
    const auto step = static_cast<RehearsalStep>(i);
    page_.steps[i] = {host::Translate(kTitles[i]), CanOpen(step), false};
    const bool is_last = i + 1 == kRehearsalSteps;
    page_.steps[i].is_done =
        is_last ? !state_.kept.empty() && CanOpen(step) : CanOpen(static_cast<RehearsalStep>(i + 1));
  }
  page_.can_go_back = state_.step != RehearsalStep::kImages &&
                      CanOpen(static_cast<RehearsalStep>(static_cast<int>(state_.step) - 1));
  page_.can_go_on =
      !IsBusy() && (state_.step == RehearsalStep::kOperate
                        ? CanOpen(RehearsalStep::kOperate)
                        : CanOpen(static_cast<RehearsalStep>(static_cast<int>(state_.step) + 1)));
}

void RehearsalPresenter::Refresh() {
  page_.step = state_.step;
  page_.images = state_.images.string();
  page_.source = state_.source;
  page_.labels = state_.labels.string();
  page_.label_choices = labels_ ? labels_->choices : std::vector<LabelChoice>{};
  page_.liver = labels_ ? labels_->liver : 0, page_.gallbladder = labels_ ? labels_->gallbladder : 0;
  if (state_.liver != 0) page_.liver = state_.liver;
  if (state_.gallbladder != 0) page_.gallbladder = state_.gallbladder;
  page_.is_built = IsBuilt();
  if (!IsBuilt()) page_.check.clear(), page_.origin.clear();
  RefreshPorts();
  RefreshSteps();
  page_.hint = HintText();
  screen_.Show(page_);
}

}  // namespace trocar::rehearsal
