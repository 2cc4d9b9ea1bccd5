// SPDX-License-Identifier: Apache-2.0
#include "trocar/training/coach_measures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "trocar/base/assert.h"
#include "trocar/base/statistics.h"
#include "trocar/base/to_integer.h"
#include "trocar/training/signal.h"

namespace trocar::training {

using math::Vec3;

namespace {

constexpr double kTremorLow = 5.0, kTremorHigh = 20.0;   // [Hz]
constexpr double kTremorWindow = 2.0;                    // of the moment that is shown [s]
constexpr double kSmooth = 6.0;                          // of the motion without tremor [Hz]
constexpr double kMoves = 0.020, kRests = 0.005;         // [m/s]; as the metrics' movements
constexpr double kLongMove = 0.020, kShortMove = 0.010;  // [m]
constexpr double kAtOnce = 0.25;                         // after a movement [s]
constexpr double kBack = -0.7;  // cosine of the angle between a movement and one back
constexpr double kWaits = 1.0, kPause = 0.5, kUnseen = 0.5;  // [s]
constexpr double kLoaded = 0.05;                             // [N]
constexpr double kPeakShare = 0.99;

using Hand = std::vector<ToolSample>;

/// The tip's path, low-passed.
std::vector<Vec3> SmoothTips(const Hand& hand, double dt, double cutoff) {
  std::vector<Vec3> tips(hand.size());
  if (hand.empty()) return tips;
  std::vector<double> axis(hand.size());
  for (int k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < hand.size(); ++i) axis[i] = hand[i].tip[k];
    const std::vector<double> smooth = FilterLowPass(axis, dt, cutoff);
    for (std::size_t i = 0; i < hand.size(); ++i) tips[i][k] = smooth[i];
  }
  return tips;
}

std::vector<double> SpeedOf(const std::vector<Vec3>& tips, double dt) {
  std::vector<double> speed(tips.size(), 0.0);
  for (std::size_t i = 1; i < tips.size(); ++i) speed[i] = math::Distance(tips[i], tips[i - 1]) / dt;
  return speed;
}

/// Runs of ticks [begin, end) in which something holds.
struct Run {
  std::size_t begin = 0, end = 0;
  std::size_t Length() const { return end - begin; }
};

template <typename Holds>
std::vector<Run> FindRuns(std::size_t count, const Holds& holds) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < count; ++i) {
    if (!holds(i)) continue;
    if (runs.empty() || runs.back().end != i) runs.push_back({i, i});
    runs.back().end = i + 1;
  }
  return runs;
}

std::optional<CoachMoment> LongestOf(const std::vector<Run>& runs, double dt, int hand) {
  const auto longest = std::max_element(runs.begin(), runs.end(),
                                        [](const Run& a, const Run& b) { return a.Length() < b.Length(); });
  if (longest == runs.end()) return std::nullopt;
  return CoachMoment{static_cast<double>(longest->begin) * dt, static_cast<double>(longest->Length()) * dt,
                     hand};
}

bool IsLonger(const std::optional<CoachMoment>& a, const std::optional<CoachMoment>& b) {
  return a && (!b || a->seconds > b->seconds);
}

/// One hand's motion, prepared once.
struct Motion {
  std::vector<Vec3> tips;
  std::vector<double> speed;
  std::vector<Run> movements;            // from above kMoves back to kRests, with the way up from kRests
  std::vector<std::uint8_t> rests_long;  // (ticks) in a rest of kWaits or more

  Motion(const Hand& hand, double dt) : tips(SmoothTips(hand, dt, kSmooth)), speed(SpeedOf(tips, dt)) {
    for (const Run& run : FindRuns(speed.size(), [&](std::size_t i) { return speed[i] > kRests; })) {
      const auto peak = *std::max_element(speed.begin() + static_cast<std::ptrdiff_t>(run.begin),
                                          speed.begin() + static_cast<std::ptrdiff_t>(run.end));
      if (peak > kMoves) movements.push_back(run);
    }
    rests_long.assign(speed.size(), 0);
    for (const Run& run : FindRuns(speed.size(), [&](std::size_t i) { return speed[i] <= kRests; })) {
      if (static_cast<double>(run.Length()) * dt < kWaits) continue;
      std::fill(rests_long.begin() + static_cast<std::ptrdiff_t>(run.begin),
                rests_long.begin() + static_cast<std::ptrdiff_t>(run.end), std::uint8_t{1});
    }
  }
  double PathOf(const Run& run) const {
    double path = 0;
    for (std::size_t i = run.begin + 1; i < run.end; ++i) path += math::Distance(tips[i], tips[i - 1]);
    return path;
  }
  Vec3 ChordOf(const Run& run) const { return tips[run.end - 1] - tips[run.begin]; }
};

