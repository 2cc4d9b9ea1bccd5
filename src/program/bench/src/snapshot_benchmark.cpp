// SPDX-License-Identifier: Apache-2.0
// What a tick of an operation is as bytes for a network, and how long they take to make and to read.
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "trocar/agent/surgeon.h"
#include "trocar/bench/benchmark.h"
#include "trocar/files/scene_file.h"
#include "trocar/host/threads.h"
#include "trocar/procedures/find_procedure.h"
#include "trocar/scene/scene.h"
#include "trocar/simulation/simulation.h"
#include "trocar/simulation/snapshot_codec.h"

namespace trocar::bench {
namespace {

using simulation::Snapshot;
using simulation::SnapshotDecoder;
using simulation::SnapshotEncoder;
using simulation::SnapshotLayout;
using simulation::SnapshotPrecision;

constexpr int kTicksBefore = 480, kTicks = 240;  // the expert is at work
constexpr std::size_t kLate = 6;                 // ticks from one offered base to the next: 50 ms

struct Played {
  SnapshotLayout layout;
  std::vector<Snapshot> snapshots;
};

base::Result<Played> Play(int threads) {
  auto scene = files::FindOperation(procedures::kUsualProcedure, {}, 1);
  if (!scene) return scene.error();
  const auto shared = std::make_shared<const scene::Scene>(std::move(**scene));
  auto simulation = simulation::Simulation::Make(
      shared, {.threads = host::UseThreads(threads), .now = host::NowNanoseconds});
  if (!simulation) return simulation.error();
  const auto surgeon = agent::MakeSurgeon("expert", shared, 1);
  if (!surgeon) return surgeon.error();
  Played played{DescribeSnapshots(*simulation), {}};
  for (int tick = 0; tick < kTicksBefore + kTicks; ++tick) {
    simulation->Step((*surgeon)->Act(simulation->GetSnapshot()));
    if (tick >= kTicksBefore) played.snapshots.push_back(simulation->GetSnapshot());
  }
  return played;
}

struct Stream {
  std::string name;
  SnapshotPrecision precision = SnapshotPrecision::kExact;
  std::size_t offers =
      0;  ///< a base every so many ticks, known to have arrived at the next; 0: all messages are whole

  bool Offers(std::size_t tick) const { return offers != 0 && tick % offers == 0; }
};

using Messages = std::vector<std::vector<std::byte>>;

/// All snapshots as messages. \param[in,out] messages  their memory is used again
base::Status Encode(const Played& played, const Stream& stream, Messages& messages) {
  SnapshotEncoder encoder(played.layout, stream.precision);
  messages.resize(played.snapshots.size());
  std::uint64_t offered = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (stream.Offers(i)) encoder.Acknowledge(offered);
    const base::Status encoded = encoder.HasBase()
                                     ? encoder.EncodeDelta(played.snapshots[i], messages[i], stream.Offers(i))
                                     : encoder.EncodeWhole(played.snapshots[i], messages[i]);
    if (!encoded.ok()) return encoded;
    if (stream.Offers(i)) offered = encoder.LastMessage();
    if (i == 0 && stream.offers != 0) encoder.Acknowledge(offered);
  }
  return {};
}

/// Reads all of them. \param check  called with each that was read and its number
template <typename Check>
base::Status Decode(const Played& played, const Messages& messages, const Check& check) {
  SnapshotDecoder decoder(played.layout);
  Snapshot received = played.layout.shape;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (base::Status decoded = decoder.Decode(messages[i], received); !decoded.ok()) return decoded;
    check(i, received);
  }
  return {};
}

base::Status Measure(const Played& played, const Stream& stream, int repeats, BenchmarkResult& result) {
  Messages messages;
  base::Status done;
  const auto nothing = [] {};
  const double encoding = TimeShortest(repeats, nothing, [&] { done = Encode(played, stream, messages); });
  if (!done.ok()) return done;
  // a snapshot that arrived as it was sent makes the same message
  SnapshotEncoder sent(played.layout, stream.precision), arrived(played.layout, stream.precision);
  std::vector<std::byte> one, other;
  bool is_same = true;
  done = Decode(played, messages, [&](std::size_t i, const Snapshot& received) {
    is_same = is_same && sent.EncodeWhole(played.snapshots[i], one).ok() &&
              arrived.EncodeWhole(received, other).ok() && one == other;
  });
  if (!done.ok()) return done;
  if (!is_same) return WrongAnswer(stream.name, "what arrives is not what was sent");
  const double decoding = TimeShortest(
      repeats, nothing, [&] { done = Decode(played, messages, [](std::size_t, const Snapshot&) {}); });
  if (!done.ok()) return done;

  double bytes = 0;
  for (const auto& message : messages) bytes += static_cast<double>(message.size());
  auto count = static_cast<double>(messages.size());
  const double ticks = count;
  // the first is whole
  if (stream.offers != 0) bytes -= static_cast<double>(messages.front().size()), --count;
  result.cases.push_back({stream.name + "/bytes", bytes / count, "B"});
  result.cases.push_back({stream.name + "/encode", 1e6 * encoding / ticks, "us"});
  result.cases.push_back({stream.name + "/decode", 1e6 * decoding / ticks, "us"});
  return {};
}

}  // namespace

base::Result<BenchmarkResult> RunSnapshotBenchmark(const BenchmarkOptions& options) {
  const auto played = Play(options.threads);
  if (!played) return played.error();
  BenchmarkResult result;
  result.notes.push_back("the expert's cholecystectomy on the built-in patient, ticks " +
                         std::to_string(kTicksBefore) + " to " + std::to_string(kTicksBefore + kTicks) +
                         "; each figure is of one tick");
  constexpr auto kExact = SnapshotPrecision::kExact, kPicture = SnapshotPrecision::kPicture;
  for (const Stream& stream :
       {Stream{"whole", kExact, 0}, Stream{"delta", kExact, 1}, Stream{"delta_late", kExact, kLate},
        Stream{"picture_whole", kPicture, 0}, Stream{"picture_delta", kPicture, 1},
        Stream{"picture_delta_late", kPicture, kLate}}) {
    if (const base::Status done = Measure(*played, stream, options.repeats, result); !done.ok())
      return done.error();
  }
  return result;
}

}  // namespace trocar::bench
