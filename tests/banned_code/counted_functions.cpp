// SPDX-License-Identifier: Apache-2.0
#include "counted_functions.h"

#include <cxxabi.h>
#include <dlfcn.h>
#include <execinfo.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>

namespace trocar::banned_code {
namespace {

std::atomic<CallTable*> current_table = nullptr;

void Count(const char* function, void* return_address) noexcept {
  if (CallTable* table = current_table.load(std::memory_order_acquire); table != nullptr)
    table->Add(function, return_address);
}

/// The C library's own.
template <typename Function>
Function* FindNext(const char* name) noexcept {
  void* found = dlsym(RTLD_NEXT, name);
  if (found == nullptr) std::abort();
  Function* function = nullptr;
  std::memcpy(&function, &found, sizeof(function));
  return function;
}

std::string Demangle(const char* name) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(abi::__cxa_demangle(name, nullptr, nullptr, &status),
                                                    std::free);
  return status == 0 ? text.get() : name;
}

/// "function at file:line" by the debug information, those that were inlined there first, or "".
std::string AskAddr2line(const char* file, std::uintptr_t offset) {
  char command[1200];
  std::snprintf(command, sizeof(command), "addr2line -sfCpie '%s' 0x%llx 2>/dev/null", file,
                static_cast<unsigned long long>(offset));
  std::string text;
  if (FILE* pipe = popen(command, "r"); pipe != nullptr) {
    char line[4000];
    while (std::fgets(line, sizeof(line), pipe) != nullptr) {
      std::string name = line;
      name = name.substr(0, name.find_last_not_of('\n') + 1);
      if (name.rfind("??", 0) == 0) break;
      if (const auto at = name.find(" at ??"); at != std::string::npos) name = name.substr(0, at);
      // without parameters: where it is says enough
      if (const auto bracket = name.find('('), place = name.rfind(" at ");
          bracket != std::string::npos && bracket > 1 && place != std::string::npos &&
          name.rfind(" (in", 0) != 0)
        name = name.substr(0, bracket) + name.substr(place);
      text += (text.empty() ? "" : ",") + name;
    }
    pclose(pipe);
  }
  return text;
}

std::string FindFrameName(void* address) {
  Dl_info info{};
  if (dladdr(address, &info) == 0 || info.dli_fname == nullptr) return "unknown code";
  const char* slash = std::strrchr(info.dli_fname, '/');
  const std::string file = slash != nullptr ? slash + 1 : info.dli_fname;
  const auto offset =
      reinterpret_cast<std::uintptr_t>(address) - reinterpret_cast<std::uintptr_t>(info.dli_fbase);
  // one byte back: a return address may already be the next line's
  std::string name = AskAddr2line(info.dli_fname, offset - 1);
  if (name.empty()) name = info.dli_sname != nullptr ? Demangle(info.dli_sname) : "unnamed code";
  constexpr std::size_t kMostLetters = 400;
  if (name.size() > kMostLetters) name = name.substr(0, kMostLetters) + "...";
  return file.find(".so") != std::string::npos ? name + " [" + file + "]" : name;
}

const std::string& NameFrame(void* address) {
  static std::map<void*, std::string> known;  // addr2line reads the whole program each time
  auto found = known.find(address);
  if (found == known.end()) found = known.emplace(address, FindFrameName(address)).first;
  return found->second;
}

}  // namespace

void CallTable::Add(const char* function, void* return_address) noexcept {
  const std::lock_guard lock(mutex_);
  ++calls_;
  Caller& caller = callers_[{function, return_address}];
  if (caller.calls++ > 0) return;
  constexpr int kOwnFrames = 8;  // at most, of what counts
  std::array<void*, kMostFrames + kOwnFrames> all{};
  const int depth = backtrace(all.data(), static_cast<int>(all.size()));
  const auto from = std::find(all.begin(), all.begin() + depth, return_address);
  for (auto frame = from; frame != all.begin() + depth && caller.frame_count < kMostFrames; ++frame)
    caller.frames[static_cast<std::size_t>(caller.frame_count++)] = *frame;
  // a frame that was inlined into its caller's is not in the list
  if (caller.frame_count == 0) caller.frames[static_cast<std::size_t>(caller.frame_count++)] = return_address;
}

