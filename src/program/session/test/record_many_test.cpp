// SPDX-License-Identifier: Apache-2.0
// Many short sessions over all tasks and operations (scripted surgeons, random hands and feet, haptic devices), recorded and
// replayed to the same bits. TROCAR_SESSIONS says how many the slow test plays, TROCAR_SESSIONS_FROM the first one's number.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <thread>

#include "trocar/agent/surgeon.h"
#include "trocar/device/force_device_spec.h"
#include "trocar/files/task_file.h"
#include "trocar/host/clock.h"
#include "trocar/host/threads.h"
#include "trocar/record/input_codec.h"
#include "trocar/record/replay.h"
#include "trocar/scene/task.h"
#include "trocar/session/runner.h"
#include "trocar/session/session_input.h"
#include "trocar_test/temporary_folder.h"

namespace trocar::session {

using scene::Input;
using scene::Scene;

namespace {

using record::Description;

constexpr double kScriptedSeconds = 4, kHapticSeconds = 2;

struct Counts {
  int sessions = 0, cuts = 0, haptic = 0;
  std::uint64_t ticks = 0;
  std::map<std::string, int> of;      // scene -> sessions
  std::map<int, int> with_threads;    // replays
  std::vector<std::string> failures;  // "17 peg_transfer novice: ..."
};

/// Hands that jump and rest, feet, tools, settings: all of it drawn.
class RandomHands {
 public:
  RandomHands(const Scene& scene, std::uint64_t seed)
      : scene_(scene), random_(seed), input_(scene::CalcScriptInput(scene, 0)), home_(input_) {}

  Input Next() {
    for (std::size_t hand = 0; hand < instrument::kHandCount; ++hand) {
      auto& joints = input_.hands[hand];
      if (Draw() < 0.02) wanted_[hand] = MakeWish(home_.hands[hand]);
      joints.pan += 0.02 * (wanted_[hand].pan - joints.pan) + 1e-5 * (Draw() - 0.5);
      joints.tilt += 0.02 * (wanted_[hand].tilt - joints.tilt);
      joints.depth += 0.02 * (wanted_[hand].depth - joints.depth);
      joints.spin += 0.02 * (wanted_[hand].spin - joints.spin);
      joints.jaw += 0.2 * (wanted_[hand].jaw - joints.jaw);
      auto& controls = input_.controls[hand];
      if (Draw() < 0.01) controls.cut = !controls.cut;
      if (Draw() < 0.01) controls.coagulate = !controls.coagulate;
      if (Draw() < 0.01) controls.rinse = !controls.rinse;
      if (Draw() < 0.01) controls.aspirate = !controls.aspirate;
      const auto tray = scene_.instruments[hand].tray.size();
      if (tray > 1 && Draw() < 0.005) controls.tool = static_cast<std::uint8_t>(random_() % tray);
    }
    if (Draw() < 0.003) input_.assistant = static_cast<scene::AssistantCommand>(random_() % 4);
    if (Draw() < 0.003) input_.settings.holds_camera = !input_.settings.holds_camera;
    if (Draw() < 0.002) input_.settings.head_up = 0.3 * (Draw() - 0.5);
    if (Draw() < 0.002) input_.settings.gravity = 12 * Draw();
    record::RoundJoints(input_);
    return input_;
  }

 private:
  double Draw() { return std::uniform_real_distribution<double>()(random_); }
  instrument::TrocarJoints MakeWish(instrument::TrocarJoints joints) {
    joints.pan += 0.5 * (Draw() - 0.5);
    joints.tilt += 0.5 * (Draw() - 0.5);
    joints.depth += 0.06 * (Draw() - 0.3);
    joints.spin += 3 * (Draw() - 0.5);
    joints.jaw = Draw() < 0.5 ? 0 : Draw();
    return joints;
  }

  const Scene& scene_;
  std::mt19937_64 random_;
  Input input_, home_;
  std::array<instrument::TrocarJoints, instrument::kHandCount> wanted_ = home_.hands;
};

class RecordMany : public testing::Test {
 protected:
  /// Task or operation of a session, with level, seed and name drawn from its number.
  static Description Choose(int number, std::mt19937_64& random) {
    static const auto tasks = *files::ListTasks();
    Description description;
    const auto place = static_cast<std::size_t>(number) % (tasks.size() + 1);
    description.seed = random() % 1000;
    if (place == tasks.size()) {
      description.kind = Description::Kind::kOperation;
      description.name = "cholecystectomy";
      return description;
    }
    description.kind = Description::Kind::kTask;
    description.name = tasks[place].key;
    description.level = tasks[place].levels[random() % tasks[place].levels.size()];
    return description;
  }

  /// \return who played, or an error's text with a '!' before it
  std::string Record(int number, const std::filesystem::path& folder, Description description,
                     std::mt19937_64& random) {
    auto read = record::MakeScene(description);
    if (!read.ok()) return "!" + read.error().Text();
    description.seed = read->seed;
    const auto scene = std::make_shared<const Scene>(std::move(*read));
    auto simulation = simulation::Simulation::Make(scene, {.threads = host::UseThreads(1 + number % 2)});
    if (!simulation.ok()) return "!" + simulation.error().Text();
    const auto seed = random();
    if (number % 8 == 3) return RecordHaptic(folder, description, std::move(*simulation), seed);
    std::vector<std::string> able;
    for (const auto& entry : agent::ListSurgeons()) {
      if (entry.suits(*scene)) able.emplace_back(entry.name);
    }
    std::unique_ptr<agent::Surgeon> surgeon;
    std::string player = "random hands";
    if (!able.empty() && number % 2 == 0) {
      player = able[random() % able.size()];
      auto made = agent::MakeSurgeon(player, scene, seed);
      if (!made.ok()) return "!" + made.error().Text();
      surgeon = std::move(*made);
    }
    RandomHands hands(*scene, seed);
    description.player = player;
    record::RecorderSettings settings;
    settings.waits = true;
    settings.keyframe_seconds = 1;
    auto recorder = record::Recorder::Start(folder / "a.trocar", description, *simulation, settings);
    if (!recorder.ok()) return "!" + recorder.error().Text();
    while (simulation->GetSnapshot().time < kScriptedSeconds &&
           !(surgeon != nullptr && surgeon->HasFinished())) {
      const Input input = surgeon != nullptr ? surgeon->Act(simulation->GetSnapshot()) : hands.Next();
      simulation->Step(input);
      (*recorder)->Add(input, *simulation);
    }
    if (simulation->GetSnapshot().operation.topology.version > 0) ++counts_.cuts;
    if (const auto finished = (*recorder)->Finish(*simulation); !finished.ok())
      return "!" + finished.error().Text();
    return player;
  }

