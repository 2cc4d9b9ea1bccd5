// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>

#include "class_tables.h"
#include "files.h"
#include "layout_set.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::dataset {
namespace {

using nlohmann::ordered_json;

// of the published set [frames at 25 a second]
constexpr std::uint64_t kJudgedEvery = 125;     // between two frames with the critical view: 5 s
constexpr std::uint64_t kSegmentedEvery = 750;  // of the folders *_seg: 30 s
constexpr std::uint64_t kImageIds = 1'000'000;  // of one video

constexpr const char* kSplits[] = {"train", "val", "test"};
/// One of five for choosing, one for testing.
std::size_t SplitOf(std::uint64_t seed) {
  return seed % 5 == 3 ? 1 : seed % 5 == 4 ? 2 : 0;
}

/// Of one video.
struct Annotations {
  ordered_json images = ordered_json::array(), annotations = ordered_json::array();
  std::vector<std::size_t> segmented;  // images in the folders *_seg
  std::string rows;                    // of all_metadata.csv
};

ordered_json MakeEndoscapesCategories() {
  auto categories = ordered_json::array();
  for (const SegmentationClass& entry : EndoscapesClasses().subspan(1))
    categories.push_back(
        {{"id", entry.id}, {"name", entry.name}, {"supercategory", entry.id == 6 ? "tool" : "anatomy"}});
  return categories;
}

/// True for the first frame at or after each multiple of a number of frames.
class Cadence {
 public:
  explicit Cadence(std::uint64_t every) : every_(every) {}
  bool Beats(std::uint64_t number) {
    if (number < next_) return false;
    next_ = (number / every_ + 1) * every_;
    return true;
  }

 private:
  std::uint64_t every_, next_ = 0;
};

class EndoscapesWriter : public VideoWriter {
 public:
  EndoscapesWriter(const VideoTask& task, Annotations& out)
      : seed_(task.plan->first_seed + task.index),
        split_(kSplits[SplitOf(seed_)]),
        folder_(task.folder),
        annotations_(&out) {}

  base::Status Add(const Frame& frame, const simulation::Simulation& simulation) override {
    const simulation::OperationSnapshot& operation = simulation.GetSnapshot().operation;
    // the published frames end where the first clip is set
    if (operation.clip_count > 0) return {};
    const std::string stem = std::to_string(seed_) + "_" + std::to_string(frame.number);
    const std::uint64_t image_id = seed_ * kImageIds + frame.number;
    const std::array<double, 3> ds = EndoscapesCriteria(operation.procedure.view);
    const bool is_judged = judged_.Beats(frame.number), is_segmented = segmented_.Beats(frame.number);
    if (is_segmented) annotations_->segmented.push_back(annotations_->images.size());
    annotations_->images.push_back({{"id", image_id},
                                    {"file_name", stem + ".jpg"},
                                    {"width", frame.colour.width},
                                    {"height", frame.colour.height},
                                    {"video_id", seed_},
                                    {"frame_id", frame.index},
                                    {"is_det_keyframe", true},  // each has its boxes
                                    {"is_ds_keyframe", is_judged},
                                    {"ds", ds}});
    AddRow(frame.number, stem, ds, is_judged);
    std::vector<std::uint8_t> semantic;
    for (const std::uint16_t label : frame.geometry.labels)
      semantic.push_back(static_cast<std::uint8_t>(ToEndoscapes(view::ClassOf(label))));
    if (auto s = AddInstances(frame, stem, image_id); !s) return s;
    if (auto s = WriteEqualChannelsPng(folder_ / "semseg" / (stem + ".png"), frame.colour.width,
                                       frame.colour.height, semantic);
        !s)
      return s;
    const std::filesystem::path picture = folder_ / split_ / (stem + ".jpg");
    if (auto s = WriteJpeg(picture, frame.colour); !s || !is_segmented) return s;
    return LinkFile(picture, folder_ / (split_ + "_seg") / (stem + ".jpg"));
  }
  base::Status Finish() override { return {}; }

 private:
  /// Of all_metadata.csv.
  void AddRow(std::uint64_t number, const std::string& stem, const std::array<double, 3>& ds,
              bool is_judged) {
    const auto list = ordered_json(ds);
    std::string& rows = annotations_->rows;
    rows += std::to_string(seed_) + "," + std::to_string(number) + ",\"" + host::FormatJson(list) + "\"";
    for (const auto& criterion : list) rows += "," + host::FormatJson(criterion);
    rows += is_judged ? ",True" : ",False";
    // nobody has annotated it
    rows += ",,,,insseg/" + stem + ".npy,insseg/" + stem + ".csv\n";
  }

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
  std::string split_;
  std::filesystem::path folder_;
  Annotations* annotations_;
  Cadence judged_{kJudgedEvery}, segmented_{kSegmentedEvery};
};

class EndoscapesSet : public LayoutSet {
 public:
  std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                          const simulation::Simulation& /*simulation*/) override {
    const std::scoped_lock lock(mutex_);
    return std::make_unique<EndoscapesWriter>(task, videos_[task.plan->first_seed + task.index]);
  }

