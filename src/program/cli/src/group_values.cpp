// SPDX-License-Identifier: Apache-2.0
#include "group_values.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "trocar/host/translate.h"
#include "trocar/store/attempts.h"

namespace trocar::cli {

base::Status CompareWithGroup(report::AttemptReport& report, StoreSession& session,
                              const std::string& group) {
  const auto ask = [&](const std::string& metric, const std::string& hand) {
    return ListGroupValues(session.store, session.viewer, group,
                           {report.facts.task_key, report.facts.level, metric, hand, "", ""});
  };
  constexpr auto kFewest = static_cast<std::size_t>(store::kFewestTrainees);
  report::GroupFacts facts;
  facts.name = group;
  const auto everyone = ask("seconds", "");
  if (!everyone.ok() && everyone.error().code != base::ErrorCode::kStoreRefused) return everyone.error();
  if (!everyone.ok()) {
    facts.why_not = everyone.error().message;
  } else if (everyone->size() < kFewest) {
    facts.why_not = host::TranslateWith(
        "only {1} of its people have completed this task at this level, and fewer than {2} would show whose "
        "values they are",
        {std::to_string(everyone->size()), std::to_string(kFewest)});
  } else {
    facts.people = everyone->size();
    for (report::MetricRow& row : report.metrics) {
      if (!row.phase.empty() || !row.tool.empty()) continue;
      auto values = ask(row.id, row.hand);
      // a trainee is refused where a metric has no meaning in most attempts
      if (!values.ok() && values.error().code == base::ErrorCode::kStoreRefused) continue;
      if (!values.ok()) return values.error();
      if (values->size() < kFewest) continue;
      row.group.clear();
      for (const double value : *values) row.group.push_back(row.scale * value);
      std::sort(row.group.begin(), row.group.end());
    }
  }
  report.group = std::move(facts);
  return {};
}

}  // namespace trocar::cli
