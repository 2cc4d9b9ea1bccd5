// SPDX-License-Identifier: Apache-2.0
/// \file dataset_command.cpp  `trocar dataset`: labelled data sets from scripted attempts, and their check.
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <charconv>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "picture_size.h"
#include "trocar/dataset/dataset.h"
#include "trocar/host/data_folder.h"
#include "trocar/scene/scene.h"

namespace trocar::cli {
namespace {

constexpr const char* kReader = "tools/verify-dataset";
constexpr int kCannotRun = 127;  // of a child whose program does not start, as shells have it

struct DatasetArguments {
  dataset::Plan plan;
  std::string layout, seeds = "1:1", size = "854x480", output;
  std::vector<std::string> patients, recordings;
  bool has_no_variation = false, has_no_pictures = false;
};

base::Status ReadSeeds(const std::string& text, dataset::Plan& plan) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, plan.first_seed);
  bool is_good = first.ec == std::errc();
  plan.last_seed = plan.first_seed;
  if (is_good && first.ptr != end) {
    const auto last = *first.ptr == ':' ? std::from_chars(first.ptr + 1, end, plan.last_seed) : first;
    is_good = *first.ptr == ':' && last.ec == std::errc() && last.ptr == end;
  }
  if (is_good) return {};
  return base::Error{base::ErrorCode::kUsage,
                     "--seeds is FIRST:LAST, both included, or one number; this is \"" + text + "\""};
}

base::Status Make(const DatasetArguments& arguments) {
  if (arguments.layout.empty() || arguments.output.empty())
    return base::Error{base::ErrorCode::kUsage, "name --layout and -o DIR; see trocar dataset --help"};
  dataset::Plan plan = arguments.plan;
  const auto layout = dataset::FindLayout(arguments.layout);
  if (!layout) {
    std::string known;
    for (const dataset::Layout each : dataset::kLayouts) known += " " + std::string(dataset::NameOf(each));
    return base::Error{base::ErrorCode::kUnknownName,
                       "there is no layout \"" + arguments.layout + "\"; there are" + known};
  }
  plan.layout = *layout;
  if (auto status = ReadSeeds(arguments.seeds, plan); !status) return status;
  const auto size = ReadSize(arguments.size);
  if (!size) return size.error();
  plan.width = (*size)[0], plan.height = (*size)[1];
  plan.patients.assign(arguments.patients.begin(), arguments.patients.end());
  plan.recordings.assign(arguments.recordings.begin(), arguments.recordings.end());
  plan.has_variation = !arguments.has_no_variation;
  plan.has_pictures = !arguments.has_no_pictures;
  host::ProgressBar progress("videos", 1.0);
  const auto made = dataset::WriteDataset(plan, arguments.output, [&](double share, std::string_view doing) {
    progress.SetLabel(doing);
    progress.Show(share);
  });
  progress.Finish();
  if (!made) return made.error();
  host::Say("{1} holds {2} videos, {3} labelled frames, {4} files; {5} frames a second\n", arguments.output,
            made->videos, made->frames, made->files,
            host::ShownNumber(static_cast<double>(made->frames) / made->seconds, 3));
  host::Say("SHA-256 of SHA256SUMS: {1}\n", made->hash);
  return {};
}

/// Runs the reader, which shares no code with what wrote the set.
base::Status Verify(const std::string& folder) {
  const auto data = host::FindDataFolder();
  if (!data) return data.error();
  const std::string reader = (*data / kReader).string();
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    execlp("python3", "python3", reader.c_str(), folder.c_str(), static_cast<char*>(nullptr));
    _exit(kCannotRun);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status) ||
      WEXITSTATUS(status) == kCannotRun) {
    return base::Error{base::ErrorCode::kFileMissing,
                       reader +
                           " does not run; it needs python3, python3-numpy and, for layout trocar, "
                           "python3-h5py: tools/install-packages --test"};
  }
  if (WEXITSTATUS(status) == 0) return {};
  return base::Error{base::ErrorCode::kDatasetInvalid,
                     folder + " is not what its card says: the lines above name it; make it again"};
}

}  // namespace

void AddDatasetCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "dataset");
  auto a = std::make_shared<DatasetArguments>();
  command
      ->add_option("--layout", a->layout,
                   "cholecseg8k (masks of 13 classes), cholec80 (phases, tools), cholect50 (triplets), "
                   "endoscapes (COCO, "
                   "critical view), trocar (everything, HDF5)")
      ->type_name("LAYOUT");
  std::vector<CLI::Option*> scripted;
  scripted.push_back(
      command->add_option("--task", a->plan.task, "A training task or an operation (trocar play --list)")
          ->type_name("TASK")
          ->capture_default_str());
  scripted.push_back(command->add_option("--level", a->plan.level, "Difficulty of the task or the operation")
                         ->type_name("LEVEL")
                         ->capture_default_str());
  scripted.push_back(command->add_option("--surgeon", a->plan.surgeon, "A scripted one (trocar play --list)")
                         ->type_name("SURGEON")
                         ->capture_default_str());
  scripted.push_back(command->add_option("--seeds", a->seeds, "A video for each, both included")
                         ->type_name("A:B")
                         ->capture_default_str());
  scripted.push_back(
      command
          ->add_option(
              "--patient", a->patients,
              "Folder of a patient in place of the scene's (trocar anatomy generate); several take turns")
          ->allow_extra_args(false)
          ->type_name("DIR"));
  CLI::Option* recording =
      command
          ->add_option("--recording", a->recordings,
                       "A video of each recorded attempt in place of scripted ones; they are numbered from 1")
          ->type_name("FILE");
  for (CLI::Option* option : scripted) recording->excludes(option);
  AddSizeOption(*command, a->size, "Of each picture [pixels]");
  command->add_option("--every", a->plan.every, "Between two frames [s]")
      ->check(CLI::Range(0.04, 60.0))
      ->type_name("S")
      ->capture_default_str();
  command->add_option("--most-seconds", a->plan.most_seconds, "Of each video [s]")
      ->check(CLI::Range(0.01, 1e5))
      ->type_name("S")
      ->capture_default_str();
  command->add_flag("--no-variation", a->has_no_variation,
                    "The same light, lens, colours and haze in every video");
  command->add_flag("--no-pictures", a->has_no_pictures,
                    "States, actions, forces and positions alone, many times as fast; of the layout trocar");
  command->add_option("--jobs", a->plan.jobs, "Videos at a time; the set is the same for any number")
      ->check(CLI::Range(1, 256))
      ->type_name("J")
      ->capture_default_str();
  command->add_option("-o,--output", a->output, "A folder that is not there, or empty")->type_name("DIR");
  command->footer(
      "The set is written to DIR.part... and renamed when it is whole. DIR/card.json and DIR/README.md say "
      "how it was\n"
      "made, its licence, seeds, hash and known gaps. docs/datasets.md has the tables of classes.\n"
      "Examples:\n"
      "  trocar dataset --layout cholecseg8k --seeds 1:4 --most-seconds 120 -o sets/seg\n"
      "  trocar dataset --layout trocar --task peg_transfer --seeds 1:20 --every 0.1 -o sets/pegs\n"
      "  trocar dataset --layout trocar --task lift_and_grasp --seeds 1:200 --every 0.1 --no-pictures -o "
      "sets/lift\n"
      "  trocar dataset --layout endoscapes --recording attempt.trocar -o sets/mine\n"
      "  trocar dataset verify sets/seg");
  auto folder = std::make_shared<std::string>();
  CLI::App* verify = command->add_subcommand(
      "verify",
      "Check a data set with a reader that shares no code with what wrote it (Python, numpy, h5py)");
  verify->add_option("folder", *folder, "The data set")->required()->type_name("DIR");
  verify->footer(
      "Files against their sums, sizes, classes, boxes, masks and poses against each other; acts, phases and "
      "the critical "
      "view against what the simulation knows. E-DAT-001 if not.");
  command->callback(
      [a, verify, folder, &outcome] { outcome.status = verify->parsed() ? Verify(*folder) : Make(*a); });
}

}  // namespace trocar::cli
