// SPDX-License-Identifier: Apache-2.0
// store_writer URL FOLDER TRAINEE FIRST COUNT: spools attempts, says which are kept, and delivers them beside others.
#include <cstdio>
#include <cstdlib>

#include "trocar/base/state_hash.h"
#include "trocar/store/spool.h"

namespace {

trocar::store::Attempt MakeNumbered(int number, const char* trainee) {
  trocar::store::Attempt attempt;
  attempt.recording_id = trocar::base::HashText(static_cast<std::uint64_t>(number));
  attempt.started = "2026-11-24T22:50:20+01:00";
  attempt.trainee = trainee;
  attempt.task = "peg_transfer";
  attempt.is_completed = true;
  attempt.score = number;
  attempt.seconds = 60;
  attempt.metrics = {{"path_length", "left", "", 1.0 * number, ""}, {"path_length", "right", "", 2.0, ""}};
  return attempt;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace trocar::store;
  if (argc != 6) return 2;
  const Place place{argv[1], argv[2]};
  const Spool spool(place);
  std::optional<Store> store;
  std::optional<trocar::base::Error> failure;
  const int first = std::atoi(argv[4]), count = std::atoi(argv[5]);
  for (int i = first; i < first + count; ++i) {
    if (const auto kept = spool.Keep(MakeNumbered(i, argv[3])); !kept.ok()) {
      std::fprintf(stderr, "%s\n", kept.error().Text().c_str());
      return 1;
    }
    std::printf("kept %d\n", i);
    std::fflush(stdout);
    if (!store) {
      auto opened = Store::Open(place);
      if (opened.ok())
        store.emplace(std::move(*opened));
      else
        failure = opened.error();
    }
    if (store) failure = spool.Deliver(*store).failure;
    // a connection that was lost stays lost
    if (failure && failure->code == trocar::base::ErrorCode::kStoreAway) store.reset();
  }
  if (failure) std::printf("waiting %s\n", failure->Text().c_str());
  return 0;
}
