// SPDX-License-Identifier: Apache-2.0
#include "postgres_part.h"

#include <dlfcn.h>

#include <system_error>

#include "trocar/host/program.h"

namespace trocar::store {
namespace {

constexpr const char* kFile = "trocar-postgres.so";

}  // namespace

OpenedDatabase OpenPostgresBy(const std::filesystem::path& part, const std::string& url, double busy_seconds,
                              double answer_seconds) {
  std::error_code failure;
  if (!std::filesystem::exists(part, failure)) {
    return base::Error{base::ErrorCode::kFileMissing,
                       std::string(kFile) +
                           ", which speaks with PostgreSQL, is not beside this program: build it (ninja "
                           "trocar-postgres in the build folder), or install Trocar again"};
  }
  // for as long as the program lives: its connections are code of this file
  void* const library = ::dlopen(part.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const entry = library == nullptr ? nullptr : ::dlsym(library, kPostgresEntry);
  if (entry == nullptr) {
    const char* const why = ::dlerror();
    return base::Error{base::ErrorCode::kFileUnreadable,
                       std::string(kFile) + " cannot be loaded: " + (why == nullptr ? "" : why) +
                           "; build it again (ninja trocar-postgres)"};
  }
  OpenedDatabase opened = base::Error{base::ErrorCode::kStoreAway, ""};
  reinterpret_cast<PostgresEntry*>(entry)(url, busy_seconds, answer_seconds, opened);
  return opened;
}

OpenedDatabase OpenPostgres(const std::string& url, double busy_seconds, double answer_seconds) {
  return OpenPostgresBy(host::FindCompanionProgram(kFile), url, busy_seconds, answer_seconds);
}

}  // namespace trocar::store
