// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "class_tables.h"
#include "files.h"
#include "layout_set.h"
#include "trocar/host/json_text.h"
#include "trocar/host/safe_file.h"

namespace trocar::dataset {
namespace {

using cholecystectomy::InstrumentKind;
using cholecystectomy::Target;
using cholecystectomy::Triplet;
using cholecystectomy::Verb;
using nlohmann::ordered_json;

constexpr int kInstruments = 6, kVerbs = 10, kTargets = 15;

/// Id, score and box: relative to the picture; -1 where it is not seen.
void AppendBox(ordered_json& instance, int id, const std::optional<Box>& box, const Frame& frame) {
  instance.push_back(id);
  instance.push_back(1);
  if (!box) {
    for (int i = 0; i < 4; ++i) instance.push_back(-1);
    return;
  }
  const double w = frame.colour.width, h = frame.colour.height;
  for (const double side : {box->x / w, box->y / h, box->width / w, box->height / h})
    instance.push_back(side);
}

std::optional<Box> FindTarget(const Frame& frame, Target target) {
  const auto find = [&](view::LabelClass label) {
    return FindBox(frame.geometry, [label](std::uint16_t pixel) { return view::ClassOf(pixel) == label; });
  };
  switch (target) {
    case Target::kGallbladder:
      return find(view::LabelClass::kGallbladder);
    case Target::kLiver:
      return find(view::LabelClass::kLiver);
    case Target::kCysticDuct:
      return find(view::LabelClass::kCysticDuct);
    case Target::kCysticArtery:
      return find(view::LabelClass::kCysticArtery);
    case Target::kFluid:
      return find(view::LabelClass::kBlood);
    default:
      return std::nullopt;
  }
}

ordered_json MakeCholecT50Categories() {
  ordered_json categories = {{"triplet", ordered_json::object()},
                             {"instrument", ordered_json::object()},
                             {"verb", ordered_json::object()},
                             {"target", ordered_json::object()},
                             {"phase", ordered_json::object()}};
  for (std::size_t i = 0; i < CholecT50Triplets().size(); ++i)
    categories["triplet"][std::to_string(i)] = cholecystectomy::NameOf(CholecT50Triplets()[i]);
  for (int i = 0; i < kInstruments; ++i)
    categories["instrument"][std::to_string(i)] = cholecystectomy::NameOf(static_cast<InstrumentKind>(i));
  for (int i = 0; i < kVerbs; ++i)
    categories["verb"][std::to_string(i)] = cholecystectomy::NameOf(static_cast<Verb>(i));
  for (int i = 0; i < kTargets; ++i)
    categories["target"][std::to_string(i)] = cholecystectomy::NameOf(static_cast<Target>(i));
  for (int i = 0; i < cholecystectomy::kPhaseCount; ++i)
    categories["phase"][std::to_string(i)] = CholecT50Name(static_cast<cholecystectomy::Phase>(i));
  return categories;
}

class CholecT50Writer : public VideoWriter {
 public:
  explicit CholecT50Writer(const VideoTask& task)
      : name_(NameVideo("VID", task.plan->first_seed + task.index)), folder_(task.folder) {
    label_ = {{"video", task.plan->first_seed + task.index},
              {"fps", 1},
              {"num_frames", 0},
              {"categories", MakeCholecT50Categories()},
              {"annotations", ordered_json::object()},
              {"info",
               {{"name", "made by Trocar in the layout of CholecT50"},
                {"bbox_format", "x, y, width, height as shares of the picture"}}},
              {"licenses", {{{"id", 1}, {"name", "Apache-2.0"}}}}};
  }

  base::Status Add(const Frame& frame, const simulation::Simulation& simulation) override {
    const int phase = simulation.GetSnapshot().operation.procedure.phase;
    auto instances = ordered_json::array();
    for (const Act& act : frame.acts) {
      const std::uint16_t tool = view::MakeLabel(act.tool, act.hand);
      ordered_json instance = {FindCholecT50Triplet(act.triplet)};
      AppendBox(instance, static_cast<int>(act.triplet.instrument),
                FindBox(frame.geometry, [tool](std::uint16_t label) { return label == tool; }), frame);
      instance.push_back(static_cast<int>(act.triplet.verb));
      AppendBox(instance, static_cast<int>(act.triplet.target), FindTarget(frame, act.triplet.target), frame);
      instance.push_back(phase);
      instances.push_back(std::move(instance));
    }
    if (instances.empty()) {
      instances.push_back(std::vector<int>(14, -1));
      instances.back().push_back(phase);
    }
    label_["annotations"][std::to_string(frame.index)] = std::move(instances);
    label_["num_frames"] = frame.index + 1;
    return render::WritePng(folder_ / "videos" / name_ / (NameVideo("", frame.index, 6) + ".png"),
                            frame.colour);
  }

  base::Status Finish() override {
    return host::WriteFile(folder_ / "labels" / (name_ + ".json"), host::FormatJson(label_) + "\n");
  }

 private:
  std::string name_;
  std::filesystem::path folder_;
  ordered_json label_;
};

class CholecT50Set : public LayoutSet {
 public:
  std::unique_ptr<VideoWriter> MakeWriter(const VideoTask& task,
                                          const simulation::Simulation& /*simulation*/) override {
    return std::make_unique<CholecT50Writer>(task);
  }
  base::Status Finish(const std::filesystem::path& folder) override {
    std::string mapping = "#IVT,I,V,T,IV,IT\n";
    for (std::size_t i = 0; i < CholecT50Triplets().size(); ++i) {
      const Triplet& triplet = CholecT50Triplets()[i];
      const int instrument = static_cast<int>(triplet.instrument), verb = static_cast<int>(triplet.verb),
                target = static_cast<int>(triplet.target);
      mapping += std::to_string(i);
      for (const int id :
           {instrument, verb, target, kVerbs * instrument + verb, kTargets * instrument + target})
        mapping += "," + std::to_string(id);
      mapping += "\n";
    }
    return host::WriteFile(folder / "label_mapping.txt", mapping);
  }
  ordered_json Classes() const override { return MakeCholecT50Categories(); }
  std::vector<std::string> Gaps() const override {
    return {
        "A triplet that is not among the published 100 has the id -1; its instrument, verb and target stand.",
        "Boxes go round all of a tool that is in the picture, not its tip; a target's box goes round all of "
        "that "
        "organ.",
        "Fat and fibres of the hepatocystic triangle count as cystic_pedicle, whose dissection by hook or "
        "bipolar "
        "is none of the 100; every other duct or artery as blood_vessel.",
        "The assistant's grasper and the bag have no instances."};
  }
};

}  // namespace

std::unique_ptr<LayoutSet> MakeCholecT50() {
  return std::make_unique<CholecT50Set>();
}

}  // namespace trocar::dataset
