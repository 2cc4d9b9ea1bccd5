// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "class_tables.h"
#include "files.h"
#include "layout_set.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::dataset {
namespace {

using nlohmann::ordered_json;

constexpr std::uint64_t kJudgedEvery = 125;     // frames: 5 s
constexpr std::uint64_t kImageIds = 1'000'000;  // of one video

/// One of five for choosing, one for testing.
const char* SplitOf(std::uint64_t seed) {
  return seed % 5 == 3 ? "val" : seed % 5 == 4 ? "test" : "train";
}

struct Annotations {
  ordered_json images = ordered_json::array(), annotations = ordered_json::array();
};

ordered_json MakeEndoscapesCategories() {
  auto categories = ordered_json::array();
  for (const SegmentationClass& entry : EndoscapesClasses().subspan(1))
    categories.push_back(
        {{"id", entry.id}, {"name", entry.name}, {"supercategory", entry.id == 6 ? "tool" : "anatomy"}});
  return categories;
}

class EndoscapesWriter : public VideoWriter {
 public:
  EndoscapesWriter(const VideoTask& task, Annotations& out)
      : seed_(task.plan->first_seed + task.index),
        split_(SplitOf(seed_)),
        folder_(task.folder),
        annotations_(&out) {}

  base::Status Add(const Frame& frame, const simulation::Simulation& simulation) override {
    const simulation::OperationSnapshot& operation = simulation.GetSnapshot().operation;
    // the published frames end where the first clip is set
    if (operation.clip_count > 0) return {};
    const std::string stem = std::to_string(seed_) + "_" + std::to_string(frame.number);
    const scene::ViewScore& view = operation.procedure.view;
    const std::uint64_t image_id = seed_ * kImageIds + frame.number;
    annotations_->images.push_back(
        {{"id", image_id},
         {"file_name", stem + ".jpg"},
         {"width", frame.colour.width},
         {"height", frame.colour.height},
         {"video_id", seed_},
         {"frame_id", frame.index},
         {"is_ds_keyframe", frame.number % kJudgedEvery == 0},
         {"ds", {0.5 * view.Points(2), 0.5 * view.Points(1), 0.5 * view.Points(0)}}});
    std::vector<std::uint8_t> semantic;
    for (const std::uint16_t label : frame.geometry.labels)
      semantic.push_back(static_cast<std::uint8_t>(ToEndoscapes(view::ClassOf(label))));
    if (auto s = AddInstances(frame, stem, image_id); !s) return s;
    if (auto s = WriteGreyPng(folder_ / "semseg" / (stem + ".png"), frame.colour.width, frame.colour.height,
                              semantic);
        !s)
      return s;
    return WriteJpeg(folder_ / split_ / (stem + ".jpg"), frame.colour);
  }
  base::Status Finish() override { return {}; }

 private:
  base::Status AddInstances(const Frame& frame, const std::string& stem, std::uint64_t image_id) {
    // tools are told apart, of anatomy there is one of each
    std::map<std::uint16_t, int> instances;
    for (const std::uint16_t label : frame.geometry.labels) {
      const int id = ToEndoscapes(view::ClassOf(label));
      if (id != 0) instances.emplace(label, id);
    }
    std::vector<std::uint8_t> stack;
    std::string labels;
    std::uint64_t annotation_id = image_id * 64;
    for (const auto& [label, id] : instances) {
      const auto is_it = [wanted = label](std::uint16_t pixel) { return pixel == wanted; };
      const std::vector<std::uint8_t> mask = MakeMask(frame.geometry, is_it);
      const Box box = *FindBox(frame.geometry, is_it);
      annotations_->annotations.push_back(
          {{"id", annotation_id++},
           {"image_id", image_id},
           {"category_id", id},
           {"bbox", {box.x, box.y, box.width, box.height}},
           {"area", std::count(mask.begin(), mask.end(), 1)},
           {"iscrowd", 0},
           {"segmentation",
            {{"size", {frame.colour.height, frame.colour.width}},
             {"counts", CountRuns(mask, frame.colour.width, frame.colour.height)}}}});
      stack.insert(stack.end(), mask.begin(), mask.end());
      labels += std::to_string(id) + "\n";
    }
    const std::vector<std::size_t> shape = {instances.size(), static_cast<std::size_t>(frame.colour.height),
                                            static_cast<std::size_t>(frame.colour.width)};
    if (auto s = WriteNpy(folder_ / "insseg" / (stem + ".npy"), shape, stack); !s) return s;
    return host::WriteFile(folder_ / "insseg" / (stem + ".csv"), labels);
  }

  std::uint64_t seed_;
  const char* split_;
  std::filesystem::path folder_;
  Annotations* annotations_;
};

class EndoscapesSet : public LayoutSet {
 public:
  std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                          const simulation::Simulation& /*simulation*/) override {
    const std::scoped_lock lock(mutex_);
    return std::make_unique<EndoscapesWriter>(task, videos_[task.plan->first_seed + task.index]);
  }

  base::Status Finish(const std::filesystem::path& folder) override {
    for (const char* split : {"train", "val", "test"}) {
      ordered_json coco = {{"info", {{"description", "made by Trocar in the layout of Endoscapes"}}},
                           {"images", ordered_json::array()},
                           {"annotations", ordered_json::array()},
                           {"categories", MakeEndoscapesCategories()}};
      auto videos = ordered_json::array();
      ordered_json judged = coco;
      for (const auto& [seed, video] : videos_) {
        if (std::string(SplitOf(seed)) != split) continue;
        videos.push_back({{"id", seed}, {"name", std::to_string(seed)}});
        for (const auto& image : video.images) {
          coco["images"].push_back(image);
          if (image["is_ds_keyframe"].get<bool>()) judged["images"].push_back(image);
        }
        for (const auto& annotation : video.annotations) coco["annotations"].push_back(annotation);
      }
      if (videos.empty()) continue;
      const auto write = [&](const char* name, const ordered_json& content) {
        return host::WriteFile(folder / split / name, host::FormatJson(content) + "\n");
      };
      if (auto s = write("annotation_coco.json", coco); !s) return s;
      if (auto s = write("annotation_ds_coco.json", judged); !s) return s;
      coco["videos"] = videos;
      if (auto s = write("annotation_coco_vid.json", coco); !s) return s;
    }
    return {};
  }
  ordered_json Classes() const override { return MakeEndoscapesCategories(); }
  std::vector<std::string> Gaps() const override {
    return {
        "cystic_plate does not occur: the bed is part of the liver's surface and has no label of its own.",
        "calot_triangle is the fat that fills the hepatocystic triangle, as much of it as is left.",
        "The three criteria are computed (docs/operation.md), 0, 0.5 or 1 each, not the mean of three "
        "raters.",
        "Segmentations are run lengths, not polygons. Videos go to train, val and test by their seeds: seed "
        "mod 5 is 3 "
        "for val, 4 for test."};
  }

 private:
  std::mutex mutex_;
  std::map<std::uint64_t, Annotations> videos_;  // by seed; nodes keep their place
};

}  // namespace

std::unique_ptr<LayoutSet> MakeEndoscapes() {
  return std::make_unique<EndoscapesSet>();
}

}  // namespace trocar::dataset
