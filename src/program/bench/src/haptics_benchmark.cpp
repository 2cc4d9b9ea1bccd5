// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <thread>
#include <utility>

#include "thread_allocations.h"
#include "trocar/bench/benchmark.h"
#include "trocar/device/simulated_force_device.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/data_folder.h"
#include "trocar/host/threads.h"
#include "trocar/render/offscreen_context.h"
#include "trocar/render/offscreen_target.h"
#include "trocar/session/haptic_loop.h"
#include "trocar/session/runner.h"
#include "trocar/session/session_input.h"
#include "trocar/view/laparoscope_view.h"

namespace trocar::bench {
namespace {

using instrument::Hand;
using math::Vec3;

constexpr double kSecondsPerRepeat = 4;
constexpr double kPressDepth = 0.008;  // beyond where a tool would touch [m]
constexpr double kStroke = 0.002;      // the hands' motion meanwhile [m]
constexpr double kStrokeRate = 1.5;    // [1/s]
constexpr double kReach = 0.4;         // of the way to the tissue in a second [-]
/// Safety switch, and jaws closed: open ones would take the tissue between them.
constexpr std::uint32_t kSwitchAndJaws = 3;
constexpr double kArmingTime = 30;  // given up after [s]

void Sleep(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// Where a hand leads its device: at home, or to and fro in the tissue.
struct Lead {
  Vec3 home, tissue, inwards;  // device frame; inwards is a unit vector
  std::atomic<bool> is_pressing{false};
  double share = 0, last = 0;  // of the haptic thread

  Vec3 At(double time) noexcept {
    const double step = kReach * (time - last);
    last = time;
    share = std::clamp(share + (is_pressing.load() ? step : -step), 0.0, 1.0);
    const Vec3 pressed = tissue + (kPressDepth + kStroke * std::sin(2 * M_PI * kStrokeRate * time)) * inwards;
    return math::Lerp(home, pressed, share);
  }
};

/// The nearest point of an organ, from a tool at home.
Vec3 FindTissue(const simulation::Simulation& simulation, const Vec3& p_world_tip) {
  const simulation::Snapshot& snapshot = simulation.GetSnapshot();
  Vec3 nearest = p_world_tip + Vec3{1, 0, 0};
  for (const scene::SurfaceInfo& surface : simulation.Surfaces()) {
    if (surface.triangles.empty()) continue;
    for (std::uint32_t i = surface.first_node; i < surface.first_node + surface.node_count; ++i) {
      const Vec3& node = snapshot.positions[i];
      if (math::Distance(node, p_world_tip) < math::Distance(nearest, p_world_tip)) nearest = node;
    }
  }
  return nearest;
}

/// Follows the simulation and draws it as a window would, on a thread of its own, until it ends.
class Onlooker {
 public:
  explicit Onlooker(session::Runner& runner) : runner_(runner), thread_([this] { Run(); }) {}
  ~Onlooker() {
    is_stopping_.store(true);
    thread_.join();
  }
  int Frames() const { return frames_.load(); }
  /// Both tools touch tissue in the newest picture.
  bool SeesContact() const { return sees_contact_.load(); }

 private:
  void Run() {
    constexpr int kWidth = 1280, kHeight = 720;
    auto context = render::OffscreenContext::Make();
    auto target = context ? render::OffscreenTarget::Make(kWidth, kHeight)
                          : base::Result<render::OffscreenTarget>(context.error());
    auto view = target ? view::LaparoscopeView::Make(runner_.GetScene(), runner_.Surfaces(), runner_.Latest())
                       : base::Result<view::LaparoscopeView>(target.error());
    render::Image image;
    while (!is_stopping_.load()) {
      const host::Stopwatch watch;
      const simulation::Snapshot& snapshot = runner_.Latest();
      sees_contact_.store(snapshot.instruments[0].is_touching && snapshot.instruments[1].is_touching);
      if (view) {
        view->Update(snapshot);
        target->Bind();
        view->Draw(kWidth, kHeight);
        target->Read(image);
        frames_.fetch_add(1);
      }
      Sleep(std::max(0.0, 1.0 / 60 - watch.Seconds()));
    }
  }

  session::Runner& runner_;
  std::atomic<bool> is_stopping_{false}, sees_contact_{false};
  std::atomic<int> frames_{0};
  std::thread thread_;
};

/// A device that says nothing: what is left of a tick shows how evenly the machine itself lets a loop run.
class NoWork : public device::ForceDriver {
 public:
  NoWork() : ForceDriver("nothing", 1) {}
  device::ForceLimits GetLimits(int) const noexcept override { return device::MakeTouchLimits(); }

 private:
  base::Status DoConfigure() override { return {}; }
  base::Status DoActivate() override { return {}; }
  void DoDeactivate() noexcept override {}
  void DoCleanup() noexcept override {}
  device::ReadStatus DoRead(std::span<device::HandSample>) noexcept override {
    return device::ReadStatus::kUnchanged;
  }
  device::ReadStatus DoReadForceSamples(std::span<device::ForceSample>) noexcept override {
    return device::ReadStatus::kUnchanged;
  }
  void DoSendForce(int, const device::GatedForce&) noexcept override {}
};

/// Both simulated devices in the hands of somebody who follows the instructions.
struct Person {
  session::HapticLoop& loop;
  device::SimulatedForceDevice& device;
  std::array<Lead, instrument::kHandCount>& leads;

  bool WaitFor(double seconds, bool (*condition)(const session::HapticStatus&)) {
    const host::Stopwatch watch;
    while (watch.Seconds() < seconds) {
      if (condition(loop.Latest())) return true;
      Sleep(0.01);
    }
    return false;
  }
  bool ConfirmPose() {
    for (int attempt = 0; attempt < 5; ++attempt) {
      loop.BeginCheckPose();
      Sleep(0.1);
      for (int hand = 0; hand < instrument::kHandCount; ++hand) {
        device.SetButtons(hand, 1);
        Sleep(0.5);
        device.SetButtons(hand, 0);
        Sleep(0.1);
      }
      if (WaitFor(0.5, [](const session::HapticStatus& status) {
            return status.check_pose == haptics::CheckPoseState::kConfirmed;
          }))
        return true;
    }
    return false;
  }
  /// Out of the tissue, armed, and into it.
  bool Arm() {
    const host::Stopwatch watch;
    while (watch.Seconds() < kArmingTime) {
      for (Lead& lead : leads) lead.is_pressing.store(false);
      for (int hand = 0; hand < instrument::kHandCount; ++hand) device.SetButtons(hand, kSwitchAndJaws);
      Sleep(2.6);
      loop.RequestArm();
      const bool is_armed = WaitFor(3.0, [](const session::HapticStatus& status) {
        return status.hands[instrument::kLeft].state == haptics::ArmState::kArmed &&
               status.hands[instrument::kRight].state == haptics::ArmState::kArmed;
      });
      if (!is_armed) continue;
      for (Lead& lead : leads) lead.is_pressing.store(true);
      Sleep(3.0);
      return true;
    }
    return false;
  }
};

/// 99.9th percentile of the period of a loop without work [s].
base::Result<double> MeasureBareLoop(double seconds) {
  session::HapticLink nobody;
  session::HapticLoopSettings bare;
  bare.hands.emplace_back();
  auto loop = session::HapticLoop::Start(std::make_unique<NoWork>(), bare, nobody);
  if (!loop) return loop.error();
  Sleep(0.5);
  (*loop)->ClearTimes();
  Sleep(seconds);
  return (*loop)->CalcPeriodPercentile(0.999);
}

void Add(BenchmarkResult& result, const char* name, double value, const char* unit) {
  result.cases.push_back({name, value, unit});
}

}  // namespace

base::Result<BenchmarkResult> RunHapticsBenchmark(const BenchmarkOptions& options) {
  const double seconds = kSecondsPerRepeat * options.repeats;
  auto folder = host::FindDataFolder();
  if (!folder) return folder.error();
  auto scene = files::ReadScene(*folder / "scenes/demonstration.json");
  if (!scene) return scene.error();
  auto simulation = simulation::Simulation::Make(std::make_shared<const scene::Scene>(std::move(*scene)),
                                                 {.threads = host::UseThreads(options.threads)});
  if (!simulation) return simulation.error();

  // devices, and where they are led
  session::HapticLoopSettings settings;
  settings.supervisor = session::SupervisorLink::FindProgram();
  settings.count_allocations = CountThreadAllocations;
  std::array<Lead, instrument::kHandCount> leads;
  for (const Hand hand : {instrument::kLeft, instrument::kRight}) {
    settings.hands.push_back(session::MakeHapticHand(
        simulation->GetScene(), simulation->GetSnapshot().X_world_laparoscope, hand, 0.5));
    const haptics::DeviceMap& map = settings.hands.back().map;
    leads[hand].tissue = haptics::ToDevice(map, FindTissue(*simulation, map.X_world_device.translation));
    leads[hand].inwards = math::Normalized(leads[hand].tissue);
  }
  session::HapticLink link;
  session::SessionInput input(simulation->GetScene());
  input.UseHaptics(link);
  session::RunnerSettings running;
  running.haptics = &link;
  session::Runner runner(std::move(*simulation), input, std::move(running));
  runner.SetPaused(false);
  const Onlooker onlooker(runner);

  const base::Result<double> control_p999 = MeasureBareLoop(seconds);
  if (!control_p999) return control_p999.error();

  device::SimulatedForceSettings simulated;
  simulated.channel_count = instrument::kHandCount;
  simulated.path = [&leads](int channel, double time) {
    return leads[static_cast<std::size_t>(channel)].At(time);
  };
  auto made = std::make_unique<device::SimulatedForceDevice>(simulated);
  device::SimulatedForceDevice& device = *made;
  auto loop = session::HapticLoop::Start(std::move(made), settings, link);
  if (!loop) return loop.error();
  Person person{**loop, device, leads};
  if (!person.ConfirmPose()) return WrongAnswer("check_pose", "it was not confirmed");
  if (!person.Arm()) {
    return WrongAnswer("armed",
                       "the force did not arm within 30 s: " + session::DescribeHaptics((*loop)->Latest()));
  }
  (*loop)->ClearTimes();
  const std::uint64_t ticks_before = (*loop)->Latest().ticks;
  const host::Stopwatch watch;
  double touched = 0, armed = 0, looks = 0, largest = 0;
  while (watch.Seconds() < seconds) {
    Sleep(0.05);
    const session::HapticStatus& status = (*loop)->Latest();
    const auto& left = status.hands[instrument::kLeft];
    const auto& right = status.hands[instrument::kRight];
    looks += 1;
    touched += onlooker.SeesContact() ? 1 : 0;
    const bool are_armed =
        left.state == haptics::ArmState::kArmed && right.state == haptics::ArmState::kArmed;
    armed += are_armed ? 1 : 0;
    largest = std::max({largest, left.force, right.force});
    // a stall of the machine took the force away: a person would ask again
    if (!are_armed && !person.Arm()) break;
  }
  const double passed = watch.Seconds();
  const session::HapticStatus status = (*loop)->Latest();
  if (touched < 0.5 * looks) {
    return WrongAnswer("contact", "both hands touched the tissue in " + std::to_string(touched / looks) +
                                      " of the looks, armed in " + std::to_string(armed / looks) +
                                      ", largest force " + std::to_string(largest) + " N");
  }
  if (!(largest > 0.05)) return WrongAnswer("force", "no force came out");

  BenchmarkResult result;
  Add(result, "tick_cpu_p50", 1e6 * (*loop)->CalcCpuPercentile(0.5), "us");
  Add(result, "tick_cpu_p99.9", 1e6 * (*loop)->CalcCpuPercentile(0.999), "us");
  Add(result, "period_p50", 1e6 * (*loop)->CalcPeriodPercentile(0.5), "us");
  Add(result, "period_p99.9", 1e6 * (*loop)->CalcPeriodPercentile(0.999), "us");
  Add(result, "control_period_p99.9", 1e6 * *control_p999, "us");
  Add(result, "rate", static_cast<double>(status.ticks - ticks_before) / passed, "1/s");
  if (CanCountAllocations()) {
    Add(result, "allocations", static_cast<double>((*loop)->CountAllocated()), "1");
  } else {
    result.notes.push_back("Allocations are not counted under a sanitizer.");
  }
  Add(result, "ticks", static_cast<double>(status.ticks - ticks_before), "1");
  Add(result, "overruns", static_cast<double>(status.overruns), "1");
  Add(result, "armed_share", armed / looks, "1");
  Add(result, "contact_share", touched / looks, "1");
  Add(result, "largest_force", largest, "N");
  result.notes.push_back("Both hands in contact with the built-in patient, simulation at its rate, " +
                         std::string(onlooker.Frames() > 0 ? "pictures drawn" : "no graphics") +
                         " beside it; the bare loop ran before, under the same load.");
  result.notes.push_back(status.is_real_time
                             ? "SCHED_FIFO was granted."
                             : "SCHED_FIFO was not granted: trocar doctor says how to allow it.");
  return result;
}

}  // namespace trocar::bench
