// SPDX-License-Identifier: Apache-2.0
/// \file igtl_server.h  Shows a running simulation to 3D Slicer and others over OpenIGTLink: tools and organs, RAS
/// millimetres.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "trocar/core/result.h"
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

/// A server that only speaks: whatever a viewer sends is thrown away, so that no message from a network can change anything.
///
/// Every set is a TRANSFORM each for LeftTool, RightTool and Laparoscope, and a TDATA "Tools" of the three; organs are
/// POLYDATA by their names, the first of them as soon as somebody connects. A viewer that does not keep up misses sets; one
/// that takes nothing for 10 s is let go. Of eight viewers, the slowest makes room for a ninth if it is behind for a second. Ducts and arteries, which have no surface of their own, are not sent.
class IgtlServer {
 public:
  /// \param surfaces  of the simulation
  /// \return kDeviceBusy where the port is taken
  static core::Result<std::unique_ptr<IgtlServer>> Make(const IgtlServerSettings& settings,
                                                        std::span<const scene::SurfaceInfo> surfaces);

  /// Call it after every tick. Sends what is due and never waits.
  /// \note Not real-time safe: allocates
  void Publish(const simulation::Snapshot& snapshot);

  int Port() const noexcept { return listener_->Port(); }
  std::size_t ViewerCount() const noexcept { return viewers_.size(); }

 private:
  struct Viewer {
    std::unique_ptr<device::Transport> line;
    std::string unsent;
    double last_sent = 0;   // simulated time at which it last took anything [s]
    double last_level = 0;  // and at which it had taken everything [s]
    bool has_organs = false;
  };
  IgtlServer(const IgtlServerSettings& settings, std::unique_ptr<device::TcpListener> listener);
  void Accept(double time);
  void Serve(Viewer& viewer, double time);

  IgtlServerSettings settings_;
  std::unique_ptr<device::TcpListener> listener_;
  std::vector<scene::SurfaceInfo> organs_;
  std::vector<Viewer> viewers_;
  double next_tools_ = 0, next_organs_ = 0;  // simulated time [s]
};

}  // namespace trocar::net
