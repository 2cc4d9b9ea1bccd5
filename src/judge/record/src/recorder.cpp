// SPDX-License-Identifier: Apache-2.0
#include "trocar/record/recorder.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "chunk.h"
#include "chunk_writer.h"
#include "recording_json.h"
#include "state_coder.h"
#include "state_index.h"
#include "trocar/base/to_integer.h"
#include "trocar/host/json_text.h"
#include "trocar/host/log.h"
#include "trocar/host/real_time.h"
#include "trocar/host/version.h"
#include "trocar/record/input_codec.h"
#include "trocar/record/outcome.h"
#include "trocar/simulation/engine_bits.h"

namespace trocar::record {
namespace {

using simulation::Simulation;

/// Ticks that wait for the writer at most: more than half a minute, in which a disk may stall.
constexpr std::size_t kRingSize = 4096;
constexpr auto kWritePeriod = std::chrono::milliseconds(50);
constexpr double kChunkSeconds = 0.1;
constexpr std::size_t kStateSlots = 3;
/// A keyframe that stands alone comes first in each group; the others are told apart from it.
constexpr int kKeyframeGroup = 12;
constexpr double kLowSeconds = 60, kLowShare = 0.05;

/// What one tick hands over.
struct Entry {
  scene::Input input;
  std::uint64_t tick = 0;
  std::uint64_t hash = 0;
  bool has_hash = false;
  int state_slot = -1;       // the state after this tick ...
  bool is_keyframe = false;  // ... for the recording, or else for the index beside it
  std::uint8_t event_count = 0;
  std::uint8_t error_count = 0;
  std::optional<std::uint8_t> phase;  // of an operation, where another one began
  std::array<scene::Event, simulation::kEventRing> events{};
  std::array<scene::TaskError, 4> errors{};  // of the task's rules
};

std::string CompilerText() {
#if defined(__clang__)
  return "clang " + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#elif defined(__GNUC__)
  return "g++ " + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#else
  return "unknown";
#endif
}

std::string JumpText(double jump, double wall) {
  char text[160];
  std::snprintf(
      text, sizeof text,
      "clock jumped by %+.1f s, to %s: it was set, or the computer slept; times in this recording are "
      "counted by ticks",
      jump, FormatWallClock(wall).c_str());
  return text;
}

std::uint64_t TicksIn(double seconds, double tick_seconds) {
  return seconds > 0 ? std::max<std::uint64_t>(1, base::RoundTo<std::uint64_t>(seconds / tick_seconds)) : 0;
}

/// How many ticks lie between two of each kind; 0: none are written.
struct Intervals {
  Intervals(const RecorderSettings& settings, double tick_seconds)
      : hash(TicksIn(settings.hash_seconds, tick_seconds)),
        keyframe(TicksIn(settings.keyframe_seconds, tick_seconds)),
        index(TicksIn(settings.index_seconds, tick_seconds)),
        chunk(TicksIn(kChunkSeconds, tick_seconds)) {}

  std::uint64_t hash, keyframe, index, chunk;
};

/// From the simulation's thread to the writing one, without a lock.
struct Handover {
  std::vector<Entry> ring = std::vector<Entry>(kRingSize);
  std::atomic<std::uint64_t> head{0}, tail{0};  // entries put and taken
  std::array<std::vector<std::byte>, kStateSlots> states;
  std::array<std::atomic<bool>, kStateSlots> is_state_free{true, true, true};
  std::atomic<bool> has_overrun{false};

