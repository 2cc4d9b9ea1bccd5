// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/session.h"

#include <utility>

#include "trocar/base/assert.h"
#include "trocar/device/device_spec.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/session/input_sources.h"
#include "viewer_feed.h"

namespace trocar::session {

Session::Session(simulation::Simulation simulation, std::optional<AttemptKeeping> keeping)
    : input_(simulation.GetScene(), simulation.GetSnapshot().tick + 1) {
  input_.UseHaptics(haptic_link_);
  RunnerSettings settings;
  settings.haptics = &haptic_link_;
  settings.keeping = std::move(keeping);
  settings.after_tick = [this](const simulation::Snapshot& snapshot) {
    if (ViewerFeed* feed = feed_.load(std::memory_order_acquire); feed != nullptr) feed->Add(snapshot);
  };
  runner_ = std::make_unique<Runner>(std::move(simulation), input_, std::move(settings));
  input_.OnDeviceLoss([runner = runner_.get()] { runner->SetPaused(true); });
}

Session::~Session() {
  haptic_loop_.reset();  // no force before anything else ends
  runner_.reset();
}

base::Result<std::unique_ptr<Session>> Session::Open(simulation::Simulation simulation,
                                                     const SessionOptions& options) {
  std::unique_ptr<Session> session(new Session(std::move(simulation), options.keeping));
  if (!options.haptics.empty()) {
    if (const base::Status used = session->UseHaptics(options.haptics, options.store.Buttons("haptics"));
        !used)
      return used.error();
  }
  if (!options.device.empty()) {
    auto driver = device::MakeDriver(options.device, options.store, device::SystemClock());
    if (!driver) return driver.error();
    session->UseDevice(std::move(*driver), device::FindButtons(options.device, options.store));
  }
  if (options.viewers) {
    if (const base::Status served = session->Serve(*options.viewers); !served) return served.error();
  }
  return session;
}

void Session::SetPaused(bool is_paused) {
  if (is_paused) input_.ReleasePedals();
  runner_->SetPaused(is_paused);
}

void Session::Reset() {
  input_.BeginAnew();
  runner_->Reset();
}

bool Session::CanDemonstrate() const {
  return !GetScene().script.keys.empty() || ExpertSource::Suits(GetScene());
}

Guide Session::MakeGuide() const {
  if (!GetScene().script.keys.empty())
    return {.source = std::make_shared<ScriptSource>(GetScene()), .is_hands_only = true};
  return {.source = std::make_shared<ExpertSource>(GetScene())};
}

void Session::BeginDemonstration() {
  input_.BeginAnew();
  input_.SetGuide(MakeGuide());
  runner_->Reset();
}

void Session::Demonstrate() {
  input_.SetGuide(MakeGuide());
}

void Session::UseDevice(std::unique_ptr<device::Driver> driver, const device::ButtonMap& buttons) {
  PlaceAtHome(GetScene(), *driver);
  input_.DropDevice();  // one device's line, buttons and messages end before the other's begin
  input_.UseDevice(std::make_unique<DeviceThread>(std::move(driver), buttons));
}

base::Status Session::UseHaptics(std::string_view name, const device::ButtonMap& buttons) {
  auto driver = device::MakeForceDriver(name);
  if (!driver) return driver.error();
  const auto settings =
      MakeHapticSettings(**driver, GetScene(), runner_->Latest().X_world_laparoscope, buttons);
  if (!settings) return settings.error();
  auto loop = HapticLoop::Start(std::move(*driver), *settings, haptic_link_);
  if (!loop) return loop.error();
  haptic_loop_ = std::move(*loop);
  return {};
}

base::Status Session::Serve(const net::IgtlServerSettings& settings) {
  TROCAR_ASSERT(viewers_ == nullptr);
  auto server = net::IgtlServer::Make(settings, Surfaces());
  if (!server) return server.error();
  viewers_ = std::make_unique<ViewerFeed>(std::move(*server));
  feed_.store(viewers_.get(), std::memory_order_release);
  return {};
}

int Session::ServedPort() const {
  return viewers_ != nullptr ? viewers_->Port() : -1;
}

const simulation::Snapshot& Session::Latest() {
  if (haptic_loop_ != nullptr) haptic_record_.Add(since_start_.Seconds(), haptic_loop_->Latest());
  return runner_->Latest();
}

}  // namespace trocar::session
