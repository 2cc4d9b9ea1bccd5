// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "haply/haply_messages.h"
#include "haply/web_socket.h"
#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

using web_socket::Opcode;

/// The service: answers the opening, then sends a state, and the next one whenever it has got forces.
class HaplyEmulator : public Emulator {
 public:
  HaplyEmulator(HaplyEmulation emulation, std::shared_ptr<HaplyForces> forces)
      : emulation_(std::move(emulation)), forces_(std::move(forces)) {}

  void Connect() override {
    inbox_.clear();
    due_.clear();
    is_open_ = false;
    *forces_ = {};
  }

  void Receive(std::string_view bytes) override {
    constexpr std::size_t kMost = 1u << 18;
    inbox_ += bytes;
    if (inbox_.size() > kMost) inbox_.clear();
    if (!is_open_) return Open();
    std::size_t done = 0;
    while (true) {
      web_socket::Frame frame;
      const Parsed parsed = web_socket::ParseFrame(std::string_view(inbox_).substr(done), true, frame);
      if (parsed.verdict != Parsed::Verdict::kRecord) break;
      done += parsed.length;
      std::vector<std::string> ids;
      std::array<math::Vec3, haply::kMaxDevices> forces;
      if (frame.opcode != Opcode::kText || !haply::ParseForces(frame.payload, ids, forces)) continue;
      forces_->newtons = forces;
      ++forces_->messages;
      is_state_due_ = true;
    }
    inbox_.erase(0, done);
  }

  std::string Advance(double time) override {
    std::string bytes = std::exchange(due_, {});
    if (!is_open_ || !std::exchange(is_state_due_, false)) return bytes;
    haply::State state;
    for (int i = 0; i < emulation_.devices; ++i) {
      const math::Vec3 p = emulation_.position(i, time);
      state.devices.push_back({"emulated-" + std::to_string(i), p});
    }
    if (emulation_.buttons) state.buttons = emulation_.buttons(time);
    return bytes + web_socket::FormatFrame(Opcode::kText, haply::FormatState(state), 0);
  }

 private:
  void Open() {
    const std::size_t head = inbox_.find("\r\n\r\n");
    if (head == std::string::npos) return;
    const std::string_view key =
        web_socket::FindHeader(std::string_view(inbox_).substr(0, head + 2), "Sec-WebSocket-Key");
    due_ =
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: "
        "Upgrade\r\nSec-WebSocket-Accept: " +
        web_socket::CalcAccept(key) + "\r\n\r\n";
    inbox_.erase(0, head + 4);
    is_open_ = is_state_due_ = true;
  }

  HaplyEmulation emulation_;
  std::shared_ptr<HaplyForces> forces_;
  std::string inbox_, due_;
  bool is_open_ = false, is_state_due_ = false;
};

}  // namespace

std::unique_ptr<Emulator> MakeHaplyEmulator(HaplyEmulation emulation, std::shared_ptr<HaplyForces> forces) {
  return std::make_unique<HaplyEmulator>(std::move(emulation), std::move(forces));
}

}  // namespace trocar::device
