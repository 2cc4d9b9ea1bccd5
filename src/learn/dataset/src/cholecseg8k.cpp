// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "class_tables.h"
#include "layout_set.h"

namespace trocar::dataset {
namespace {

constexpr std::uint64_t kFramesPerFolder = 80;  // consecutive ones of the video, as published

class CholecSeg8kWriter : public VideoWriter {
 public:
  explicit CholecSeg8kWriter(const VideoTask& task)
      : name_(NameVideo("video", task.plan->first_seed + task.index)), folder_(task.folder / name_) {}

  base::Status Add(const Frame& frame, const simulation::Simulation& /*simulation*/) override {
    const std::uint64_t first = frame.number / kFramesPerFolder * kFramesPerFolder;
    const std::filesystem::path folder = folder_ / NameVideo((name_ + "_").c_str(), first, 5);
    const std::string stem = "frame_" + std::to_string(frame.number) + "_endo";
    render::Image watershed{frame.colour.width, frame.colour.height, {}}, colour = watershed;
    for (const std::uint16_t label : frame.geometry.labels) {
      const auto& entry = CholecSeg8kClasses()[static_cast<std::size_t>(ToCholecSeg8k(view::ClassOf(label)))];
      watershed.pixels.insert(watershed.pixels.end(), 3, entry.watershed);
      colour.pixels.insert(colour.pixels.end(), entry.colour.begin(), entry.colour.end());
    }
    if (auto s = render::WritePng(folder / (stem + ".png"), frame.colour); !s) return s;
    if (auto s = render::WritePng(folder / (stem + "_watershed_mask.png"), watershed); !s) return s;
    if (auto s = render::WritePng(folder / (stem + "_color_mask.png"), colour); !s) return s;
    return render::WritePng(folder / (stem + "_mask.png"), colour);
  }
  base::Status Finish() override { return {}; }

 private:
  std::string name_;
  std::filesystem::path folder_;
};

class CholecSeg8kSet : public LayoutSet {
 public:
  std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                          const simulation::Simulation& /*simulation*/) override {
    return std::make_unique<CholecSeg8kWriter>(task);
  }
  nlohmann::ordered_json Classes() const override {
    auto classes = nlohmann::ordered_json::array();
    for (const SegmentationClass& entry : CholecSeg8kClasses())
      classes.push_back(
          {{"id", entry.id}, {"name", entry.name}, {"watershed", entry.watershed}, {"colour", entry.colour}});
    return classes;
  }
  std::vector<std::string> Gaps() const override {
    return {"The annotation mask (_endo_mask.png) is the colour mask: nobody drew strokes.",
            "Hepatic Vein and Liver Ligament do not occur: no such thing is modelled.",
            "Scissors, clip applier, suction-irrigator, bag, trocars, clips, stones, bile and rinse have no "
            "class and are "
            "background; a dissector counts as Grasper.",
            "Bile ducts other than the cystic duct, and arteries, count as Connective Tissue.",
            "A film of blood on an organ keeps the organ's class."};
  }
};

}  // namespace

std::unique_ptr<LayoutSet> MakeCholecSeg8k() {
  return std::make_unique<CholecSeg8kSet>();
}

}  // namespace trocar::dataset
