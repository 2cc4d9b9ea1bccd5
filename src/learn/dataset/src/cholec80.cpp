// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>

#include "class_tables.h"
#include "layout_set.h"
#include "trocar/cholecystectomy/hand_acts.h"
#include "trocar/host/safe_file.h"

namespace trocar::dataset {
namespace {

using cholecystectomy::InstrumentKind;

constexpr std::array<const char*, static_cast<std::size_t>(InstrumentKind::kCount)> kCholec80Tools = {
    "Grasper", "Bipolar", "Hook", "Scissors", "Clipper", "Irrigator", "SpecimenBag"};

class Cholec80Writer : public VideoWriter {
 public:
  Cholec80Writer(const VideoTask& task, double begin)
      : name_(NameVideo("video", task.plan->first_seed + task.index)), folder_(task.folder), begin_(begin) {
    tools_ = "Frame";
    for (const char* tool : kCholec80Tools) tools_ += std::string("\t") + tool;
    tools_ += "\n";
  }

  void Look(const simulation::Simulation& simulation, const scene::Input& /*input*/) override {
    const simulation::Snapshot& now = simulation.GetSnapshot();
    for (; static_cast<double>(frames_) <= kFramesPerSecond * (now.time - begin_) + 1e-6; ++frames_)
      phases_ += std::to_string(frames_) + "\t" +
                 std::string(cholecystectomy::NameOf(
                     static_cast<cholecystectomy::Phase>(now.operation.procedure.phase))) +
                 "\n";
  }

  base::Status Add(const Frame& frame, const simulation::Simulation& /*simulation*/) override {
    // a picture has a million labels
    static const auto tool_of = [] {
      std::array<std::optional<instrument::ToolKind>, view::kLabelClassCount> tools;
      for (std::size_t i = 0; i < tools.size(); ++i)
        tools[i] = view::ToolOf(static_cast<view::LabelClass>(i));
      return tools;
    }();
    std::array<bool, kCholec80Tools.size()> is_there{};
    for (const std::uint16_t label : frame.geometry.labels) {
      const auto kind = tool_of[static_cast<std::size_t>(view::ClassOf(label))];
      if (kind) is_there[static_cast<std::size_t>(cholecystectomy::InstrumentOf(*kind))] = true;
    }
    tools_ += std::to_string(frame.number);
    for (const bool there : is_there) tools_ += there ? "\t1" : "\t0";
    tools_ += "\n";
    return render::WritePng(folder_ / "frames" / name_ / (NameVideo("", frame.number, 6) + ".png"),
                            frame.colour);
  }

  base::Status Finish() override {
    if (auto s = host::WriteFile(folder_ / "phase_annotations" / (name_ + "-phase.txt"), phases_); !s)
      return s;
    return host::WriteFile(folder_ / "tool_annotations" / (name_ + "-tool.txt"), tools_);
  }

 private:
  std::string name_;
  std::filesystem::path folder_;
  double begin_;  // of the video [s]
  std::string phases_ = "Frame\tPhase\n", tools_;
  std::uint64_t frames_ = 0;
};

class Cholec80Set : public LayoutSet {
 public:
  std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                          const simulation::Simulation& simulation) override {
    return std::make_unique<Cholec80Writer>(task, simulation.GetSnapshot().time);
  }
  nlohmann::ordered_json Classes() const override {
    nlohmann::ordered_json classes = {{"phases", nlohmann::ordered_json::array()}, {"tools", kCholec80Tools}};
    for (int i = 0; i < cholecystectomy::kPhaseCount; ++i)
      classes["phases"].push_back(cholecystectomy::NameOf(static_cast<cholecystectomy::Phase>(i)));
    return classes;
  }
  std::vector<std::string> Gaps() const override {
    return {
        "There are no videos: frames/videoNN/NUMBER.png holds the frame of each second, by its number at 25 "
        "frames a "
        "second, as loaders cut them out of the videos.",
        "Bipolar is the dissector, which carries current between its jaws.",
        "A tool is present where at least one of its pixels is in the picture; the published rule asks for "
        "its tip."};
  }
};

}  // namespace

std::unique_ptr<LayoutSet> MakeCholec80() {
  return std::make_unique<Cholec80Set>();
}

}  // namespace trocar::dataset
