// SPDX-License-Identifier: Apache-2.0
/// \file device_framer_seeds.cpp  Streams as the emulated devices send them, one file each, for the fuzzer to start from:
/// device_framer_seeds PARSER FOLDER.
#include <cstdio>
#include <string>

#include "trocar/core/safe_file.h"
#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"

namespace {

using namespace trocar::device;

std::unique_ptr<Emulator> MakeEmulator(const std::string& parser, const SensorMotion& sensors) {
  if (parser == "jaw") return MakeJawEmulator({{}, CalcHandMotion});
  if (parser == "igtl") return MakeIgtlEmulator(sensors);
  const auto format = FindFormat(parser);
  if (!format) return nullptr;
  PolhemusEmulation emulation;
  emulation.format = *format;
  emulation.motion = sensors;
  auto tracker = MakePolhemusEmulator(std::move(emulation));
  const int stations[] = {1, 2};
  tracker->Receive(SetUpCommands(*format, stations, {1, 0, 0}) + StartCommand(*format));
  return tracker;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 3) return 2;
  const std::string parser = arguments[1], folder = arguments[2];
  const auto hands = MakeHandsSettings(DefaultTracker());
  if (!hands) return 1;
  const auto emulator = MakeEmulator(parser, MoveHands(*hands, CalcHandMotion));
  if (emulator == nullptr) return 2;
  constexpr int kSeeds = 20;
  for (int i = 0; i < kSeeds; ++i) {
    // the first byte is the fuzzer's chunk
    const std::string stream = static_cast<char>(7 * i) + emulator->Advance(0.05 * (i + 1));
    if (const auto done = trocar::core::WriteFile(folder + "/seed" + std::to_string(i), stream); !done) {
      std::puts(done.error().Text().c_str());
      return 1;
    }
  }
  return 0;
}