  base::Status Finish(const std::filesystem::path& folder) override {
    std::string labels;
    for (const SegmentationClass& entry : EndoscapesClasses()) labels += std::string(entry.name) + "\n";
    if (auto s = host::WriteFile(folder / "seg_label_map.txt", labels); !s) return s;
    std::string rows =
        "vid,frame,avg_cvs,C1,C2,C3,is_ds_keyframe,cvs_annotator_1,cvs_annotator_2,cvs_annotator_3,mask_path,"
        "label_path\n";
    for (const auto& [seed, video] : videos_) rows += video.rows;
    if (auto s = host::WriteFile(folder / "all_metadata.csv", rows); !s) return s;
    for (std::size_t split = 0; split < std::size(kSplits); ++split) {
      if (auto s = WriteSplit(folder, split); !s) return s;
    }
    return {};
  }
  ordered_json Classes() const override { return MakeEndoscapesCategories(); }
  std::vector<std::string> Gaps() const override {
    return {
        "cystic_plate does not occur: the bed is part of the liver's surface and has no label of its own.",
        "calot_triangle is the fat that fills the hepatocystic triangle, as much of it as is left.",
        "The three criteria are computed (docs/operation.md) for every frame, 0, 0.5 or 1 each, not the mean "
        "of "
        "three raters: the columns of annotators are empty.",
        "Every frame has boxes and masks and is a key frame of detection; is_ds_keyframe is true every 5 s, "
        "and "
        "train_seg, val_seg and test_seg hold a frame of each video every 30 s.",
        "The subsets 12_5 and 25 and the folder all are left out.",
        "Segmentations are run lengths, not polygons. Videos go to train, val and test by their seeds: seed "
        "mod 5 is 3 "
        "for val, 4 for test."};
  }

 private:
  /// An empty document of COCO.
  static ordered_json MakeDocument() {
    return {{"info", {{"description", "made by Trocar in the layout of Endoscapes"}}},
            {"images", ordered_json::array()},
            {"annotations", ordered_json::array()},
            {"categories", MakeEndoscapesCategories()}};
  }

  base::Status WriteSplit(const std::filesystem::path& folder, std::size_t split) const {
    const std::string name = kSplits[split];
    ordered_json all = MakeDocument(), judged = all, segmented = all;
    auto videos = ordered_json::array();
    std::string seeds;
    for (const auto& [seed, video] : videos_) {
      if (SplitOf(seed) != split) continue;
      videos.push_back({{"id", seed}, {"name", std::to_string(seed)}});
      seeds += std::to_string(seed) + "\n";
      std::set<std::uint64_t> judged_ids, segmented_ids;
      for (std::size_t i = 0; i < video.images.size(); ++i) {
        const ordered_json& image = video.images[i];
        all["images"].push_back(image);
        if (image["is_ds_keyframe"].get<bool>()) {
          judged["images"].push_back(image);
          judged_ids.insert(image["id"].get<std::uint64_t>());
        }
        if (std::binary_search(video.segmented.begin(), video.segmented.end(), i)) {
          segmented["images"].push_back(image);
          segmented_ids.insert(image["id"].get<std::uint64_t>());
        }
      }
      for (const ordered_json& annotation : video.annotations) {
        const auto id = annotation["image_id"].get<std::uint64_t>();
        all["annotations"].push_back(annotation);
        if (judged_ids.count(id) > 0) judged["annotations"].push_back(annotation);
        if (segmented_ids.count(id) > 0) segmented["annotations"].push_back(annotation);
      }
    }
    for (const char* kind : {"", "_seg"}) {
      if (auto s = host::WriteFile(folder / (name + kind + "_vids.txt"), seeds); !s) return s;
    }
    if (videos.empty()) return {};
    const auto write = [&](const std::string& file, const ordered_json& content) {
      return host::WriteFile(folder / file, host::FormatJson(content) + "\n");
    };
    if (auto s = write(name + "/annotation_coco.json", all); !s) return s;
    if (auto s = write(name + "/annotation_ds_coco.json", judged); !s) return s;
    if (auto s = write(name + "_seg/annotation_coco.json", segmented); !s) return s;
    all["videos"] = videos;
    return write(name + "/annotation_coco_vid.json", all);
  }

  std::mutex mutex_;
  std::map<std::uint64_t, Annotations> videos_;  // by seed; nodes keep their place
};

}  // namespace

std::unique_ptr<LayoutSet> MakeEndoscapes() {
  return std::make_unique<EndoscapesSet>();
}

}  // namespace trocar::dataset
