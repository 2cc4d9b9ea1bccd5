// SPDX-License-Identifier: Apache-2.0
#include "trocar/session/supervisor_link.h"

#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "supervisor_protocol.h"
#include "trocar/device/companion.h"
#include "trocar/device/file_messages.h"
#include "trocar/host/beat_watch.h"

namespace trocar::session {
namespace {

constexpr std::int64_t kLongestOwnSilence = 20'000'000;  // of the supervisor [ns]
constexpr std::int64_t kLongestLook = 2'000'000;         // that counts of it between two looks [ns]
constexpr const char* kRemedy =
    "without the supervisor there is no force: reinstall Trocar, or build the target trocar-supervisor";

base::Error Fail(const std::string& what) {
  return {base::ErrorCode::kHapticSupervisor, what + "; " + kRemedy};
}

}  // namespace

struct SupervisorLink::Content {
  explicit Content(device::Companion started)
      : companion(std::move(started)), page(static_cast<SupervisorPage*>(companion.Page())) {}

  device::Companion companion;
  SupervisorPage* page;
  host::BeatWatch watch{kLongestLook};
  std::uint64_t seen_trips = 0;
};

std::filesystem::path SupervisorLink::FindProgram() {
  return device::Companion::Find("trocar-supervisor");
}

base::Result<SupervisorLink> SupervisorLink::Start(const std::filesystem::path& program) {
  auto companion = device::Companion::Start(program, "--watch", sizeof(SupervisorPage),
                                            base::ErrorCode::kHapticSupervisor, kRemedy);
  if (!companion) return companion.error();
  return SupervisorLink(std::make_unique<Content>(std::move(*companion)));
}

SupervisorLink::SupervisorLink(std::unique_ptr<Content> content) : content_(std::move(content)) {}
SupervisorLink::SupervisorLink(SupervisorLink&&) noexcept = default;
SupervisorLink& SupervisorLink::operator=(SupervisorLink&&) noexcept = default;
SupervisorLink::~SupervisorLink() = default;

base::Status SupervisorLink::AddWire(const device::SupervisedWire& wire) {
  if (wire.file < 0) return {};
  WireMessage message;
  message.size = static_cast<std::uint32_t>(wire.size);
  message.is_closed_after = wire.is_closed_after ? 1 : 0;
  std::memcpy(message.zero_frame, wire.zero_frame.data(), wire.size);
  const std::string_view bytes(reinterpret_cast<const char*>(&message), sizeof message);
  if (!device::SendFiles(content_->companion.Socket(), bytes, std::span(&wire.file, 1)))
    return Fail(std::string("the supervisor takes no wire (") + std::strerror(errno) + ")");
  return {};
}

base::Status SupervisorLink::AddLibrary(const device::SupervisedLibrary& library) {
  if (library.files.empty()) return {};
  if (!device::SendFiles(content_->companion.Socket(), library.request, library.files))
    return Fail(std::string("the supervisor takes no library (") + std::strerror(errno) + ")");
  return {};
}

void SupervisorLink::ForgetWires() noexcept {
  const WireMessage message;
  [[maybe_unused]] const ssize_t sent =
      ::send(content_->companion.Socket(), &message, sizeof message, MSG_NOSIGNAL);
}

void SupervisorLink::Beat() noexcept {
  content_->page->beats.fetch_add(1, std::memory_order_release);
}

bool SupervisorLink::IsAlive(std::int64_t now) noexcept {
  const std::uint64_t beats = content_->page->supervisor_beats.load(std::memory_order_relaxed);
  const std::int64_t silence = content_->watch.Look(beats, now);
  // its end of the socket closes with it, and it never says anything
  char nothing;
  const bool has_ended =
      ::recv(content_->companion.Socket(), &nothing, sizeof nothing, MSG_PEEK | MSG_DONTWAIT) == 0;
  return !has_ended && beats > 0 && silence <= kLongestOwnSilence;
}

bool SupervisorLink::TakeTrip() noexcept {
  const std::uint64_t trips = content_->page->trips.load(std::memory_order_acquire);
  const bool is_new = trips != content_->seen_trips;
  content_->seen_trips = trips;
  return is_new;
}

}  // namespace trocar::session
