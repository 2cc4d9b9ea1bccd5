// SPDX-License-Identifier: Apache-2.0
/// \file device_framer_seeds.cpp  Streams as the emulated devices send them, one file each, for the fuzzer to start from:
/// device_framer_seeds PARSER FOLDER.
#include <cstdio>
#include <string>

#include "haply/haply_messages.h"
#include "haply/web_socket.h"
#include "trocar/device/device_store.h"
#include "trocar/device/emulator.h"
#include "trocar/host/safe_file.h"

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

bool Write(const std::string& folder, int number, const std::string& stream) {
  const auto done = trocar::host::WriteFile(folder + "/seed" + std::to_string(number), stream);
  if (!done) std::puts(done.error().Text().c_str());
  return done.ok();
}

/// States as the service sends them, one and two devices, and the pings between.
int WriteHaplySeeds(const std::string& folder) {
  for (int i = 0; i < 20; ++i) {
    haply::State state;
    for (int device = 0; device < i % 3; ++device)
      state.devices.push_back({"device" + std::to_string(device), {0.01 * i, -0.02 * device, 0.1}});
    state.buttons = static_cast<std::uint32_t>(i % 8);
    std::string stream(1, static_cast<char>(7 * i));
    if (i % 4 == 1) stream += web_socket::FormatFrame(web_socket::Opcode::kPing, "?", 0);
    stream += web_socket::FormatFrame(web_socket::Opcode::kText, haply::FormatState(state), 0);
    if (!Write(folder, i, stream)) return 1;
  }
  return 0;
}

/// Reports of 4 bytes; the first byte of the stream is the length of one, less 1.
int WriteHidSeeds(const std::string& folder) {
  for (int raw = 0; raw <= kMaxJawRaw; raw += 93) {
    std::string stream(1, '\3');
    for (const int value : {raw, kMaxJawRaw - raw, kMaxJawRaw, raw / 2})
      stream += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
    if (!Write(folder, raw, stream)) return 1;
  }
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 3) return 2;
  const std::string parser = arguments[1], folder = arguments[2];
  if (parser == "jaw-hid") return WriteHidSeeds(folder);
  if (parser == "haply") return WriteHaplySeeds(folder);
  const auto hands = MakeHandsSettings(DefaultTracker());
  if (!hands) return 1;
  const auto emulator = MakeEmulator(parser, MoveHands(*hands, CalcHandMotion));
  if (emulator == nullptr) return 2;
  constexpr int kSeeds = 20;
  for (int i = 0; i < kSeeds; ++i) {
    // the first byte is the fuzzer's chunk; its highest bit mends checksums
    const char first = static_cast<char>(7 * i % 128 + (i % 2 == 0 ? 0 : 128));
    const std::string stream = first + emulator->Advance(0.05 * (i + 1));
    if (!Write(folder, i, stream)) return 1;
  }
  return 0;
}
