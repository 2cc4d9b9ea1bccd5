// SPDX-License-Identifier: Apache-2.0
#include "device_page.h"

#include <algorithm>
#include <cstdio>

#include "trocar/core/log.h"
#include "trocar/device/device_spec.h"
#include "trocar/device/force_device_spec.h"
#include "window_screenshot.h"

namespace trocar::app {
namespace {

constexpr int kWidth = 1120, kHeight = 720;
constexpr unsigned kRefresh = 33;         // [ms]
constexpr double kMeasureSeconds = 12;    // of a calibration
constexpr double kUnattendedSeconds = 5;  // the same in a run that nobody watches

Gtk::Box& MakeCard(const char* title) {
  auto* card = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL, 6);
  card->add_css_class("card");
  auto* label = Gtk::make_managed<Gtk::Label>(title);
  label->add_css_class("card-title");
  label->set_xalign(0);
  card->append(*label);
  return *card;
}

Gtk::Box& MakeRow(std::initializer_list<Gtk::Widget*> widgets) {
  auto* row = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::HORIZONTAL, 6);
  for (Gtk::Widget* widget : widgets) row->append(*widget);
  return *row;
}

void MakeText(Gtk::Label& label, const char* style) {
  label.add_css_class(style);
  label.set_wrap(true);
  label.set_xalign(0);
  label.set_max_width_chars(46);
}

}  // namespace

DevicePage::DevicePage(const Options& options, SessionControl* control)
    : options_(options), control_(control), bench_(device::FindDeviceStore()) {
  set_title("Trocar: devices");
  add_css_class("trocar");
  set_default_size(kWidth, kHeight);
  MakeContent();
  FindDevices();
  if (!options_.device.empty()) spec_.set_text(options_.device);
  if (!options_.device.empty() && options_.is_device_page) Test();
  timer_ = Glib::signal_timeout().connect(sigc::mem_fun(*this, &DevicePage::OnTime), kRefresh);
  signal_close_request().connect(
      [this] {
        timer_.disconnect();
        bench_.Close();
        return false;
      },
      false);
}

void DevicePage::MakeContent() {
  auto* left = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL, 8);
  left->set_size_request(400, -1);
  left->set_margin(10);
  left->append(MakeFound());
  left->append(MakeCalibration());
  if (control_ != nullptr) left->append(MakeUse());
  status_.add_css_class("status");
  status_.set_xalign(0);
  status_.set_ellipsize(Pango::EllipsizeMode::END);
  auto* middle = Gtk::make_managed<Gtk::Box>();
  middle->append(*left);
  middle->append(plot_);
  auto* all = Gtk::make_managed<Gtk::Box>(Gtk::Orientation::VERTICAL);
  all->append(*middle);
  all->append(status_);
  set_child(*all);
}

Gtk::Widget& DevicePage::MakeFound() {
  Gtk::Box& card = MakeCard("DEVICES");
  auto* scrolled = Gtk::make_managed<Gtk::ScrolledWindow>();
  scrolled->set_child(found_);
  scrolled->set_min_content_height(110);
  card.append(*scrolled);
  found_.signal_row_activated().connect([this](Gtk::ListBoxRow* row) {
    const auto at = static_cast<std::size_t>(row->get_index());
    if (at < devices_.size()) spec_.set_text(devices_[at].spec);
  });
  spec_.set_placeholder_text("KIND:ADDRESS, for example liberty:/dev/ttyUSB0");
  spec_.set_tooltip_text("Device to try; a + joins hands and jaws. `trocar devices list` names the kinds");
  spec_.signal_activate().connect(sigc::mem_fun(*this, &DevicePage::Test));
  card.append(spec_);
  test_.add_css_class("primary");
  test_.set_tooltip_text("Open the device and show what it says");
  stop_.set_tooltip_text("Close the device");
  find_.set_tooltip_text("Look for what has been plugged in since");
  test_.signal_clicked().connect(sigc::mem_fun(*this, &DevicePage::Test));
  stop_.signal_clicked().connect([this] {
    bench_.Close();
    Say("Closed.");
  });
  find_.signal_clicked().connect(sigc::mem_fun(*this, &DevicePage::FindDevices));
  card.append(MakeRow({&test_, &stop_, &find_}));
  return card;
}

