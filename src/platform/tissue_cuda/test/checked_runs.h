// SPDX-License-Identifier: Apache-2.0
/// \file checked_runs.h  Whole solves on the host executor, with everything checked that it can check.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bind_arguments.h"
#include "block_executor.h"
#include "kernels/tiled_chebyshev.h"

namespace trocar::tissue_cuda {

/// What the executor found wrong, for a failure message.
inline std::string Complaints(const Watch& watch) {
  std::string text = std::to_string(watch.error_count) + " errors";
  for (const std::string& error : watch.errors) text += "\n  " + error;
  return text;
}

template <typename Real>
bool RunPaperStep(Layout layout, const PaperArgs<Real, CheckedMemory>& args, std::uint32_t blocks,
                  const ExecutorOptions& options, Watch& watch) {
  switch (layout) {
    case Layout::kPaperGlobal:
      return RunChecked<PaperGlobal<Real, CheckedMemory, false>>(args, blocks, kPaperThreads, options, watch);
    case Layout::kPaperCoalesced:
      return RunChecked<PaperGlobal<Real, CheckedMemory, true>>(args, blocks, kPaperThreads, options, watch);
    case Layout::kPaperShared:
      return RunChecked<PaperShared<Real, CheckedMemory, false>>(args, blocks, kPaperThreads, options, watch);
    default:
      return RunChecked<PaperShared<Real, CheckedMemory, true>>(args, blocks, kPaperThreads, options, watch);
  }
}

/// `steps` steps of a paper layout; the state takes the result.
template <typename Real>
void RunPaper(Layout layout, const tissue::TissueModel& model, const tissue::TissueLoad& load, double alpha,
              int steps, const ExecutorOptions& options, Watch& watch, tissue::TissueState& state) {
  const base::Result<PaperArrays<Real>> arrays = MakePaperArrays<Real>(model, layout);
  ASSERT_TRUE(arrays) << arrays.error().Text();
  std::vector<Real> positions, forces;
  FillPoints(*arrays, model, state, load, positions, forces);
  CheckedHeap heap(watch);
  PaperArgs<Real, CheckedMemory> args = BindPaperArrays(*arrays, heap);
  SetPaperLoad(load, alpha, args);
  args.positions = heap.Filled("positions", positions);
  args.next_positions = heap.template Array<Real>("next_positions", positions.size());
  args.external_force = heap.Filled("external_force", forces);
  for (int step = 0; step < steps; ++step) {
    ASSERT_TRUE(RunPaperStep(layout, args, CountPaperBlocks(*arrays), options, watch));
    std::swap(args.positions, args.next_positions);
  }
  ReadPoints(*arrays, args.positions.contents->values, state);
}

/// One whole solve in our layout.
template <template <typename, typename> class Kernel, typename Real>
TiledReport RunTiled(const tissue::TissueModel& model, const GpuSettings& settings,
                     const tissue::TissueLoad& load, std::uint32_t blocks, double max_step,
                     const ExecutorOptions& options, Watch& watch, tissue::TissueState& state) {
  const base::Result<TiledArrays<Real>> arrays = MakeTiledArrays<Real>(model);
  if (!arrays) {
    ADD_FAILURE() << arrays.error().Text();
    return {};
  }
  CheckedHeap heap(watch);
  TiledArgs<Real, CheckedMemory> args = BindTiledArrays(*arrays, heap);
  SetTiledLoad(settings, load, args);
  args.settings.max_step = static_cast<Real>(max_step);
  std::vector<Triple<double>> positions, forces;
  std::vector<std::uint8_t> prescribed;
  for (std::size_t i = 0; i < model.Size(); ++i) {
    positions.push_back({state.position[i].x, state.position[i].y, state.position[i].z});
    prescribed.push_back(state.condition[i] == tissue::NodeCondition::kPrescribed ? 1 : 0);
    if (load.external_force.empty()) continue;
    forces.push_back({load.external_force[i].x, load.external_force[i].y, load.external_force[i].z});
  }
  args.positions = heap.Filled("positions", positions);
  args.prescribed = heap.Filled("prescribed", prescribed);
  args.external_force = heap.Filled("external_force", forces);
  args.intact = heap.Filled("intact", state.strand_is_intact);
  TiledContacts contacts;
  FillContacts(arrays->renumbered, model, load.contacts, contacts);
  args.touched = static_cast<std::uint32_t>(contacts.touched_nodes.size());
  args.contacts = heap.Filled("contacts", contacts.contacts);
  args.touched_nodes = heap.Filled("touched_nodes", contacts.touched_nodes);
  args.touch_starts = heap.Filled("touch_starts", contacts.touch_starts);
  args.touch_entries = heap.Filled("touch_entries", contacts.touch_entries);
  EXPECT_TRUE((RunChecked<Kernel<Real, CheckedMemory>>(args, blocks, kTileNodes, options, watch)));
  for (std::size_t i = 0; i < model.Size(); ++i) {
    const Triple<double>& p = args.positions.contents->values[i];
    state.position[i] = {p.x, p.y, p.z};
  }
  return args.report.contents->values[0];
}

}  // namespace trocar::tissue_cuda
