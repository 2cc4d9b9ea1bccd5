// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "trocar/device/emulator.h"

namespace trocar::device {
namespace {

/// A driver that does not read loses what is older, as on a real line [bytes].
constexpr std::size_t kMostUnsent = 1u << 16;

}  // namespace

base::Result<std::unique_ptr<EmulatorHost>> EmulatorHost::MakeSerial(std::unique_ptr<Emulator> emulator,
                                                                     std::vector<Fault> faults,
                                                                     std::uint64_t seed) {
  base::Result<std::unique_ptr<PseudoTerminal>> terminal = PseudoTerminal::Make();
  if (!terminal) return terminal.error();
  std::unique_ptr<EmulatorHost> host(new EmulatorHost(std::move(emulator), std::move(faults), seed));
  host->terminal_ = std::move(*terminal);
  host->address_ = host->terminal_->Path();
  return host;
}

base::Result<std::unique_ptr<EmulatorHost>> EmulatorHost::MakeTcp(std::unique_ptr<Emulator> emulator,
                                                                  int port, std::vector<Fault> faults,
                                                                  std::uint64_t seed) {
  base::Result<std::unique_ptr<TcpListener>> listener = TcpListener::Make(port);
  if (!listener) return listener.error();
  std::unique_ptr<EmulatorHost> host(new EmulatorHost(std::move(emulator), std::move(faults), seed));
  host->listener_ = std::move(*listener);
  host->address_ = "localhost:" + std::to_string(host->listener_->Port());
  return host;
}

base::Result<std::unique_ptr<EmulatorHost>> EmulatorHost::MakeLocal(std::unique_ptr<Emulator> emulator,
                                                                    const std::string& path,
                                                                    std::size_t packet_size,
                                                                    std::vector<Fault> faults,
                                                                    std::uint64_t seed) {
  const LocalLine line = packet_size > 0 ? LocalLine::kPackets : LocalLine::kStream;
  base::Result<std::unique_ptr<LocalListener>> listener = LocalListener::Make(path, line);
  if (!listener) return listener.error();
  std::unique_ptr<EmulatorHost> host(new EmulatorHost(std::move(emulator), std::move(faults), seed));
  host->local_listener_ = std::move(*listener);
  host->packet_size_ = packet_size;
  host->address_ = path;
  return host;
}

/// The line that is open just now, or null.
Transport* EmulatorHost::FindLine() {
  if (terminal_ != nullptr) return terminal_.get();
  if (caller_ == nullptr) {
    caller_ = listener_ != nullptr ? listener_->Accept() : local_listener_->Accept();
    if (caller_ != nullptr) {
      unsent_.clear();
      emulator_->Connect();
    }
  }
  return caller_.get();
}

void EmulatorHost::Step(double time) {
  const bool is_unplugged = std::any_of(faults_.begin(), faults_.end(), [time](const Fault& fault) {
    return fault.kind == FaultKind::kUnplug && fault.IsOn(time);
  });
  if (is_unplugged) return Unplug();
  Transport* line = FindLine();
  if (line != nullptr) {
    std::array<char, 4096> bytes;
    IoResult got;
    while ((got = line->Read(bytes)).count > 0) emulator_->Receive({bytes.data(), got.count});
    if (got.is_lost) caller_.reset();
    line = terminal_ != nullptr ? terminal_.get() : caller_.get();
  }
  const std::string due = SpoilBytes(faults_, time, emulator_->Advance(time), random_);
  if (line == nullptr) return;
  unsent_ += due;
  Send(*line);
  if (unsent_.size() > kMostUnsent) unsent_.clear();
}

void EmulatorHost::Send(Transport& line) {
  const std::size_t part = packet_size_ > 0 ? packet_size_ : unsent_.size();
  std::size_t done = 0;
  // nothing is not sent: an empty packet reads like a hang-up
  while (done < unsent_.size()) {
    const std::size_t sent = line.Write(std::string_view(unsent_).substr(done, part)).count;
    if (sent == 0) break;
    done += sent;
  }
  unsent_.erase(0, done);
}

void EmulatorHost::Unplug() noexcept {
  if (terminal_ != nullptr) terminal_->Unplug();
  caller_.reset();
}

}  // namespace trocar::device
