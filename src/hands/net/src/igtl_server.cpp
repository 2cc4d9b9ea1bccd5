// SPDX-License-Identifier: Apache-2.0
#include "trocar/net/igtl_server.h"

#include <algorithm>
#include <array>
#include <utility>

namespace trocar::net {
namespace {

constexpr std::size_t kMostViewers = 8;
constexpr double kPatience = 10.0;    // with a viewer that is behind [s]
constexpr double kJudgePeriod = 1.0;  // between two looks at what a viewer took [s]
/// A viewer that is behind for longer, two looks at least, loses its place to a new one when all are taken [s].
constexpr double kBehind = 1.5;
/// Keeps up who takes this part of the tools' bytes or more within a second. A viewer that reads takes all of them, organs besides;
/// of one that does not, a system whose buffer still grows announces up to nine tenths of what comes as new room.
constexpr double kPartTaken = 0.95;
/// Longer gaps between two ticks are pauses [s].
constexpr double kPause = 1.0;
/// Of a viewer that does not read: what lies there is old before it is seen [bytes].
constexpr int kSendBuffer = 64 << 10;
/// New callers that are looked at in one tick.
constexpr int kMostCallers = 16;

/// Columns are the world's axes in RAS.
math::Quaternion RotationRasWorld() {
  return math::RotationFromAxes({-1, 0, 0}, {0, 0, 1}, {0, 1, 0});
}

/// True once a period, in step with the periods before it as long as nothing is late.
bool IsDue(double time, double period, double& next) noexcept {
  constexpr double kRounding = 1e-9;  // ticks are sums of fractions [s]
  if (time < next - kRounding) return false;
  next = std::max(next + period, time);
  return true;
}

std::string FormatTools(const ToolPoses& poses) {
  const std::array<device::IgtlTool, 3> tools = {{
      {"LeftTool", RasFromWorld(poses.X_world_left)},
      {"RightTool", RasFromWorld(poses.X_world_right)},
      {"Laparoscope", RasFromWorld(poses.X_world_laparoscope)},
  }};
  std::string bytes;
  for (const device::IgtlTool& tool : tools)
    bytes += device::FormatIgtlTransform(tool.name, tool.pose, poses.time);
  return bytes + device::FormatIgtlTrackingData("Tools", tools, poses.time);
}

std::string FormatOrgans(std::span<const scene::SurfaceInfo> organs, const NodePositions& nodes) {
  std::string bytes;
  std::vector<math::Vec3> points;
  std::vector<std::uint32_t> corners;
  for (const scene::SurfaceInfo& organ : organs) {
    if (organ.first_node + std::size_t{organ.node_count} > nodes.p_world.size()) continue;
    points.clear();
    corners.clear();
    for (std::uint32_t node = 0; node < organ.node_count; ++node)
      points.push_back(RasFromWorld(nodes.p_world[organ.first_node + node]));
    for (const geometry::Triangle& triangle : organ.triangles)
      corners.insert(corners.end(), triangle.begin(), triangle.end());
    bytes += device::FormatIgtlPolyData(organ.name, points, corners, nodes.time);
  }
  return bytes;
}

}  // namespace

math::Vec3 RasFromWorld(const math::Vec3& p_world) noexcept {
  return {-p_world.x, p_world.z, p_world.y};
}

math::Pose RasFromWorld(const math::Pose& X_world_tool) {
  return {math::Normalized(RotationRasWorld() * X_world_tool.rotation),
          RasFromWorld(X_world_tool.translation)};
}

ToolPoses ToolPosesOf(const simulation::Snapshot& snapshot) noexcept {
  return {snapshot.time, snapshot.instruments[instrument::kLeft].X_world_tool,
          snapshot.instruments[instrument::kRight].X_world_tool, snapshot.X_world_laparoscope};
}

IgtlServer::IgtlServer(const IgtlServerSettings& settings, std::unique_ptr<device::TcpListener> listener,
                       device::Clock& clock)
    : settings_(settings), clock_(clock), listener_(std::move(listener)), last_call_(clock.Now()) {}

base::Result<std::unique_ptr<IgtlServer>> IgtlServer::Make(const IgtlServerSettings& settings,
                                                           std::span<const scene::SurfaceInfo> surfaces,
                                                           device::Clock& clock) {
  auto listener = device::TcpListener::Make(settings.port, settings.is_local_only, kSendBuffer);
  if (!listener) return listener.error();
  std::unique_ptr<IgtlServer> server(new IgtlServer(settings, std::move(*listener), clock));
  for (const scene::SurfaceInfo& surface : surfaces) {
    if (!surface.triangles.empty()) server->organs_.push_back(surface);
  }
  return server;
}

void IgtlServer::Accept() {
  for (int i = 0; i < kMostCallers; ++i) {
    Viewer caller;
    caller.line = listener_->Accept();
    if (caller.line == nullptr) return;
    if (viewers_.size() >= kMostViewers) {
      // who is behind longest makes room; where all keep up, the newest caller is sent away
      const auto slowest =
          std::min_element(viewers_.begin(), viewers_.end(),
                           [](const Viewer& a, const Viewer& b) { return a.last_level < b.last_level; });
      if (slowest->Behind() <= kBehind) continue;
      viewers_.erase(slowest);
    }
    caller.judged_at = caller.last_level = serving_time_;
    caller.taken_then = device::GetTcpReach(*caller.line);
    caller.offered_then = offered_;
    viewers_.push_back(std::move(caller));
  }
}

/// Sends what is left over, and throws away what a viewer says. A viewer that is gone loses its line.
void IgtlServer::Serve(Viewer& viewer) {
  std::array<char, 4096> ignored;
  device::IoResult heard;
  constexpr int kMostReads = 16;
  for (int i = 0; i < kMostReads && (heard = viewer.line->Read(ignored)).count > 0; ++i) {
  }
  const device::IoResult sent = viewer.line->Write(viewer.unsent);
  viewer.unsent.erase(0, sent.count);
  viewer.sent += sent.count;
  if (serving_time_ - viewer.judged_at >= kJudgePeriod) Judge(viewer);
  if (heard.is_lost || sent.is_lost || viewer.Behind() > kPatience) viewer.line.reset();
}

/// Where the system does not tell what the far side takes, what its send buffer takes has to do.
void IgtlServer::Judge(Viewer& viewer) {
  const std::uint64_t reach = device::GetTcpReach(*viewer.line);
  const std::uint64_t taken = reach > 0 ? reach : viewer.sent;
  const std::uint64_t news = taken - std::min(taken, viewer.taken_then);
  const bool is_stuck = news == 0 && !viewer.unsent.empty();
  if (!is_stuck &&
      static_cast<double>(news) >= kPartTaken * static_cast<double>(offered_ - viewer.offered_then))
    viewer.last_level = serving_time_;
  viewer.judged_at = serving_time_;
  viewer.taken_then = taken;
  viewer.offered_then = offered_;
}

void IgtlServer::Publish(const ToolPoses& poses, const NodePositions& nodes) {
  const double time = poses.time, now = clock_.Now();
  serving_time_ += std::min(now - last_call_, kPause);
  last_call_ = now;
  // back at the first tick
  if (next_tools_ > time + settings_.organ_period + settings_.tool_period) next_tools_ = next_organs_ = time;
  Accept();
  const bool has_tools = IsDue(time, settings_.tool_period, next_tools_);
  const bool has_organs = IsDue(time, settings_.organ_period, next_organs_);
  const std::string tools = has_tools && !viewers_.empty() ? FormatTools(poses) : std::string();
  offered_ += tools.size();
  std::string organs;
  for (Viewer& viewer : viewers_) {
    // whole sets or none: what does not fit now is left out, the next one is newer
    if (viewer.unsent.empty() && (has_organs || !viewer.has_organs)) {
      if (organs.empty()) organs = FormatOrgans(organs_, nodes);
      viewer.unsent += organs;
      viewer.has_organs = true;
    }
    if (viewer.unsent.size() <= organs.size()) viewer.unsent += tools;
    Serve(viewer);
  }
  std::erase_if(viewers_, [](const Viewer& viewer) { return viewer.line == nullptr; });
}

}  // namespace trocar::net