  int TakeStateSlot();
};

int Handover::TakeStateSlot() {
  for (std::size_t slot = 0; slot < kStateSlots; ++slot) {
    if (is_state_free[slot].load(std::memory_order_acquire)) {
      is_state_free[slot].store(false, std::memory_order_relaxed);
      return static_cast<int>(slot);
    }
  }
  return -1;
}
/// What the simulation's thread has handed over so far, and when it saves the next states.
struct Progress {
  std::uint64_t events = 0, errors = 0, next_keyframe = 0, next_index = 0;
  std::uint8_t phase = 0;
};

/// Inputs that the writing thread gathers.
struct InputChunk {
  InputEncoder encoder;
  bool is_new_row = true;
  std::vector<std::byte> bytes;
  std::uint64_t first = 0;
  std::uint32_t count = 0;
};

/// Of the writing thread.
struct KeyframeGroup {
  std::optional<StatePlanes> base;
  int size = 0;
};

/// The index beside the recording, of the writing thread.
struct IndexBeside {
  std::filesystem::path path;
  std::optional<StateIndex> states;  // none where none is wanted, or the recording has gone to another file
};

}  // namespace

struct Recorder::Content {
  Content(ChunkWriter opened, RecorderSettings wanted, const Simulation& simulation, ClockReading start)
      : settings(std::move(wanted)),
        scene(simulation.GetScene()),
        first_tick(simulation.GetSnapshot().tick),
        intervals(settings, scene.tick_seconds),
        clock_watch(start),
        writer(std::move(opened)) {}

  RecorderSettings settings;
  const scene::Scene& scene;
  std::uint64_t first_tick;
  Intervals intervals;

  Progress progress;  // of the simulation's thread
  Handover handover;

  // of the writing thread, once that runs
  ClockWatch clock_watch;
  ChunkWriter writer;
  InputChunk chunk;
  KeyframeGroup group;
  IndexBeside index;

  mutable std::mutex mutex;  // of the next four; never taken by Add
  std::condition_variable wake;
  bool is_stopping = false;
  std::vector<TextMark> marks;
  RecorderStatus status;
  std::atomic<std::uint64_t> kept{0};
  std::atomic<bool> has_failed{false};
  std::thread thread;

