// SPDX-License-Identifier: Apache-2.0
/// \file scene_bits.cpp  Prints fingerprints of scenes, tasks and operations while they are played, for check_scenes.sh to compare.
///
///   scene_bits play REPOSITORY [--ticks N] [--threads T] [--lane golden|whole] [NAME...]
///       plays each golden of the lane (or whose name begins with NAME) to its end, or for N ticks, and prints
///       "name tick hash" every 100 ticks and at the end
///   scene_bits verify REPOSITORY FILE...
///       replays recordings; exit status 1 where a hash or the outcome is another
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <unistd.h>

#include "golden_play.h"
#include "trocar/base/state_hash.h"
#if !defined(__EMSCRIPTEN__)
#include "trocar/record/recording.h"
#include "trocar/record/replay.h"
#endif

namespace {

using namespace trocar;

/// Ticks between two fingerprints.
constexpr std::uint64_t kEvery = 100;

struct Options {
  std::uint64_t most_ticks = 0;  // 0: to the end
  int threads = 2;
  std::string lane = "golden";
  std::vector<std::string> names;
};

/// The operation on a patient that is generated; no golden because its hash would say no more than the other's.
bits::Golden OperationOnGeneratedPatient() {
  bits::Golden golden;
  golden.name = "operation/generated_patient";
  golden.lane = "whole";
  golden.task = "cholecystectomy";
  golden.surgeon = "expert";
  golden.has_generated_patient = true;
  golden.patient_seed = 7;
  return golden;
}

bool IsChosen(const bits::Golden& golden, const Options& options) {
  if (options.names.empty()) return golden.lane == options.lane;
  return std::any_of(options.names.begin(), options.names.end(),
                     [&](const std::string& name) { return golden.name.rfind(name, 0) == 0; });
}

int Fail(const std::string& message) {
  std::fprintf(stderr, "scene_bits: %s\n", message.c_str());
  return 2;
}

base::Status Play(const bits::Golden& golden, const std::filesystem::path& repository,
                  const Options& options) {
  const auto scratch = std::filesystem::temp_directory_path() / ("scene_bits_" + std::to_string(getpid()));
  auto play = bits::GoldenPlay::Make(golden, repository, scratch, options.threads);
  std::filesystem::remove_all(scratch);
  if (!play.ok()) return play.error();
  const simulation::Simulation& simulation = play->GetSimulation();
  const auto print = [&](std::uint64_t tick) {
    std::printf("%s %llu %s\n", golden.name.c_str(), static_cast<unsigned long long>(tick),
                base::HashText(simulation.Hash()).c_str());
    std::fflush(stdout);
  };
  print(0);
  std::uint64_t tick = 0;
  while (!play->IsOver() && (options.most_ticks == 0 || tick < options.most_ticks)) {
    play->Step(play->DecideInput());
    if (++tick % kEvery == 0) print(tick);
  }
  if (tick % kEvery != 0) print(tick);
  return {};
}

int PlayAll(const std::filesystem::path& repository, const Options& options) {
  auto goldens = bits::ReadGoldens(repository);
  if (!goldens.ok()) return Fail(goldens.error().Text());
  goldens->push_back(OperationOnGeneratedPatient());
  bool has_played = false;
  for (const bits::Golden& golden : *goldens) {
    if (!IsChosen(golden, options)) continue;
    has_played = true;
    if (const base::Status played = Play(golden, repository, options); !played.ok())
      return Fail(golden.name + ": " + played.error().Text());
  }
  return has_played ? 0 : Fail("no golden has such a name or lane");
}

#if defined(__EMSCRIPTEN__)
int VerifyAll(const std::vector<std::string>&) {
  return Fail("recordings are not read in a page yet");
}
#else
int VerifyAll(const std::vector<std::string>& files) {
  bool are_verified = true;
  for (const std::string& file : files) {
    auto recording = record::ReadRecording(file);
    if (!recording.ok()) return Fail(file + ": " + recording.error().Text());
    const double tick_seconds = recording->description.tick_seconds;
    auto replay = record::Replay::Open(std::move(*recording), 2);
    if (!replay.ok()) return Fail(file + ": " + replay.error().Text());
    const auto verified = replay->Verify();
    if (!verified.ok()) return Fail(file + ": " + verified.error().Text());
    are_verified = are_verified && verified->IsVerified();
    const std::string name = std::filesystem::path(file).filename().string();
    if (verified->divergence) {
      std::printf("%s DIVERGED at %.2f s\n", name.c_str(),
                  static_cast<double>(verified->divergence->tick) * tick_seconds);
    } else if (!verified->is_outcome_same) {
      std::printf("%s DIVERGED in the outcome\n", name.c_str());
    } else {
      std::printf("%s verified, %llu ticks, %s\n", name.c_str(),
                  static_cast<unsigned long long>(verified->ticks),
                  base::HashText(replay->GetSimulation().Hash()).c_str());
    }
    std::fflush(stdout);
  }
  return are_verified ? 0 : 1;
}
#endif

}  // namespace

int main(int count, char** values) {
  const std::vector<std::string> arguments(values + 1, values + count);
  if (arguments.size() < 2 || (arguments[0] != "play" && arguments[0] != "verify"))
    return Fail(
        "usage: scene_bits play REPOSITORY [--ticks N] [--threads T] [--lane golden|whole] [NAME...], or "
        "scene_bits verify REPOSITORY FILE...");
  setenv("TROCAR_DATA_DIR", arguments[1].c_str(), 1);
  if (arguments[0] == "verify") return VerifyAll({arguments.begin() + 2, arguments.end()});
  Options options;
  for (std::size_t i = 2; i < arguments.size(); ++i) {
    const bool has_value = i + 1 < arguments.size();
    if (arguments[i] == "--ticks" && has_value) {
      options.most_ticks = std::strtoull(arguments[++i].c_str(), nullptr, 10);
    } else if (arguments[i] == "--threads" && has_value) {
      options.threads = std::max(1, std::atoi(arguments[++i].c_str()));
    } else if (arguments[i] == "--lane" && has_value) {
      options.lane = arguments[++i];
    } else {
      options.names.push_back(arguments[i]);
    }
  }
  return PlayAll(arguments[1], options);
}
