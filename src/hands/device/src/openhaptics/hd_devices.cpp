// SPDX-License-Identifier: Apache-2.0
#include "hd_devices.h"

#include <algorithm>
#include <cmath>

#include "trocar/device/ports.h"

namespace trocar::device {
namespace {

using base::ErrorCode;
using math::Vec3;

constexpr double kMillimetre = 0.001;
/// Of a device of any model: the Touch's damping and encoders, and the friction of the least braked ones (domain facts,
/// sections 3.4 and 3.5). They bound the stiffness to 400 N/m at 1 kHz.
constexpr double kAssumedDamping = 0.2;    // [N s/m]
constexpr double kAssumedFriction = 0.06;  // [N]
constexpr double kAssumedStep = 0.055e-3;  // [m]
constexpr double kLongestWait = 0.5;       // for the scheduler to end [s]
/// Errors that one frame may leave in the library's queue.
constexpr int kMaxErrors = 16;

Vec3 FromMillimetres(const double* v) noexcept {
  return Vec3{v[0], v[1], v[2]} * kMillimetre;
}

/// Rotation of a column-major 4 x 4 matrix; all zero for one that is no rotation: not finite, columns that are not unit or not
/// at right angles, a mirror.
math::Quaternion RotationOf(const std::array<double, 16>& m) noexcept {
  constexpr double kSlack = 0.05;  // [-]
  const Vec3 x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]};
  // each is false for what is no number
  const auto is_unit = [](const Vec3& v) { return std::fabs(math::Norm(v) - 1.0) <= kSlack; };
  const bool is_rotation = is_unit(x) && is_unit(y) && is_unit(z) && std::fabs(math::Dot(x, y)) <= kSlack &&
                           math::Distance(math::Cross(x, y), z) <= 4.0 * kSlack;
  if (!is_rotation) return {0, 0, 0, 0};
  const Vec3 a = math::Normalized(x), b = math::Normalized(y - a * math::Dot(a, y));
  return math::RotationFromAxes(a, b, math::Cross(a, b));
}

/// The hottest of those that say something, so that one that says nothing hides none; NaN where none does.
double HottestOf(const std::array<double, 8>& motors) noexcept {
  double hottest = std::nan("");
  for (const double motor : motors) hottest = std::fmax(hottest, motor);
  return hottest;
}

}  // namespace

base::Error HdDevices::LibraryError(const std::string& what, unsigned int code) const {
  const char* text = libhd_->get_error_string(code);
  return {ErrorCode::kDeviceLost, what + ": " + (text != nullptr ? text : "unknown error") +
                                      "; run the maker's diagnostic program, and check plug and power"};
}

base::Result<ForceLimits> HdDevices::OpenDevice(const std::string& name) {
  const hd::Handle device = libhd_->init_device(name.c_str());
  // one that opens with an error is closed with the rest
  if (device != hd::kInvalidHandle) devices_.push_back(device);
  const hd::ErrorInfo error = libhd_->get_error();
  if (device == hd::kInvalidHandle || (error.code != hd::kSuccess && !hd::IsPassing(error.code)))
    return LibraryError("\"" + name + "\" does not open", error.code);
  libhd_->make_current(device);
  ForceLimits limit;
  libhd_->get_doubles(hd::kMaxForce, &limit.max_force);
  libhd_->get_doubles(hd::kMaxContinuousForce, &limit.max_continuous_force);
  double newtons_per_millimetre = 0;
  libhd_->get_doubles(hd::kMaxStiffness, &newtons_per_millimetre);
  limit.max_stiffness = newtons_per_millimetre / kMillimetre;
  std::array<double, 6> box{};
  libhd_->get_doubles(hd::kUsableWorkspace, box.data());
  limit.workspace_min = FromMillimetres(box.data());
  limit.workspace_max = FromMillimetres(box.data() + 3);
  // what the library does not say is assumed as for a Touch, the softest: a wall as stiff as its maker's figure shakes
  limit.damping = kAssumedDamping;
  limit.friction = kAssumedFriction;
  limit.position_step = kAssumedStep;
  // here as well as in the simulator: this process calls the library
  if (base::Status good = CheckLimits(limit, "\"" + name + "\""); !good) return good.error();
  checks_.emplace_back(limit.max_force);
  libhd_->enable(hd::kForceOutput);
  return limit;
}

