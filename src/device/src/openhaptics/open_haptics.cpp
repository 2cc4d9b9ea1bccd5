// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/open_haptics.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "hands/force_mailbox.h"
#include "hd_library.h"
#include "trocar/device/ports.h"

namespace trocar::device {
namespace {

using core::ErrorCode;
using math::Vec3;

constexpr std::size_t kMaxDevices = ForceMailbox::kMaxDevices;
constexpr double kMillimetre = 0.001;
constexpr double kLongestWait = 0.5;  // for the scheduler to end [s]
/// Errors that one frame may leave in the library's queue.
constexpr int kMaxErrors = 16;

/// The library has one scheduler and one current device.
std::atomic<bool> is_library_taken{false};

Vec3 FromMillimetres(const double* v) noexcept {
  return Vec3{v[0], v[1], v[2]} * kMillimetre;
}

/// Rotation of a column-major 4 x 4 matrix.
math::Quaternion RotationOf(const std::array<double, 16>& m) noexcept {
  const Vec3 x = math::Normalized(Vec3{m[0], m[1], m[2]}, {1, 0, 0});
  const Vec3 y =
      math::Normalized(Vec3{m[4], m[5], m[6]} - x * math::Dot(x, Vec3{m[4], m[5], m[6]}), {0, 1, 0});
  return math::RotationFromAxes(x, y, math::Cross(x, y));
}

}  // namespace

struct OpenHaptics::Content {
  explicit Content(const OpenHapticsSettings& wanted) : settings(wanted) {}

  OpenHapticsSettings settings;
  std::unique_ptr<hd::Library> libhd;
  std::vector<hd::Handle> devices;
  std::vector<ForceLimits> limits;
  hd::SchedulerHandle callback = 0;

  ForceMailbox mailbox;
  ForceMailbox::Reports newest;  // of the library's thread
  std::array<bool, kMaxDevices> is_warm{};
  std::atomic<bool> is_stopping{false}, has_stopped{false};

