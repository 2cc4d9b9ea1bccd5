// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>

#include "trocar/host/translate.h"
#include "trocar/store/attempts.h"

namespace trocar::store {
namespace {

constexpr std::string_view kStates[] = {"unverified", "verified", "recorded_here", "accepted", "refused"};
constexpr std::string_view kReasons[] = {"",
                                         "not_yet",
                                         "earlier",
                                         "imported",
                                         "no_recording",
                                         "other_version",
                                         "saved_state",
                                         "cannot_replay",
                                         "diverged",
                                         "other_ending"};

template <typename T, std::size_t n>
std::optional<T> Parse(const std::string_view (&names)[n], std::string_view name) {
  const auto found = std::find(std::begin(names), std::end(names), name);
  if (found == std::end(names)) return std::nullopt;
  return static_cast<T>(found - std::begin(names));
}

}  // namespace

std::string_view VerificationName(Verification verification) noexcept {
  return kStates[static_cast<std::size_t>(verification)];
}

std::optional<Verification> ParseVerification(std::string_view name) noexcept {
  return Parse<Verification>(kStates, name);
}

std::string_view WhyName(WhyUnverified why) noexcept {
  return kReasons[static_cast<std::size_t>(why)];
}

std::optional<WhyUnverified> ParseWhy(std::string_view name) noexcept {
  return Parse<WhyUnverified>(kReasons, name);
}

std::string DescribeMark(const VerificationMark& mark) {
  using host::Mark;
  switch (mark.state) {
    case Verification::kVerified:
    case Verification::kRecordedHere:
      return "";
    case Verification::kRefused:
      return mark.why == WhyUnverified::kOtherEnding
                 ? Mark("refused: its file claims another outcome than the replay")
                 : Mark("refused: it does not replay to the states in its file");
    case Verification::kAccepted:
      return mark.why == WhyUnverified::kEarlier ? Mark("not verified, counts: kept by an earlier version")
                                                 : Mark("not verified, counts: accepted by an administrator");
    case Verification::kUnverified:
      break;
  }
  switch (mark.why) {
    case WhyUnverified::kEarlier:
      return Mark("not verified: kept by an earlier version");
    case WhyUnverified::kImported:
      return Mark("not verified: it came with a file");
    case WhyUnverified::kNoRecording:
      return Mark("not verified: its recording is not here");
    case WhyUnverified::kOtherVersion:
      return Mark("not verified: recorded by another version");
    case WhyUnverified::kSavedState:
      return Mark("not verified: it begins from a saved state");
    case WhyUnverified::kCannotReplay:
      return Mark("not verified: it cannot be replayed here");
    default:
      return Mark("not verified: not replayed yet");
  }
}

}  // namespace trocar::store