using Motions = std::array<Motion, instrument::kHandCount>;

CoachMeasure CalcTremor(const AttemptTrace& trace) {
  CoachMeasure measure{"tremor", 0, std::nullopt};
  double most_in_window = -1;
  const auto window = std::max<std::size_t>(1, base::TruncateTo<std::size_t>(kTremorWindow / trace.dt));
  for (std::size_t h = 0; h < trace.hands.size(); ++h) {
    const std::vector<Vec3> high = SmoothTips(trace.hands[h], trace.dt, kTremorHigh),
                            low = SmoothTips(trace.hands[h], trace.dt, kTremorLow);
    std::vector<double> sum(high.size() + 1, 0.0);
    for (std::size_t i = 0; i < high.size(); ++i)
      sum[i + 1] = sum[i] + math::SquaredDistance(high[i], low[i]);
    if (high.empty()) continue;
    measure.value = std::max(measure.value, std::sqrt(sum.back() / static_cast<double>(high.size())));
    for (std::size_t i = 0; i + window < sum.size(); i += window / 4 + 1) {
      const double energy = sum[i + window] - sum[i];
      if (energy <= most_in_window) continue;
      most_in_window = energy;
      measure.moment = CoachMoment{static_cast<double>(i) * trace.dt, kTremorWindow, static_cast<int>(h)};
    }
  }
  return measure;
}

CoachMeasure CalcOneHandWaits(const AttemptTrace& trace, const Motions& motions) {
  CoachMeasure measure{"one_hand_waits", 0, std::nullopt};
  std::size_t either = 0, alone = 0;
  for (std::size_t h = 0; h < motions.size(); ++h) {
    const Motion &rests = motions[h], &works = motions[1 - h];
    const auto waits = [&](std::size_t i) { return rests.rests_long[i] != 0 && works.speed[i] > kRests; };
    for (std::size_t i = 0; i < trace.Ticks(); ++i) alone += waits(i) ? 1 : 0;
    // the moment: the longest rest in which the other hand was at work
    const auto longest =
        LongestOf(FindRuns(trace.Ticks(), [&](std::size_t i) { return rests.rests_long[i] != 0; }), trace.dt,
                  static_cast<int>(h));
    if (IsLonger(longest, measure.moment)) measure.moment = longest;
  }
  for (std::size_t i = 0; i < trace.Ticks(); ++i)
    either += motions[0].speed[i] > kRests || motions[1].speed[i] > kRests ? 1 : 0;
  if (either > 0) measure.value = static_cast<double>(alone) / static_cast<double>(either);
  return measure;
}

CoachMeasure CalcPeakForce(const AttemptTrace& trace) {
  CoachMeasure measure{"peak_force", 0, std::nullopt, std::nullopt};
  std::vector<double> loads;
  double most = 0;
  for (std::size_t h = 0; h < trace.hands.size(); ++h) {
    for (std::size_t i = 0; i < trace.hands[h].size(); ++i) {
      const double force = trace.hands[h][i].force;
      if (!(force > kLoaded)) continue;
      loads.push_back(force);
      if (force <= most) continue;
      most = force;
      measure.moment = CoachMoment{static_cast<double>(i) * trace.dt, 0, static_cast<int>(h)};
    }
  }
  measure.value = base::CalcPercentile(std::move(loads), kPeakShare);
  measure.most = most;
  return measure;
}

CoachMeasure CalcEnergyInAir(const AttemptTrace& trace) {
  CoachMeasure measure{"energy_in_air", 0, std::nullopt};
  for (std::size_t h = 0; h < trace.hands.size(); ++h) {
    const Hand& hand = trace.hands[h];
    const auto runs =
        FindRuns(hand.size(), [&](std::size_t i) { return hand[i].pedal && !hand[i].has_current; });
    for (const Run& run : runs) measure.value += static_cast<double>(run.Length()) * trace.dt;
    const auto longest = LongestOf(runs, trace.dt, static_cast<int>(h));
    if (IsLonger(longest, measure.moment)) measure.moment = longest;
  }
  return measure;
}