Gtk::Widget& DevicePage::MakeCalibration() {
  Gtk::Box& card = MakeCard("HAND AND CALIBRATION");
  hand_.set_model(Gtk::StringList::create({"Left hand", "Right hand", "Laparoscope"}));
  swap_.set_tooltip_text("The left hand's sensor becomes the right hand's, and the other way round; kept");
  swap_.signal_clicked().connect([this] {
    const core::Status swapped = bench_.SwapHands();
    Say(swapped ? "Left and right are exchanged." : swapped.error().Text(), !swapped);
  });
  card.append(MakeRow({&hand_, &swap_}));
  const auto step = [this](Gtk::Button& button, CalibrationStep which, const char* tooltip) {
    button.set_tooltip_text(tooltip);
    button.signal_clicked().connect([this, which] { Begin(which); });
  };
  step(tip_, CalibrationStep::kTip, "Where the tip is, seen from its sensor: swing the handle about the tip");
  step(trocar_, CalibrationStep::kTrocar, "Where the trocar is: swing the instrument in it");
  step(jaw_, CalibrationStep::kJaw, "What the jaw sensor reads closed and open");
  card.append(MakeRow({&tip_, &trocar_, &jaw_}));
  MakeText(hint_, "name");
  MakeText(result_, "value");
  card.append(hint_);
  card.append(progress_);
  card.append(result_);
  return card;
}

Gtk::Widget& DevicePage::MakeUse() {
  Gtk::Box& card = MakeCard("IN THE OPERATION");
  use_.set_tooltip_text("The device above holds the instruments; the mouse keeps what it does not see");
  use_.signal_clicked().connect(sigc::mem_fun(*this, &DevicePage::Use));
  card.append(use_);
  haptic_name_.set_placeholder_text("haptic device");
  haptic_name_.set_text("simulated");
  haptic_name_.set_tooltip_text("Haptic devices: " + device::ListForceDrivers());
  use_haptics_.signal_clicked().connect(sigc::mem_fun(*this, &DevicePage::UseHaptics));
  check_pose_.set_tooltip_text("Confirm which haptic device is which hand");
  check_pose_.signal_clicked().connect([this] {
    if (control_->Haptics() != nullptr) control_->Haptics()->BeginCheckPose();
  });
  force_.set_tooltip_text("Asks for force, or takes it away; nothing switches it on by itself");
  force_.signal_toggled().connect([this] {
    session::HapticLoop* loop = control_->Haptics();
    if (is_showing_ || loop == nullptr) return;
    force_.get_active() ? loop->RequestArm() : loop->Stop();
  });
  card.append(MakeRow({&haptic_name_, &use_haptics_, &check_pose_, &force_}));
  MakeText(haptics_, "name");
  card.append(haptics_);
  return card;
}

void DevicePage::FindDevices() {
  while (Gtk::ListBoxRow* row = found_.get_row_at_index(0)) found_.remove(*row);
  devices_ = device::ListDevices();
  for (const device::FoundDevice& device : devices_) {
    auto* label = Gtk::make_managed<Gtk::Label>(device.spec + "   " + device.description);
    label->set_xalign(0);
    label->set_ellipsize(Pango::EllipsizeMode::END);
    found_.append(*label);
  }
  if (devices_.empty()) found_.append(*Gtk::make_managed<Gtk::Label>("nothing but mouse and keyboard"));
  if (spec_.get_text().empty() && !devices_.empty()) spec_.set_text(devices_.front().spec);
}

void DevicePage::Test() {
  said_.clear();
  if (const core::Status opened = bench_.Open(spec_.get_text()); !opened) Say(opened.error().Text(), true);
}

void DevicePage::Begin(CalibrationStep step) {
  const double seconds = options_.screenshot.empty() ? kMeasureSeconds : kUnattendedSeconds;
  result_.set_text("");
  if (const core::Status begun = bench_.Begin(step, GetHand(), seconds); !begun)
    Say(begun.error().Text(), true);
}

void DevicePage::Use() {
  // a line has one reader
  bench_.Close();
  const std::string spec = spec_.get_text().raw();
  const device::DeviceStore store = device::LoadDeviceStore(device::FindDeviceStore()).store;
  auto driver = device::MakeDriver(spec, store, device::SystemClock());
  if (!driver) return Say(driver.error().Text(), true);
  control_->UseDevice(std::move(*driver), device::FindButtons(spec, store));
  Say("The device holds the instruments.");
}

void DevicePage::UseHaptics() {
  if (control_->Haptics() != nullptr)
    return Say("A haptic device is in use already; to change it, start the window with --haptics.", true);
  const device::DeviceStore store = device::LoadDeviceStore(device::FindDeviceStore()).store;
  const core::Status used = control_->UseHaptics(haptic_name_.get_text().raw(), store.Buttons("haptics"));
  Say(used ? "Now check the pose, hold the safety switch, and ask for force." : used.error().Text(), !used);
}

