// SPDX-License-Identifier: Apache-2.0
/// \file igtl_server.h  Shows a running simulation to 3D Slicer and others over OpenIGTLink: tools and organs, RAS
/// millimetres.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "trocar/base/result.h"
#include "trocar/device/igtl.h"
#include "trocar/device/tcp_port.h"
#include "trocar/simulation/simulation.h"
#include "trocar/simulation/snapshot.h"

namespace trocar::net {

/// World (x to the patient's left, y cranial, z anterior) to RAS (x right, y anterior, z superior); both right-handed.
math::Vec3 RasFromWorld(const math::Vec3& p_world) noexcept;
math::Pose RasFromWorld(const math::Pose& X_world_tool);

struct IgtlServerSettings {
  int port = device::kIgtlPort;   ///< 0 lets the system choose
  bool is_local_only = true;      ///< false: other machines may look on, too
  double tool_period = 1.0 / 30;  ///< between two sets of tools, simulated time [s]
  double organ_period = 0.5;      ///< between two sets of organs, simulated time [s]
};

/// Tools of one tick, world frame.
struct ToolPoses {
  double time = 0;  ///< simulated [s]
  math::Pose X_world_left, X_world_right, X_world_laparoscope;
};
ToolPoses ToolPosesOf(const simulation::Snapshot& snapshot) noexcept;

/// Nodes of all organs as they were in one tick.
struct NodePositions {
  double time = 0;                        ///< simulated [s]
  std::span<const math::Vec3> p_world{};  ///< as Snapshot::positions [m]
};

/// A server that only speaks: whatever a viewer sends is thrown away, so that no message from a network can change anything.
///
/// Every set is a TRANSFORM each for LeftTool, RightTool and Laparoscope, and a TDATA "Tools" of the three; organs are
/// POLYDATA by their names, the first of them as soon as somebody connects. A viewer that does not keep up misses sets. It is
/// judged once a second by what its program takes, not by what systems buffer for it: one that does not take the
/// tools as they come for 10 s is let go, and of eight viewers the one that has been behind longest makes room for a ninth.
/// Ducts and arteries, which have no surface of their own, are not sent.
class IgtlServer {
 public:
  /// \param surfaces  of the simulation
  /// \param clock     tells how long a viewer has been behind; outlives the server
  /// \return kDeviceBusy where the port is taken
  static base::Result<std::unique_ptr<IgtlServer>> Make(const IgtlServerSettings& settings,
                                                        std::span<const scene::SurfaceInfo> surfaces,
                                                        device::Clock& clock = device::SystemClock());

  /// Call it after every tick. Sends what is due and never waits.
  /// \param nodes  of this tick or of a little before
  /// \note Not real-time safe: allocates. Beside a running session, session::ViewerFeed calls it on a thread of its own.
  void Publish(const ToolPoses& tools, const NodePositions& nodes);
  void Publish(const simulation::Snapshot& snapshot) {
    Publish(ToolPosesOf(snapshot), {snapshot.time, snapshot.positions});
  }

  int Port() const noexcept { return listener_->Port(); }
  std::size_t ViewerCount() const noexcept { return viewers_.size(); }

 private:
  struct Viewer {
    std::unique_ptr<device::Transport> line;
    std::string unsent;
    std::uint64_t sent = 0;  // to its line [bytes]
    bool has_organs = false;
    double judged_at = 0;                            // serving time of the last look [s]
    std::uint64_t taken_then = 0, offered_then = 0;  // by then [bytes]
    double last_level = 0;  // serving time of the last look that found it keeping up [s]
    double Behind() const noexcept { return judged_at - last_level; }
  };
  IgtlServer(const IgtlServerSettings& settings, std::unique_ptr<device::TcpListener> listener,
             device::Clock& clock);
  void Accept();
  void Serve(Viewer& viewer);
  void Judge(Viewer& viewer);

  IgtlServerSettings settings_;
  device::Clock& clock_;
  std::unique_ptr<device::TcpListener> listener_;
  std::vector<scene::SurfaceInfo> organs_;
  std::vector<Viewer> viewers_;
  double next_tools_ = 0, next_organs_ = 0;  // simulated time [s]
  double last_call_ = 0;                     // by the clock [s]
  double serving_time_ = 0;                  // real time without pauses of the simulation [s]
  std::uint64_t offered_ = 0;                // tools since the start [bytes]
};

}  // namespace trocar::net