std::string CallTable::Text() const {
  // several places of one line are one
  std::map<std::string, std::uint64_t> calls;
  for (const auto& [key, caller] : callers_) {
    std::string way;
    for (int i = 0; i < caller.frame_count; ++i) {
      const std::string& name = NameFrame(caller.frames[static_cast<std::size_t>(i)]);
      way += (i > 0 ? "    by " : "") + name + "\n";
      // what comes before a tick is always the same
      if (name.find("simulation::Simulation::Step") != std::string::npos) break;
    }
    calls[std::string(key.first) + ", from " + way] += caller.calls;
  }
  std::string text;
  for (const auto& [way, count] : calls) text += std::to_string(count) + " times " + way;
  return text;
}

Counting::Counting(CallTable& table) noexcept {
  std::array<void*, 2> frames{};
  (void)backtrace(frames.data(), static_cast<int>(frames.size()));  // its first call loads a library
  current_table.store(&table, std::memory_order_release);
}

Counting::~Counting() {
  current_table.store(nullptr, std::memory_order_release);
}

}  // namespace trocar::banned_code

#define TROCAR_EXPORTED extern "C" __attribute__((visibility("default"), noinline))
#define TROCAR_COUNT(name, Type)                                        \
  static auto* const next = trocar::banned_code::FindNext<Type>(#name); \
  trocar::banned_code::Count(#name, __builtin_extract_return_addr(__builtin_return_address(0)))
#define TROCAR_COUNT_OF_ONE(name, Number)          \
  TROCAR_EXPORTED Number name(Number x) noexcept { \
    TROCAR_COUNT(name, Number(Number));            \
    return next(x);                                \
  }
#define TROCAR_COUNT_OF_TWO(name, Number)                    \
  TROCAR_EXPORTED Number name(Number x, Number y) noexcept { \
    TROCAR_COUNT(name, Number(Number, Number));              \
    return next(x, y);                                       \
  }
#define TROCAR_COUNT_SINCOS(name, Number)                              \
  TROCAR_EXPORTED void name(Number x, Number* s, Number* c) noexcept { \
    TROCAR_COUNT(name, void(Number, Number*, Number*));                \
    next(x, s, c);                                                     \
  }
// double, float and long double
#define TROCAR_COUNT_EACH_OF_ONE(name) \
  TROCAR_COUNT_OF_ONE(name, double)    \
  TROCAR_COUNT_OF_ONE(name##f, float) TROCAR_COUNT_OF_ONE(name##l, long double)
#define TROCAR_COUNT_EACH_OF_TWO(name) \
  TROCAR_COUNT_OF_TWO(name, double)    \
  TROCAR_COUNT_OF_TWO(name##f, float) TROCAR_COUNT_OF_TWO(name##l, long double)

TROCAR_COUNT_EACH_OF_ONE(sin)
TROCAR_COUNT_EACH_OF_ONE(cos)
TROCAR_COUNT_EACH_OF_ONE(tan)
TROCAR_COUNT_EACH_OF_ONE(asin)
TROCAR_COUNT_EACH_OF_ONE(acos)
TROCAR_COUNT_EACH_OF_ONE(atan)
TROCAR_COUNT_EACH_OF_ONE(sinh)
TROCAR_COUNT_EACH_OF_ONE(cosh)
TROCAR_COUNT_EACH_OF_ONE(tanh)
TROCAR_COUNT_EACH_OF_ONE(asinh)
TROCAR_COUNT_EACH_OF_ONE(acosh)
TROCAR_COUNT_EACH_OF_ONE(atanh)
TROCAR_COUNT_EACH_OF_ONE(exp)
TROCAR_COUNT_EACH_OF_ONE(exp2)
TROCAR_COUNT_EACH_OF_ONE(exp10)
TROCAR_COUNT_EACH_OF_ONE(expm1)
TROCAR_COUNT_EACH_OF_ONE(log)
TROCAR_COUNT_EACH_OF_ONE(log1p)
TROCAR_COUNT_EACH_OF_ONE(log2)
TROCAR_COUNT_EACH_OF_ONE(log10)
TROCAR_COUNT_EACH_OF_ONE(cbrt)
TROCAR_COUNT_EACH_OF_ONE(erf)
TROCAR_COUNT_EACH_OF_ONE(erfc)
TROCAR_COUNT_EACH_OF_ONE(lgamma)
TROCAR_COUNT_EACH_OF_ONE(tgamma)
TROCAR_COUNT_EACH_OF_TWO(atan2)
TROCAR_COUNT_EACH_OF_TWO(pow)
TROCAR_COUNT_EACH_OF_TWO(hypot)
TROCAR_COUNT_SINCOS(sincos, double)
TROCAR_COUNT_SINCOS(sincosf, float)
TROCAR_COUNT_SINCOS(sincosl, long double)