CoachMeasure CalcTipsUnseen(const AttemptTrace& trace) {
  CoachMeasure measure{"tips_unseen", 0, std::nullopt};
  const auto unseen = [&](std::size_t i) { return !trace.hands[0][i].in_view || !trace.hands[1][i].in_view; };
  std::vector<Run> runs = FindRuns(trace.Ticks(), unseen);
  // a tip that trembles at the picture's border is not lost
  std::erase_if(runs, [&](const Run& run) { return static_cast<double>(run.Length()) * trace.dt < kUnseen; });
  std::size_t ticks = 0;
  for (const Run& run : runs) ticks += run.Length();
  if (trace.Ticks() > 0) measure.value = static_cast<double>(ticks) / static_cast<double>(trace.Ticks());
  measure.moment = LongestOf(runs, trace.dt, -1);
  return measure;
}

CoachMeasure CalcDetour(const AttemptTrace& trace, const Motions& motions) {
  CoachMeasure measure{"detour", 0, std::nullopt};
  double paths = 0, chords = 0, worst = 0;
  for (std::size_t h = 0; h < motions.size(); ++h) {
    for (const Run& run : motions[h].movements) {
      const double path = motions[h].PathOf(run), chord = math::Norm(motions[h].ChordOf(run));
      if (chord < kLongMove) continue;  // there and back is no detour
      paths += path, chords += chord;
      if (path - chord <= worst) continue;
      worst = path - chord;
      measure.moment = CoachMoment{static_cast<double>(run.begin) * trace.dt,
                                   static_cast<double>(run.Length()) * trace.dt, static_cast<int>(h)};
    }
  }
  if (chords > 0) measure.value = paths / chords - 1;
  return measure;
}

CoachMeasure CalcCorrections(const AttemptTrace& trace, const Motions& motions) {
  CoachMeasure measure{"corrections", 0, std::nullopt};
  int all = 0, corrected = 0;
  double most = 0;
  for (std::size_t h = 0; h < motions.size(); ++h) {
    const auto& moves = motions[h].movements;
    for (std::size_t m = 0; m < moves.size(); ++m) {
      const Vec3 chord = motions[h].ChordOf(moves[m]);
      if (math::Norm(chord) < kLongMove) continue;
      ++all;
      if (m + 1 == moves.size()) continue;
      const Vec3 next = motions[h].ChordOf(moves[m + 1]);
      const double length = math::Norm(next);
      const bool is_back = length < kShortMove && math::Dot(chord, next) < kBack * length * math::Norm(chord);
      const bool is_at_once = static_cast<double>(moves[m + 1].begin - moves[m].end) * trace.dt < kAtOnce;
      if (!is_back || !is_at_once) continue;
      ++corrected;
      if (length <= most) continue;
      most = length;
      measure.moment =
          CoachMoment{static_cast<double>(moves[m].begin) * trace.dt,
                      static_cast<double>(moves[m + 1].end - moves[m].begin) * trace.dt, static_cast<int>(h)};
    }
  }
  if (all > 0) measure.value = static_cast<double>(corrected) / all;
  return measure;
}

CoachMeasure CalcPauses(const AttemptTrace& trace, const Motions& motions) {
  CoachMeasure measure{"pauses", 0, std::nullopt};
  std::vector<Run> runs = FindRuns(trace.Ticks(), [&](std::size_t i) {
    return motions[0].speed[i] <= kRests && motions[1].speed[i] <= kRests;
  });
  std::erase_if(runs, [&](const Run& run) { return static_cast<double>(run.Length()) * trace.dt < kPause; });
  std::size_t ticks = 0;
  for (const Run& run : runs) ticks += run.Length();
  if (trace.Ticks() > 0) measure.value = static_cast<double>(ticks) / static_cast<double>(trace.Ticks());
  measure.moment = LongestOf(runs, trace.dt, -1);
  return measure;
}

}  // namespace

std::vector<CoachMeasure> CalcCoachMeasures(const AttemptTrace& trace) {
  TROCAR_ASSERT(trace.dt > 0.0 && trace.hands[0].size() == trace.hands[1].size());
  const Motions motions{Motion(trace.hands[0], trace.dt), Motion(trace.hands[1], trace.dt)};
  return {CalcTremor(trace),
          CalcOneHandWaits(trace, motions),
          CalcPeakForce(trace),
          CalcEnergyInAir(trace),
          CalcTipsUnseen(trace),
          CalcDetour(trace, motions),
          CalcCorrections(trace, motions),
          CalcPauses(trace, motions),
          {"time", trace.Seconds(), std::nullopt}};
}

CoachMeasure CountEvents(const AttemptTrace& trace, const std::string& kind) {
  CoachMeasure measure{"event:" + kind, 0, std::nullopt};
  for (const AttemptEvent& event : trace.events) {
    if (event.kind != kind || !event.is_error) continue;
    if (!measure.moment) measure.moment = CoachMoment{event.time, 0, event.hand};
    measure.value += 1;
  }
  return measure;
}

}  // namespace trocar::training
