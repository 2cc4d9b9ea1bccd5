// SPDX-License-Identifier: Apache-2.0
#include "trocar/base/simd_level.h"

#include <cstdlib>
#include <string>

#include "trocar/base/simd_choice.h"

namespace trocar::base {
namespace {

std::string_view ReadVariable() {
  const char* value = std::getenv(kSimdVariable);
  return value != nullptr ? value : "";
}

}  // namespace

std::string_view SimdLevelName(SimdLevel level) noexcept {
  switch (level) {
    case SimdLevel::kBaseline:
      return "baseline";
    case SimdLevel::kAvx2:
      return "avx2";
    case SimdLevel::kAvx512:
      return "avx512";
  }
  return "";
}

bool HasSimdLevel(SimdLevel level) noexcept {
#if defined(__x86_64__)
  if (level == SimdLevel::kAvx2) return __builtin_cpu_supports("avx2");
  if (level == SimdLevel::kAvx512) {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  }
#endif
  return level == SimdLevel::kBaseline;
}

std::vector<SimdLevel> ListSimdLevels() {
  std::vector<SimdLevel> levels;
  for (const SimdLevel level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
    if (HasSimdLevel(level)) levels.push_back(level);
  }
  return levels;
}

SimdLevel FindWidestSimdLevel() noexcept {
  if (HasSimdLevel(SimdLevel::kAvx512)) return SimdLevel::kAvx512;
  return HasSimdLevel(SimdLevel::kAvx2) ? SimdLevel::kAvx2 : SimdLevel::kBaseline;
}

Result<SimdLevel> ReadSimdLevel(std::string_view named) {
  if (named.empty()) return FindWidestSimdLevel();
#if defined(__x86_64__)
  if (named == "sse2") return SimdLevel::kBaseline;
#endif
  std::string known;
  for (const SimdLevel level : ListSimdLevels()) {
    if (named == SimdLevelName(level)) return level;
    known.append(known.empty() ? "" : ", ").append(SimdLevelName(level));
  }
  return Error{ErrorCode::kUsage, std::string(kSimdVariable) + " is \"" + std::string(named) +
                                      "\"; on this processor it may be " + known +
                                      ", or be left unset for the last of these"};
}

Status CheckSimdLevel() {
  const auto level = ReadSimdLevel(ReadVariable());
  return level ? Status() : Status(level.error());
}

SimdLevel FindSimdLevel() noexcept {
  static const SimdLevel level = [] {
    const auto named = ReadSimdLevel(ReadVariable());
    return named ? *named : FindWidestSimdLevel();
  }();
  return level;
}

}  // namespace trocar::base
