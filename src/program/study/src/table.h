// SPDX-License-Identifier: Apache-2.0
/// \file table.h  Results of a study: one table, as CSV, SQLite and HDF5, and a page with plots.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "trocar/study/study.h"

namespace trocar::study {

/// A run that is done.
struct Row {
  Run run;
  RunResult result;
};

/// \return kFileUnwritable
base::Status WriteCsv(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows);
/// Table `runs`, one row a run; made anew.
base::Status WriteSqlite(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows);
/// A data set for each column, of texts or of doubles; made anew.
base::Status WriteHdf5(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows);
/// The page, and each of its plots as a picture in plots/ beside it.
base::Status WriteReport(const std::filesystem::path& path, const StudyPlan& plan, std::span<const Row> rows,
                         const StudySummary& summary);

}  // namespace trocar::study