  void NoteEvents(const simulation::Snapshot& now, Entry& entry);
  void SaveState(const Simulation& simulation, Entry& entry);
  void Run();
  void WriteEntries();
  void CloseChunk();
  void WriteKeyframe(const Entry& entry);
  void WriteState(const Entry& entry);
  void WriteEvents(const Entry& entry);
  void AddMark(std::string text);
  void SeeClock();
  void WriteMarks();
  void SyncAndTell();
  void Stop();
};

void Recorder::Content::NoteEvents(const simulation::Snapshot& now, Entry& entry) {
  const std::uint64_t oldest =
      now.event_count > simulation::kEventRing ? now.event_count - simulation::kEventRing : 0;
  for (std::uint64_t n = std::max(progress.events, oldest); n < now.event_count; ++n)
    entry.events[entry.event_count++] = now.events[n % simulation::kEventRing];
  progress.events = now.event_count;
  const auto ring_size = static_cast<std::uint64_t>(now.task.last_errors.size());
  const std::uint64_t most = std::min<std::uint64_t>(ring_size, entry.errors.size());
  const std::uint64_t first = now.task.error_count > most ? now.task.error_count - most : 0;
  for (std::uint64_t n = std::max(progress.errors, first); n < now.task.error_count; ++n)
    entry.errors[entry.error_count++] = now.task.last_errors[n % ring_size];
  progress.errors = now.task.error_count;
  entry.phase.reset();
  if (scene.operation && now.operation.procedure.phase != progress.phase)
    entry.phase = progress.phase = now.operation.procedure.phase;
}

/// A keyframe or a state of the index, where one is due.
void Recorder::Content::SaveState(const Simulation& simulation, Entry& entry) {
  entry.state_slot = -1;
  entry.is_keyframe = intervals.keyframe != 0 && entry.tick >= progress.next_keyframe;
  const bool is_index = intervals.index != 0 && entry.tick >= progress.next_index;
  if (!entry.is_keyframe && !is_index) return;
  entry.state_slot = handover.TakeStateSlot();
  // where nobody waits, so that the same attempt gives the same bytes however slow the disk
  while (entry.state_slot < 0 && settings.waits && !has_failed.load()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    entry.state_slot = handover.TakeStateSlot();
  }
  if (entry.state_slot < 0) return;
  simulation.Save(handover.states[static_cast<std::size_t>(entry.state_slot)]);
  if (entry.is_keyframe) progress.next_keyframe = entry.tick + intervals.keyframe;
  if (is_index) progress.next_index = entry.tick + intervals.index;
}

void Recorder::Content::CloseChunk() {
  if (chunk.count == 0) return;
  const std::uint32_t head_word = chunk.count | (chunk.is_new_row ? kNewRow : 0);
  std::array<std::byte, 4> count{};
  for (std::size_t i = 0; i < count.size(); ++i) count[i] = static_cast<std::byte>(head_word >> (8 * i));
  std::copy(count.begin(), count.end(), chunk.bytes.begin());
  writer.Put(ChunkKind::kInputs, chunk.first, chunk.bytes);
  chunk.count = 0;
  chunk.is_new_row = false;
}

void Recorder::Content::WriteKeyframe(const Entry& entry) {
  CloseChunk();
  const auto& state = handover.states[static_cast<std::size_t>(entry.state_slot)];
  if (group.size == 0) group.base.reset();
  writer.Put(ChunkKind::kKeyframe, entry.tick, CompressState(state, group.base ? &*group.base : nullptr),
             false);
  if (group.size == 0) group.base.emplace(state);
  group.size = (group.size + 1) % kKeyframeGroup;
  // whoever begins at a keyframe needs no input before it
  chunk.encoder.Reset();
  chunk.is_new_row = true;
}

void Recorder::Content::WriteState(const Entry& entry) {
  const auto slot = static_cast<std::size_t>(entry.state_slot);
  if (entry.is_keyframe) {
    WriteKeyframe(entry);
  } else if (index.states) {
    index.states->Add(entry.tick, handover.states[slot]);
    // what the disk does not take would fill the memory
    if (!index.states->IsOnDisk()) index.states.reset();
  }
  handover.is_state_free[slot].store(true, std::memory_order_release);
}

void Recorder::Content::WriteEvents(const Entry& entry) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  const scene::Procedure* procedure = scene::ProcedureOf(scene);
  for (std::uint8_t i = 0; i < entry.event_count; ++i) list.push_back(EventJson(entry.events[i], procedure));
  for (std::uint8_t i = 0; i < entry.error_count; ++i)
    list.push_back(TaskErrorJson(*scene.task, entry.tick, entry.errors[i]));
  if (entry.phase) list.push_back(PhaseJson(entry.tick, scene::PhaseName(procedure, *entry.phase)));
  const std::string text = host::FormatJson(list);
  writer.Put(ChunkKind::kEvents, entry.tick, BytesOf(text));
}

void Recorder::Content::WriteEntries() {
  std::uint64_t taken = handover.tail.load(std::memory_order_relaxed);
  const std::uint64_t put = handover.head.load(std::memory_order_acquire);
  for (; taken < put; ++taken) {
    const Entry& entry = handover.ring[taken % kRingSize];
    if (chunk.count == 0) {
      chunk.first = entry.tick - 1;
      chunk.bytes.assign(4, std::byte{});
    }
    chunk.encoder.Encode(entry.input, chunk.bytes);
    if (++chunk.count >= intervals.chunk) CloseChunk();
    if (entry.has_hash) {
      CloseChunk();
      std::array<std::byte, 8> hash{};
      for (std::size_t i = 0; i < hash.size(); ++i) hash[i] = static_cast<std::byte>(entry.hash >> (8 * i));
      writer.Put(ChunkKind::kHash, entry.tick, hash);
    }
    if (entry.event_count > 0 || entry.error_count > 0 || entry.phase) {
      CloseChunk();
      WriteEvents(entry);
    }
    if (entry.state_slot >= 0) WriteState(entry);
    handover.tail.store(taken + 1, std::memory_order_release);
  }
}