void DevicePage::Say(const std::string& text, bool is_warning) {
  status_.set_text(text);
  is_warning ? status_.add_css_class("warning") : status_.remove_css_class("warning");
}

void DevicePage::ShowHaptics(double now) {
  session::HapticLoop* loop = control_ != nullptr ? control_->Haptics() : nullptr;
  for (Gtk::Widget* widget : {static_cast<Gtk::Widget*>(&check_pose_), static_cast<Gtk::Widget*>(&force_)})
    widget->set_sensitive(loop != nullptr);
  if (loop == nullptr) return;
  const session::HapticStatus& status = loop->Latest();
  haptics_.set_text(session::DescribeHaptics(status));
  const device::Channel hand = GetHand();
  if (hand < scene::kHandCount) forces_.push_back({now, status.hands[hand].force});
  while (!forces_.empty() && forces_.front().time < now - DeviceBench::kHistory) forces_.pop_front();
  is_showing_ = true;
  force_.set_active(std::any_of(
      status.hands.begin(), status.hands.end(),
      [](const session::HapticHandStatus& one) { return one.state != haptics::ArmState::kUnarmed; }));
  is_showing_ = false;
}

bool DevicePage::OnTime() {
  if (has_ended_) return true;  // what is photographed holds still
  const double now = since_start_.Seconds();
  const bool was_measuring = bench_.IsMeasuring();
  bench_.Advance(now);
  if (bench_.IsOpen() && bench_.Report().message != said_) {
    said_ = bench_.Report().message;
    Say(said_, said_.starts_with("E-"));
  }
  progress_.set_fraction(bench_.Progress());
  if (bench_.IsMeasuring()) hint_.set_text(bench_.Hint());
  if (was_measuring && !bench_.IsMeasuring()) {
    hint_.set_text("");
    result_.set_text(bench_.LastResult().text);
  }
  for (Gtk::Button* button : {&tip_, &trocar_, &jaw_, &swap_})
    button->set_sensitive(bench_.IsOpen() && !bench_.IsMeasuring());
  ShowHaptics(now);
  plot_.Show(bench_.History(), forces_, GetHand(), now);
  if (!options_.screenshot.empty() && options_.is_device_page) RunUnattended(now);
  return true;
}

/// --screenshot: waits for the device, calibrates where that is asked for, saves the picture and says what was seen.
void DevicePage::RunUnattended(double now) {
  constexpr double kLongest = 90;  // [s]
  const bool is_seen = bench_.Report().reads > 0;
  if (is_seen && !has_begun_ && !options_.calibrate.empty()) {
    has_begun_ = true;
    for (const CalibrationStep step :
         {CalibrationStep::kTip, CalibrationStep::kTrocar, CalibrationStep::kJaw}) {
      if (StepName(step) == options_.calibrate) Begin(step);
    }
  }
  const bool is_measured = options_.calibrate.empty() || (has_begun_ && !bench_.LastResult().text.empty());
  const bool is_late = now > kLongest;
  if (has_ended_ || (!is_late && !(now > options_.screenshot_after && is_seen && is_measured))) return;
  has_ended_ = true;
  if (is_late) failure_ = core::Error{core::ErrorCode::kDeviceStale, "the device said nothing: " + said_};
  Glib::signal_timeout().connect_once([this] { EndUnattended(); }, 300);
}

void DevicePage::EndUnattended() {
  constexpr int kMostTries = 50;
  const core::Status saved = SaveScreenshot(*this, options_.screenshot);
  // a window that is being laid out anew has nothing to show for a moment
  if (!saved && ++screenshot_tries_ < kMostTries) {
    Glib::signal_timeout().connect_once([this] { EndUnattended(); }, 100);
    return;
  }
  if (!saved) failure_ = saved.error();
  if (failure_) core::Log(core::LogLevel::kError, failure_->Text());
  std::printf(
      "{\"device\": \"%s\", \"reads\": %llu, \"shown\": %zu, \"calibrated\": %s, \"residual_mm\": %.3f}\n",
      bench_.Spec().c_str(), static_cast<unsigned long long>(bench_.Report().reads), bench_.History().size(),
      bench_.LastResult().is_kept ? "true" : "false", 1e3 * bench_.LastResult().residual);
  Glib::signal_timeout().connect_once([this] { close(); }, 0);
}

}  // namespace trocar::app
