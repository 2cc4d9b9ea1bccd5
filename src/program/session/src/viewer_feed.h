// SPDX-License-Identifier: Apache-2.0
// Every tick of a running session to viewers over OpenIGTLink, on a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "trocar/host/newest_slot.h"
#include "trocar/net/igtl_server.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::session {

/// Between the simulation's thread, which hands over the tools of each tick and now and then the organs, and the server's, which
/// formats and sends them. Neither waits for the other.
class ViewerFeed {
 public:
  /// Ticks that the server's thread may be behind; what comes beyond them is left out.
  static constexpr std::size_t kCapacity = 1024;
  /// Organs are handed over once in so many ticks.
  static constexpr std::uint64_t kOrganTicks = 6;

  /// \param server  taken over
  explicit ViewerFeed(std::unique_ptr<net::IgtlServer> server);
  ~ViewerFeed();
  ViewerFeed(const ViewerFeed&) = delete;
  ViewerFeed& operator=(const ViewerFeed&) = delete;

  /// After every tick, by the simulation's thread.
  /// \note Real-time safe once it has seen a snapshot of that size.
  void Add(const simulation::Snapshot& snapshot);

  int Port() const noexcept { return port_; }
  std::size_t ViewerCount() const noexcept { return viewers_.load(); }
  /// Ticks that were published to the server, and those that were left out because it was too far behind.
  std::uint64_t Published() const noexcept { return published_.load(); }
  std::uint64_t LeftOut() const noexcept { return left_out_.load(); }

 private:
  struct Organs {
    double time = 0;
    std::vector<math::Vec3> p_world;
  };
  void Run();

  std::unique_ptr<net::IgtlServer> server_;
  int port_;
  std::vector<net::ToolPoses> ring_;
  alignas(64) std::atomic<std::uint64_t> added_{0};      // to the ring, by the simulation
  alignas(64) std::atomic<std::uint64_t> published_{0};  // taken out of it
  host::NewestSlot<Organs> organs_;
  bool has_organs_ = false;  // of the simulation's thread
  std::atomic<std::uint64_t> left_out_{0};
  std::atomic<std::size_t> viewers_{0};
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

}  // namespace trocar::session
