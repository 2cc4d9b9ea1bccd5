// SPDX-License-Identifier: Apache-2.0
#include "trocar/device/haply.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

#include "hands/force_mailbox.h"
#include "haply_messages.h"
#include "trocar/device/force_check.h"
#include "trocar/device/mouse_keyboard.h"
#include "trocar/host/clock.h"
#include "web_socket.h"

namespace trocar::device {
namespace {

using base::Error;
using base::ErrorCode;
using haply::kMaxDevices;
using math::Vec3;
using web_socket::Opcode;

constexpr double kPause = 0.0002;              // between two looks at the line [s]
constexpr std::size_t kMostUnread = 1u << 18;  // bytes without a whole message
constexpr std::size_t kMostUnsent = 1u << 14;  // the service reads no more: forces would be old
constexpr const char* kKey = "dHJvY2FyIHNpbXVsYXRvcg==";
constexpr std::uint32_t kMask =
    0x5a17c3e9;  // a rule of the protocol against proxies, of which there are none here

static_assert(kMaxDevices == ForceMailbox::kMaxDevices);

}  // namespace

struct Haply::Content {
  Content(const HaplySettings& wanted, TransportOpener way) : settings(wanted), opener(std::move(way)) {}

  HaplySettings settings;
  TransportOpener opener;
  std::unique_ptr<Transport> line;
  std::string inbox, outbox;
  std::vector<std::string> ids;

  ForceMailbox mailbox;
  ForceMailbox::Reports newest;  // of the thread below
  std::array<ForceCheck, kMaxDevices> checks;
  std::int64_t last_state = 0;  // [ns]
  std::atomic<bool> is_stopping{false};
  std::thread thread;

  base::Status OpenSocket();
  bool Exchange(haply::State& state, bool& has_state);
  bool Flush();
  void Take(const haply::State& state);
  void Answer(bool may_push);
  void Run();
  std::string ZeroFrame() const {
    return web_socket::FormatFrame(Opcode::kText, haply::FormatForces(ids, {}), kMask);
  }
};

/// Opens the line and asks for WebSocket.
base::Status Haply::Content::OpenSocket() {
  auto opened = opener();
  if (!opened) return opened.error();
  line = std::move(*opened);
  inbox.clear();
  outbox.clear();
  Clock& clock = SystemClock();
  if (base::Status sent =
          WriteAll(*line, clock, web_socket::FormatRequest("localhost", kKey), settings.answer_time);
      !sent)
    return sent;
  const double end = clock.Now() + settings.answer_time;
  std::array<char, 4096> bytes;
  while (clock.Now() < end && inbox.size() < bytes.size()) {
    const IoResult got = line->Read(bytes);
    inbox.append(bytes.data(), got.count);
    const std::size_t head = inbox.find("\r\n\r\n");
    if (head != std::string::npos) {
      const bool is_good = inbox.starts_with("HTTP/1.1 101") &&
                           web_socket::FindHeader(inbox.substr(0, head + 2), "Sec-WebSocket-Accept") ==
                               web_socket::CalcAccept(kKey);
      inbox.erase(0, head + 4);
      if (is_good) return {};
      break;
    }
    if (got.is_lost) break;
    clock.Sleep(0.001);
  }
  return Error{ErrorCode::kDeviceStale,
               "haply: what answers is no Haply service; is the service started, and the port right?"};
}

bool Haply::Content::Flush() {
  const IoResult sent = line->Write(outbox);
  outbox.erase(0, sent.count);
  return !sent.is_lost && outbox.size() <= kMostUnsent;
}

/// Takes in what is there; the newest state counts. \return false where the line is lost
bool Haply::Content::Exchange(haply::State& state, bool& has_state) {
  std::array<char, 16384> bytes;
  const IoResult got = line->Read(bytes);
  inbox.append(bytes.data(), got.count);
  if (got.is_lost || inbox.size() > kMostUnread) return false;
  std::size_t done = 0;
  while (true) {
    web_socket::Frame frame;
    const Parsed parsed = web_socket::ParseFrame(std::string_view(inbox).substr(done), false, frame);
    if (parsed.verdict == Parsed::Verdict::kGarbage ||
        (parsed.verdict == Parsed::Verdict::kRecord && frame.opcode == Opcode::kClose))
      return false;
    if (parsed.verdict == Parsed::Verdict::kIncomplete) break;
    done += parsed.length;
    if (frame.opcode == Opcode::kPing) outbox += web_socket::FormatFrame(Opcode::kPong, frame.payload, kMask);
    haply::State read;
    if (frame.opcode == Opcode::kText && haply::ParseState(frame.payload, read)) {
      state = read;
      has_state = true;
    }
  }
  inbox.erase(0, done);
  return true;
}

void Haply::Content::Take(const haply::State& state) {
  const std::int64_t now = host::NowNanoseconds();
  const double dt = 1e-9 * static_cast<double>(now - last_state);
  last_state = now;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto found = std::find_if(state.devices.begin(), state.devices.end(),
                                    [&](const haply::DeviceState& device) { return device.id == ids[i]; });
    if (found == state.devices.end()) continue;
    ForceSample& sample = newest[i];
    if (sample.sequence > 0 && dt > 1e-5) {
      // first order, 50 Hz: positions of one step apart are noisy
      constexpr double kFollow = 314.0;
      const Vec3 raw = (found->position - sample.position) / dt;
      sample.velocity += (raw - sample.velocity) * (1.0 - std::exp(-kFollow * dt));
    }
    sample.position = found->position;
    sample.orientation = state.grip;
    sample.buttons = state.buttons;
    sample.jaw = std::nan("");
    sample.temperature = std::nan("");
    sample.is_calibrated = true;  // the service hands out no position before
    sample.status = ForceDeviceStatus::kOk;
    ++sample.sequence;
  }
  mailbox.Report(newest);
}

