// SPDX-License-Identifier: Apache-2.0
#include "device_page.h"

#include "play_screenshot.h"
#include "trocar/device/device_spec.h"
#include "trocar/gui/labels.h"
#include "trocar/gui/over_card.h"
#include "trocar/host/translate.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 1120, kHeight = 720, kCardsWidth = 400;
constexpr unsigned kRefresh = 33;      // [ms]
constexpr unsigned kSettleTime = 300;  // before a picture is taken [ms]

}  // namespace

DevicePage::DevicePage(const presenter::Options& options, presenter::SessionControl* control)
    : presenter_(options, device::FindDeviceStore(), control, *this) {
  set_title(host::Translate("Trocar: devices"));
  add_css_class("trocar");
  gui::FitToScreen(*this, kWidth, kHeight);
  if (control != nullptr) use_.emplace(presenter_);
  MakeContent();
  presenter_.Start();
  timer_ = Glib::signal_timeout().connect(sigc::mem_fun(*this, &DevicePage::OnTime), kRefresh);
  property_is_active().signal_changed().connect([this] { tips_.End(); });
  signal_close_request().connect(
      [this] {
        timer_.disconnect();
        presenter_.Stop();
        return false;
      },
      false);
}

DevicePage::~DevicePage() {
  timer_.disconnect();
}

void DevicePage::MakeContent() {
  auto* left = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL, 8);
  left->set_size_request(kCardsWidth, -1);
  left->set_hexpand(false);
  left->set_margin(10);
  left->append(found_);
  left->append(calibration_);
  if (use_) left->append(*use_);
  tips_.Adopt(*left);
  status_.add_css_class("status");
  status_.set_xalign(0);
  status_.set_wrap(true);
  auto* scroller = Gtk::make_managed<Gtk::ScrolledWindow>();
  scroller->set_policy(Gtk::PolicyType::NEVER, Gtk::PolicyType::AUTOMATIC);
  scroller->set_vexpand(true);
  scroller->set_child(*left);
  auto* middle = Gtk::make_managed<Gtk::Box>();
  middle->append(*scroller);
  middle->append(plot_);
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  auto* around = Gtk::make_managed<Gtk::ScrolledWindow>();
  around->set_policy(Gtk::PolicyType::AUTOMATIC, Gtk::PolicyType::AUTOMATIC);
  around->set_vexpand(true);
  around->set_child(*middle);
  all->append(*around);
  all->append(status_);
  set_child(*all);
}

bool DevicePage::OnTime() {
  const presenter::DevicePageRun::Step step = presenter_.Advance(since_start_.Seconds());
  const bool is_over =
      step == presenter::DevicePageRun::Step::kSave || step == presenter::DevicePageRun::Step::kGiveUp;
  if (is_over) Glib::signal_timeout().connect_once([this] { EndDeviceRun(*this, presenter_); }, kSettleTime);
  return !is_over;  // what is photographed holds still
}

void DevicePage::Show(const presenter::DevicePageState& state) {
  found_.Show(state);
  calibration_.Show(state);
  if (use_) use_->Show(state);
  gui::SetText(status_, state.status);
  gui::SetClass(status_, "warning", state.is_status_warning);
}

}  // namespace trocar::app