void Recorder::Content::AddMark(std::string text) {
  const std::uint64_t put = handover.head.load(std::memory_order_acquire);
  const std::uint64_t tick = put > 0 ? handover.ring[(put - 1) % kRingSize].tick : first_tick;
  const std::lock_guard lock(mutex);
  marks.push_back({tick, std::move(text)});
}

void Recorder::Content::SeeClock() {
  const ClockReading now = settings.clocks();
  if (const auto jump = clock_watch.See(now)) AddMark(JumpText(*jump, now.wall));
}

void Recorder::Content::WriteMarks() {
  std::vector<TextMark> now;
  {
    const std::lock_guard lock(mutex);
    now.swap(marks);
  }
  if (!now.empty()) CloseChunk();
  for (const TextMark& mark : now) writer.Put(ChunkKind::kMark, mark.tick, BytesOf(mark.text));
}

void Recorder::Content::SyncAndTell() {
  const std::uint64_t written = handover.tail.load(std::memory_order_relaxed) - chunk.count;
  const int files = writer.FileCount();
  const base::Status synced = writer.Sync();
  if (writer.FileCount() != files) {
    group.size = 0;  // the keyframe that others are told apart from stayed behind
    if (index.states) {
      // it is of the file that is given up
      index.states.reset();
      std::error_code ignored;
      std::filesystem::remove(index.path, ignored);
    }
  }
  const Space space = writer.GetSpace();
  const std::lock_guard lock(mutex);
  status.path = writer.Path();
  status.bytes = writer.Bytes();
  if (!synced.ok()) {
    status.failure = synced.error();
    has_failed.store(true);
    host::Log(host::LogLevel::kWarning, "the recording has stopped: " + synced.error().Text());
    return;
  }
  kept.store(written);
  const double seconds = static_cast<double>(written) * scene.tick_seconds;
  if (seconds > 1 && status.bytes > 0)
    status.seconds_left = static_cast<double>(space.free) * seconds / static_cast<double>(status.bytes);
  status.is_space_low = status.seconds_left < kLowSeconds ||
                        static_cast<double>(space.free) < kLowShare * static_cast<double>(space.all);
}

void Recorder::Content::Run() {
  host::LeaveRealTime();
  while (!has_failed.load()) {
    bool is_last = false;
    {
      std::unique_lock lock(mutex);
      wake.wait_for(lock, kWritePeriod, [&] { return is_stopping; });
      is_last = is_stopping;
    }
    WriteEntries();
    // where nobody waits a chunk is written when it is whole, so that the same attempt gives the same bytes at any pace
    if (!settings.waits || is_last) CloseChunk();
    SeeClock();
    WriteMarks();
    if (writer.HasWaiting() || is_last) SyncAndTell();
    if (is_last) return;
  }
}

void Recorder::Content::Stop() {
  if (!thread.joinable()) return;
  {
    const std::lock_guard lock(mutex);
    is_stopping = true;
  }
  wake.notify_one();
  thread.join();
}