/// The service sends its next state after an answer, so that there always is one.
void Haply::Content::Answer(bool may_push) {
  ForceMailbox::Forces forces = may_push ? mailbox.TakeForces() : ForceMailbox::Forces{};
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = checks[i].Pass(forces[i]);
  outbox += web_socket::FormatFrame(Opcode::kText, haply::FormatForces(ids, forces), kMask);
}

void Haply::Content::Run() {
  bool was_pushing = false;
  while (!is_stopping.load(std::memory_order_acquire)) {
    haply::State state;
    bool has_state = false;
    bool is_there = Exchange(state, has_state);
    if (has_state) {
      Take(state);
      Answer(true);
      was_pushing = true;
    } else if (was_pushing && 1e-9 * static_cast<double>(host::NowNanoseconds() - last_state) > kForceLife) {
      // the service is silent: nothing that it still holds may go on acting
      Answer(false);
      was_pushing = false;
    }
    for (const ForceCheck& check : checks) is_there = is_there && !check.HasRefused();
    is_there = is_there && Flush();
    if (!is_there || 1e-9 * static_cast<double>(host::NowNanoseconds() - last_state) > settings.lost_after) {
      mailbox.SetLost();
      break;
    }
    SystemClock().Sleep(kPause);
  }
  outbox += ZeroFrame();
  outbox += web_socket::FormatFrame(Opcode::kClose, "", kMask);
  Flush();
}

Haply::Haply(const HaplySettings& settings, TransportOpener opener)
    : ForceDriver("haply", std::clamp(settings.devices, 1, static_cast<int>(kMaxDevices))),
      content_(std::make_unique<Content>(settings, std::move(opener))) {}

Haply::~Haply() {
  Finalize();
}

ForceLimits Haply::GetLimits(int) const noexcept {
  ForceLimits limits;
  limits.max_force = content_->settings.max_force;
  return limits;
}

SupervisedWire Haply::GetSupervisedWire(int channel) const noexcept {
  SupervisedWire wire;
  // one line carries all devices: the first channel's frame stops them together
  if (channel != 0 || content_->line == nullptr) return wire;
  const std::string zero = content_->ZeroFrame();
  if (zero.size() > wire.zero_frame.size()) return wire;
  wire.file = content_->line->GetFile();
  wire.size = zero.size();
  std::copy(zero.begin(), zero.end(), wire.zero_frame.begin());
  wire.is_closed_after = true;
  return wire;
}

base::Status Haply::DoConfigure() {
  Content& c = *content_;
  if (c.settings.devices < 1 || c.settings.devices > static_cast<int>(kMaxDevices) ||
      !(c.settings.answer_time > 0.0))
    return Error{ErrorCode::kDeviceSettings, "haply: one device or two, and a time to answer above 0"};
  base::Status done = c.OpenSocket();
  c.ids.clear();
  const double end = SystemClock().Now() + c.settings.answer_time;
  while (done && c.ids.empty() && SystemClock().Now() < end) {
    haply::State state;
    bool has_state = false;
    if (!c.Exchange(state, has_state))
      done = Error{ErrorCode::kDeviceLost, "haply: the service hung up; start it again"};
    if (has_state && state.devices.size() >= static_cast<std::size_t>(c.settings.devices)) {
      for (int i = 0; i < c.settings.devices; ++i)
        c.ids.push_back(state.devices[static_cast<std::size_t>(i)].id);
    } else if (has_state) {
      c.Answer(false);  // asks for the next state
    }
    c.Flush();
    SystemClock().Sleep(0.001);
  }
  if (done && c.ids.empty()) {
    done = Error{ErrorCode::kDeviceStale,
                 "haply: the service names fewer than " + std::to_string(c.settings.devices) +
                     " Inverse3 devices; plug them in and look into Haply's own hub"};
  }
  if (!done) DoCleanup();
  return done;
}

base::Status Haply::DoActivate() {
  Content& c = *content_;
  c.is_stopping = false;
  c.mailbox.Clear();
  c.newest = {};
  c.checks.fill(ForceCheck(c.settings.max_force));
  c.last_state = host::NowNanoseconds();
  c.Answer(false);
  c.thread = std::thread([&c] { c.Run(); });
  return {};
}

void Haply::DoDeactivate() noexcept {
  content_->is_stopping.store(true, std::memory_order_release);
  if (content_->thread.joinable()) content_->thread.join();
}

void Haply::DoCleanup() noexcept {
  content_->line.reset();
}

ReadStatus Haply::DoReadForceSamples(std::span<ForceSample> samples) noexcept {
  return content_->mailbox.Read(samples);
}

ReadStatus Haply::DoRead(std::span<HandSample> samples) noexcept {
  return content_->mailbox.Read(samples, content_->settings.p_device_trocar);
}

void Haply::DoSendForce(int channel, const GatedForce& force) noexcept {
  content_->mailbox.Send(channel, force);
}

}  // namespace trocar::device
