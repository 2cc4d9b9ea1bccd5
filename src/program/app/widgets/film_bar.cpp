// SPDX-License-Identifier: Apache-2.0
#include "film_bar.h"

#include <utility>

#include "trocar/gui/labels.h"
#include "trocar/host/log.h"
#include "trocar/host/translate.h"
#include "trocar/presenter/replay_presenter.h"

namespace trocar::app {
namespace {

constexpr unsigned kPeriod = 100;  // between looks at the progress [ms]

}  // namespace

FilmBar::FilmBar(std::function<void(const std::string&, bool)> say)
    : Gtk::Box(Gtk::Orientation::HORIZONTAL), say_(std::move(say)), job_([this] { done_.emit(); }) {
  add_css_class("status");
  set_spacing(8);
  set_visible(false);
  bar_.set_hexpand(true);
  bar_.set_valign(Gtk::Align::CENTER);
  cancel_.set_label(host::Translate("Cancel"));
  cancel_.add_css_class("small");
  cancel_.set_focus_on_click(false);
  cancel_.set_tooltip_text(host::Translate("Give the video up; nothing is written"));
  append(text_);
  append(bar_);
  append(cancel_);
  cancel_.signal_clicked().connect([this] { is_cancelled_ = true; });
  done_.connect([this] { Finish(); });
}

FilmBar::~FilmBar() {
  is_cancelled_ = true;  // the job's end waits for it
  timer_.disconnect();
}

void FilmBar::Start(presenter::FilmRequest request) {
  if (job_.IsRunning()) return say_(host::Translate("A video is being made already; cancel it first."), true);
  request_ = std::move(request);
  is_cancelled_ = false;
  progress_.Set("Reading", 0);
  job_.Start([this, request = request_] { return presenter::MakeFilm(request, progress_, is_cancelled_); });
  set_visible(true);
  ShowProgress();
  timer_ = Glib::signal_timeout().connect([this] { return ShowProgress(); }, kPeriod);
}

bool FilmBar::ShowProgress() {
  const gui::JobProgress::Value now = progress_.Get();
  gui::SetText(text_, host::TranslateWith("Video: {1} …", {host::Translate(now.what)}));
  bar_.set_fraction(now.fraction);
  return true;
}

void FilmBar::Finish() {
  timer_.disconnect();
  set_visible(false);
  const base::Result<presenter::Film> status = job_.Take();
  if (status.ok())
    return say_(
        host::TranslateWith("Saved {1} min:s in {2}",
                            {presenter::FormatClock(status->until - status->from), request_.video.string()}),
        false);
  if (status.error().code == base::ErrorCode::kCancelled)
    return say_(host::Translate("The video was given up."), false);
  host::Log(host::LogLevel::kError, status.error().Text());
  say_(host::ShownText(status.error()), true);
}

}  // namespace trocar::app