  /// In real time, with the 1 kHz loop and an emulated device that is held.
  std::string RecordHaptic(const std::filesystem::path& folder, const Description& description,
                           simulation::Simulation simulation, std::uint64_t seed) {
    HapticLink link;
    auto driver = device::MakeForceDriver("simulated:held");
    if (!driver.ok()) return "!" + driver.error().Text();
    auto settings =
        MakeHapticSettings(**driver, simulation.GetScene(), simulation.GetSnapshot().X_world_laparoscope,
                           device::DefaultButtons());
    if (!settings.ok()) return "!" + settings.error().Text();
    settings->supervisor.clear();  // hands without force are what is recorded
    RandomHands hands(simulation.GetScene(), seed);
    SessionInput input(simulation.GetScene());
    input.UseHaptics(link);
    RunnerSettings running;
    running.haptics = &link;
    running.keeping = AttemptKeeping{folder, description};
    Runner runner(std::move(simulation), input, std::move(running));
    {
      auto loop = HapticLoop::Start(std::move(*driver), *settings, link);
      if (!loop.ok()) return "!" + loop.error().Text();
      runner.SetPaused(false);
      const host::Stopwatch watch;
      while (watch.Seconds() < kHapticSeconds) {
        input.GoOnFrom(hands.Next());
        std::this_thread::sleep_for(std::chrono::milliseconds(8));
      }
      runner.SetPaused(true);
    }
    ++counts_.haptic;
    return "haptic device";
  }

  void Play(int number) {
    std::mt19937_64 random(7919u * static_cast<unsigned>(number) + 1);
    const test::TemporaryFolder folder;
    const Description description = Choose(number, random);
    const std::string player = Record(number, folder.Path(), description, random);
    const std::string what = std::to_string(number) + " " + description.name + " " + player;
    ++counts_.sessions;
    ++counts_.of[description.name];
    const auto fail = [&](const std::string& why) { counts_.failures.push_back(what + ": " + why); };
    if (player.starts_with('!')) return fail("was not recorded");
    std::filesystem::path file;
    for (const auto& entry : std::filesystem::directory_iterator(folder.Path())) {
      if (entry.path().extension() == ".trocar") file = entry.path();
    }
    // each number of threads in its turn, and every tenth session with all
    for (const int threads : {1, 2, 4}) {
      if (number % 10 != 0 && threads != std::array{1, 2, 4}[static_cast<std::size_t>(number / 2) % 3])
        continue;
      auto recording = record::ReadRecording(file);
      if (!recording.ok()) return fail(recording.error().Text());
      if (!recording->ending || !recording->damage.empty()) return fail("has no ending");
      if (threads == 1 || number % 10 != 0) counts_.ticks += recording->inputs.size();
      auto replay = record::Replay::Open(std::move(*recording), threads);
      if (!replay.ok()) return fail(replay.error().Text());
      const auto verified = replay->Verify();
      if (!verified.ok()) return fail(verified.error().Text());
      ++counts_.with_threads[threads];
      if (!verified->IsVerified()) {
        fail("diverged with " + std::to_string(threads) + " threads at tick " +
             std::to_string(verified->divergence ? verified->divergence->tick : verified->ticks));
      }
    }
  }

  void PlayAll(int from, int count) {
    for (int number = from; number < from + count; ++number) {
      Play(number);
      if ((number - from) % 10 == 9) {
        std::printf("%d sessions, %zu failures\n", counts_.sessions, counts_.failures.size());
        std::fflush(stdout);
      }
    }
    std::printf("%d sessions from number %d, %llu ticks, %d with cuts, %d with a haptic device;",
                counts_.sessions, from, static_cast<unsigned long long>(counts_.ticks), counts_.cuts,
                counts_.haptic);
    for (const auto& [name, sessions] : counts_.of) std::printf(" %s %d", name.c_str(), sessions);
    for (const auto& [threads, replays] : counts_.with_threads)
      std::printf("; %d replays with %d threads", replays, threads);
    std::printf("\n");
    EXPECT_EQ(counts_.sessions, count);
    for (const std::string& failure : counts_.failures) ADD_FAILURE() << failure;
  }

  static int Number(const char* variable, int otherwise) {
    const char* text = std::getenv(variable);
    return text != nullptr ? std::atoi(text) : otherwise;
  }
  Counts counts_;
};

TEST_F(RecordMany, AFewReplayToTheSameBits) {
  PlayAll(0, 4);
}

using RecordManySlow = RecordMany;
TEST_F(RecordManySlow, AllReplayToTheSameBits) {
  PlayAll(Number("TROCAR_SESSIONS_FROM", 0), Number("TROCAR_SESSIONS", 100));
}

}  // namespace
}  // namespace trocar::session