  static hd::CallbackCode OnTick(void* self) { return static_cast<Content*>(self)->Tick(); }
  hd::CallbackCode Tick() noexcept;
  void ReadDevice(std::size_t i) noexcept;
  bool TakeErrors(std::size_t i) noexcept;
  core::Status OpenDevice(const std::string& name);
  core::Error LibraryError(const std::string& what, unsigned int code) const;
};

core::Error OpenHaptics::Content::LibraryError(const std::string& what, unsigned int code) const {
  const char* text = libhd->get_error_string(code);
  return {ErrorCode::kDeviceLost, what + ": " + (text != nullptr ? text : "unknown error") +
                                      "; run the maker's diagnostic program, and check plug and power"};
}

core::Status OpenHaptics::Content::OpenDevice(const std::string& name) {
  const hd::Handle device = libhd->init_device(name.c_str());
  const hd::ErrorInfo error = libhd->get_error();
  if (device == hd::kInvalidHandle || (error.code != hd::kSuccess && !hd::IsPassing(error.code)))
    return LibraryError("\"" + name + "\" does not open", error.code);
  devices.push_back(device);
  libhd->make_current(device);
  ForceLimits limit;
  libhd->get_doubles(hd::kMaxForce, &limit.max_force);
  libhd->get_doubles(hd::kMaxContinuousForce, &limit.max_continuous_force);
  double newtons_per_millimetre = 0;
  libhd->get_doubles(hd::kMaxStiffness, &newtons_per_millimetre);
  limit.max_stiffness = newtons_per_millimetre / kMillimetre;
  std::array<double, 6> box{};
  libhd->get_doubles(hd::kUsableWorkspace, box.data());
  limit.workspace_min = FromMillimetres(box.data());
  limit.workspace_max = FromMillimetres(box.data() + 3);
  if (!(limit.max_force > 0.0) || !std::isfinite(limit.max_force)) {
    return core::Error{
        ErrorCode::kDeviceSettings,
        "\"" + name + "\" does not say how much force it bears; no force can be sent to it safely"};
  }
  limits.push_back(limit);
  libhd->enable(hd::kForceOutput);
  return {};
}

void OpenHaptics::Content::ReadDevice(std::size_t i) noexcept {
  ForceSample& sample = newest[i];
  std::array<double, 3> v{};
  std::array<double, 16> m{};
  libhd->get_doubles(hd::kPosition, v.data());
  sample.position = FromMillimetres(v.data());
  libhd->get_doubles(hd::kVelocity, v.data());
  sample.velocity = FromMillimetres(v.data());
  libhd->get_doubles(hd::kTransform, m.data());
  sample.orientation = RotationOf(m);
  int buttons = 0;
  libhd->get_integers(hd::kButtons, &buttons);
  sample.buttons = static_cast<std::uint32_t>(buttons);
  std::array<double, 8> heat{};
  libhd->get_doubles(hd::kMotorTemperature, heat.data());
  sample.temperature = *std::max_element(heat.begin(), heat.end());
  sample.jaw = std::nan("");
  sample.is_calibrated = libhd->check_calibration() == hd::kCalibrationGood;
  ++sample.sequence;
}

/// Empties the library's queue of errors. \return false for one that does not pass
bool OpenHaptics::Content::TakeErrors(std::size_t i) noexcept {
  is_warm[i] = false;
  for (int n = 0; n < kMaxErrors; ++n) {
    const hd::ErrorInfo error = libhd->get_error();
    if (error.code == hd::kSuccess) break;
    if (!hd::IsPassing(error.code)) return false;
    is_warm[i] = true;
  }
  return true;
}

hd::CallbackCode OpenHaptics::Content::Tick() noexcept {
  const bool is_ending = is_stopping.load(std::memory_order_acquire);
  const bool may_push = !is_ending && !mailbox.IsLost();
  const ForceMailbox::Forces forces = may_push ? mailbox.TakeForces() : ForceMailbox::Forces{};
  for (std::size_t i = 0; i < devices.size(); ++i) {
    libhd->begin_frame(devices[i]);
    libhd->make_current(devices[i]);
    ReadDevice(i);
    // a warm device gets nothing until a frame has passed without complaint
    const Vec3 force = is_warm[i] ? Vec3{} : forces[i];
    const std::array<double, 3> newtons = {force.x, force.y, force.z};
    libhd->set_doubles(hd::kForce, newtons.data());
    libhd->end_frame(devices[i]);
    if (!TakeErrors(i)) mailbox.SetLost();
    newest[i].status = is_warm[i] ? ForceDeviceStatus::kWarm : ForceDeviceStatus::kOk;
  }
  mailbox.Report(newest);
  if (!is_ending) return hd::kContinue;
  has_stopped.store(true, std::memory_order_release);
  return hd::kDone;
}

OpenHaptics::OpenHaptics(const OpenHapticsSettings& settings)
    : ForceDriver("openhaptics",
                  static_cast<int>(std::clamp<std::size_t>(settings.names.size(), 1, kMaxDevices))),
      content_(std::make_unique<Content>(settings)) {}

OpenHaptics::~OpenHaptics() {
  Finalize();
}

ForceLimits OpenHaptics::GetLimits(int channel) const noexcept {
  const auto index = static_cast<std::size_t>(channel);
  return channel >= 0 && index < content_->limits.size() ? content_->limits[index] : ForceLimits{};
}

core::Status OpenHaptics::DoConfigure() {
  Content& c = *content_;
  if (c.settings.names.empty() || c.settings.names.size() > kMaxDevices)
    return core::Error{ErrorCode::kDeviceSettings, "openhaptics: name one device, or two"};
  if (is_library_taken.exchange(true)) {
    return core::Error{ErrorCode::kDeviceBusy,
                       "openhaptics is in use already; name both devices in one: openhaptics:Left,Right"};
  }
  auto library = hd::Library::Load(c.settings.hd_file);
  if (!library) {
    is_library_taken.store(false);
    return library.error();
  }
  c.libhd = std::move(*library);
  // all devices before the scheduler
  for (const std::string& name : c.settings.names) {
    if (core::Status opened = c.OpenDevice(name); !opened) {
      DoCleanup();
      return opened;
    }
  }
  return {};
}

core::Status OpenHaptics::DoActivate() {
  Content& c = *content_;
  c.is_stopping = c.has_stopped = false;
  c.mailbox.Clear();
  c.newest = {};
  c.is_warm = {};
  c.callback = c.libhd->schedule(&Content::OnTick, &c, hd::kMaxPriority);
  c.libhd->start_scheduler();
  if (const hd::ErrorInfo error = c.libhd->get_error();
      error.code != hd::kSuccess && !hd::IsPassing(error.code)) {
    DoDeactivate();
    return c.LibraryError("the haptic scheduler does not start", error.code);
  }
  return {};
}

/// The scheduler's own thread sends the last zero; then it is stopped, and only then may devices go.
void OpenHaptics::DoDeactivate() noexcept {
  Content& c = *content_;
  c.is_stopping.store(true, std::memory_order_release);
  for (double waited = 0; !c.has_stopped.load(std::memory_order_acquire) && waited < kLongestWait;
       waited += 0.001)
    SystemClock().Sleep(0.001);
  c.libhd->stop_scheduler();
  c.libhd->unschedule(c.callback);
}

void OpenHaptics::DoCleanup() noexcept {
  Content& c = *content_;
  for (const hd::Handle device : c.devices) c.libhd->disable_device(device);
  c.devices.clear();
  c.limits.clear();
  c.libhd.reset();
  is_library_taken.store(false);
}

ReadStatus OpenHaptics::DoReadForceSamples(std::span<ForceSample> samples) noexcept {
  return content_->mailbox.Read(samples);
}

ReadStatus OpenHaptics::DoRead(std::span<HandSample> samples) noexcept {
  return content_->mailbox.Read(samples, content_->settings.p_device_trocar);
}

void OpenHaptics::DoSendForce(int channel, const GatedForce& force) noexcept {
  content_->mailbox.Send(channel, force);
}

}  // namespace trocar::device