base::Result<std::unique_ptr<Recorder>> Recorder::Start(const std::filesystem::path& path,
                                                        Description description, const Simulation& simulation,
                                                        RecorderSettings settings) {
  description.tick_seconds = simulation.GetScene().tick_seconds;
  description.model = simulation.ModelFingerprint();
  description.model_kind = simulation::ModelFingerprintKind::kEveryField;
  description.first_tick = simulation.GetSnapshot().tick;
  description.program = std::string(host::VersionText());
  description.engine_bits = simulation::kEngineBits;
  description.compiler = CompilerText();
  const ClockReading start = settings.clocks();
  description.started = FormatWallClock(start.wall);
  auto writer = ChunkWriter::Open(path, settings.open);
  if (!writer.ok()) return writer.error();
  auto content = std::make_unique<Content>(std::move(*writer), std::move(settings), simulation, start);
  const std::string text = WriteDescription(description);
  content->writer.Put(ChunkKind::kDescription, description.first_tick, BytesOf(text));
  // memory for all saved states, so that Add allocates as good as never
  for (auto& state : content->handover.states) simulation.Save(state);
  if (description.first_tick > 0) {
    content->writer.Put(ChunkKind::kKeyframe, description.first_tick,
                        CompressState(content->handover.states[0], nullptr));
    content->group.base.emplace(content->handover.states[0]);
    content->group.size = 1;
  }
  if (const base::Status synced = content->writer.Sync(); !synced.ok()) return synced.error();
  content->status.path = content->writer.Path();
  content->status.bytes = content->writer.Bytes();
  content->progress.events = simulation.GetSnapshot().event_count;
  content->progress.errors = simulation.GetSnapshot().task.error_count;
  content->progress.phase = simulation.GetSnapshot().operation.procedure.phase;
  content->progress.next_keyframe = description.first_tick + content->intervals.keyframe;
  content->progress.next_index = description.first_tick + content->intervals.index;
  if (content->intervals.index > 0) {
    content->index.path = IndexPathOf(content->writer.Path());
    content->index.states.emplace(StateIndexSettings{content->index.path, content->writer.FileId(),
                                                     description.model, content->settings.index_bytes});
    // one that cannot be written is left to whoever replays
    if (!content->index.states->IsOnDisk()) content->index.states.reset();
  }
  if (!content->index.states) content->intervals.index = 0;
  content->thread = std::thread([c = content.get()] { c->Run(); });
  return std::unique_ptr<Recorder>(new Recorder(std::move(content)));
}

Recorder::Recorder(std::unique_ptr<Content> content) : content_(std::move(content)) {}

Recorder::~Recorder() {
  content_->Stop();
}

void Recorder::Add(const scene::Input& input, const Simulation& simulation) noexcept {
  Content& c = *content_;
  if (c.handover.has_overrun.load(std::memory_order_relaxed) || c.has_failed.load(std::memory_order_relaxed))
    return;
  const std::uint64_t put = c.handover.head.load(std::memory_order_relaxed);
  while (put - c.handover.tail.load(std::memory_order_acquire) >= kRingSize) {
    if (!c.settings.waits) {
      c.handover.has_overrun.store(true, std::memory_order_relaxed);
      return;
    }
    if (c.has_failed.load()) return;
    std::this_thread::sleep_for(kWritePeriod);
  }
  const simulation::Snapshot& now = simulation.GetSnapshot();
  Entry& entry = c.handover.ring[put % kRingSize];
  entry.input = input;
  entry.tick = now.tick;
  entry.event_count = entry.error_count = 0;
  c.NoteEvents(now, entry);
  entry.has_hash = c.intervals.hash != 0 && now.tick % c.intervals.hash == 0;
  if (entry.has_hash) entry.hash = simulation.Hash();
  c.SaveState(simulation, entry);
  c.handover.head.store(put + 1, std::memory_order_release);
}

void Recorder::Mark(std::string text) {
  content_->AddMark(std::move(text));
}

RecorderStatus Recorder::Status() const {
  const Content& c = *content_;
  const std::lock_guard lock(c.mutex);
  RecorderStatus status = c.status;
  status.added = c.handover.head.load();
  status.kept = c.kept.load();
  if (!status.failure && c.handover.has_overrun.load()) {
    status.failure =
        base::Error{base::ErrorCode::kFileUnwritable,
                    status.path.string() +
                        ": the disk did not take the recording in half a minute; it ends there. Record to "
                        "another disk"};
  }
  return status;
}

base::Status Recorder::Finish(const Simulation& simulation) {
  Content& c = *content_;
  c.Stop();
  const RecorderStatus now = Status();
  if (now.failure) return *now.failure;
  const Ending ending{simulation.GetSnapshot().tick, simulation.Hash(), CalcOutcome(simulation)};
  const std::string text = WriteEnding(ending);
  c.writer.Put(ChunkKind::kEnding, ending.ticks, BytesOf(text));
  c.SyncAndTell();
  if (const auto failure = Status().failure) return *failure;
  return {};
}

}  // namespace trocar::record