void HdDevices::ReadDevice(std::size_t i) noexcept {
  ForceSample& sample = newest_[i];
  std::array<double, 3> v{};
  std::array<double, 16> m{};
  libhd_->get_doubles(hd::kPosition, v.data());
  sample.position = FromMillimetres(v.data());
  libhd_->get_doubles(hd::kVelocity, v.data());
  sample.velocity = FromMillimetres(v.data());
  libhd_->get_doubles(hd::kTransform, m.data());
  sample.orientation = RotationOf(m);
  int buttons = 0;
  libhd_->get_integers(hd::kButtons, &buttons);
  sample.buttons = static_cast<std::uint32_t>(buttons);
  std::array<double, 8> heat{};
  libhd_->get_doubles(hd::kMotorTemperature, heat.data());
  sample.temperature = HottestOf(heat);
  sample.jaw = std::nan("");
  sample.is_calibrated = libhd_->check_calibration() == hd::kCalibrationGood;
  ++sample.sequence;
}

/// Empties the library's queue of errors. \return false for one that does not pass
bool HdDevices::TakeErrors(std::size_t i) noexcept {
  is_warm_[i] = false;
  for (int n = 0; n < kMaxErrors; ++n) {
    const hd::ErrorInfo error = libhd_->get_error();
    if (error.code == hd::kSuccess) break;
    if (!hd::IsPassing(error.code)) return false;
    is_warm_[i] = true;
  }
  return true;
}

void HdDevices::PushZero() noexcept {
  if (CountCalls() % 2 != 0) return;
  constexpr std::array<double, 3> kZero{};
  for (const hd::Handle device : devices_) {
    libhd_->begin_frame(device);
    libhd_->make_current(device);
    libhd_->set_doubles(hd::kForce, kZero.data());
    libhd_->end_frame(device);
  }
}

hd::CallbackCode HdDevices::Tick() noexcept {
  calls_.fetch_add(1, std::memory_order_acq_rel);
  is_called_.store(true, std::memory_order_release);
  const bool is_ending = is_stopping_.load(std::memory_order_acquire);
  const bool may_push = !is_ending && !mailbox_.IsLost();
  const ForceMailbox::Forces forces = may_push ? mailbox_.TakeForces() : ForceMailbox::Forces{};
  for (std::size_t i = 0; i < devices_.size(); ++i) {
    libhd_->begin_frame(devices_[i]);
    libhd_->make_current(devices_[i]);
    ReadDevice(i);
    // a warm device gets nothing until a frame has passed without complaint
    const Vec3 force = checks_[i].Pass(is_warm_[i] ? Vec3{} : forces[i]);
    const std::array<double, 3> newtons = {force.x, force.y, force.z};
    libhd_->set_doubles(hd::kForce, newtons.data());
    libhd_->end_frame(devices_[i]);
    if (!TakeErrors(i) || checks_[i].HasRefused()) mailbox_.SetLost();
    newest_[i].status = is_warm_[i] ? ForceDeviceStatus::kWarm : ForceDeviceStatus::kOk;
  }
  mailbox_.Report(newest_);
  calls_.fetch_add(1, std::memory_order_acq_rel);
  if (!is_ending) return hd::kContinue;
  is_called_.store(false, std::memory_order_release);
  has_stopped_.store(true, std::memory_order_release);
  return hd::kDone;
}

base::Status HdDevices::Open(const OpenHapticsSettings& settings, std::vector<ForceLimits>& limits) {
  auto library = hd::Library::Load(settings.hd_file);
  if (!library) return library.error();
  libhd_ = std::move(*library);
  // all devices before the scheduler
  for (const std::string& name : settings.names) {
    base::Result<ForceLimits> opened = OpenDevice(name);
    if (!opened) {
      Close();
      limits.clear();
      return opened.error();
    }
    limits.push_back(*opened);
  }
  return {};
}

base::Status HdDevices::Start() {
  is_stopping_ = has_stopped_ = false;
  newest_ = {};
  is_warm_ = {};
  is_started_ = true;
  callback_ = libhd_->schedule(&HdDevices::OnTick, this, hd::kMaxPriority);
  libhd_->start_scheduler();
  if (const hd::ErrorInfo error = libhd_->get_error();
      error.code != hd::kSuccess && !hd::IsPassing(error.code)) {
    Stop();
    return LibraryError("the haptic scheduler does not start", error.code);
  }
  return {};
}

/// The scheduler's own thread sends the last zero; then it is stopped, and only then may devices go.
void HdDevices::Stop() noexcept {
  if (!is_started_) return;
  is_started_ = false;
  is_stopping_.store(true, std::memory_order_release);
  for (double waited = 0; !has_stopped_.load(std::memory_order_acquire) && waited < kLongestWait;
       waited += 0.001)
    SystemClock().Sleep(0.001);
  libhd_->stop_scheduler();
  libhd_->unschedule(callback_);
}

void HdDevices::Close() noexcept {
  if (libhd_ == nullptr) return;
  Stop();
  for (const hd::Handle device : devices_) libhd_->disable_device(device);
  devices_.clear();
  checks_.clear();
  libhd_.reset();
}

}  // namespace trocar::device
