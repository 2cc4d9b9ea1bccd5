// SPDX-License-Identifier: Apache-2.0
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "common_options.h"
#include "console.h"
#include "part_folder.h"
#include "picture_size.h"
#include "trocar/view/picture_series.h"

namespace trocar::cli {
namespace {

struct PicturesArguments {
  std::string output = "out/pictures", size = "1280x720", moments, only;
  int threads = 1, draws = 1;
  bool is_list = false, is_plain = false;
};

base::Status PrintPictures() {
  std::vector<std::vector<std::string>> rows = {{"picture", "task", "surgeon", "what"}};
  for (const view::SeriesSitting& sitting : view::ListPictureSeries()) {
    for (const view::SeriesShot& shot : sitting.shots)
      rows.push_back({shot.name, sitting.task, sitting.surgeon, host::Translate(shot.about)});
  }
  host::PrintTable(rows);
  return {};
}

base::Status MakePictures(const PicturesArguments& arguments, Outcome& outcome) {
  if (arguments.is_list) return PrintPictures();
  view::SeriesOptions options;
  const auto size = ReadSize(arguments.size);
  if (!size) return size.error();
  options.width = (*size)[0], options.height = (*size)[1];
  options.moments = arguments.moments;
  options.only = arguments.only;
  options.threads = arguments.threads;
  options.draws = arguments.draws;
  options.view.has_force_arrows = false;
  if (arguments.is_plain) options.view.quality = render::Quality::kLow;
  PartFolder part(arguments.output);
  options.output = part.Path();
  host::ProgressBar progress("pictures", 1.0);
  options.on_progress = [&](double share, std::string_view doing) {
    progress.SetLabel(doing);
    progress.Show(share);
  };
  const auto pictures = view::MakePictureSeries(options);
  progress.Finish();
  if (!pictures) return pictures.error();
  if (auto status = part.Keep(); !status) return status;
  std::vector<std::vector<std::string>> rows = {{"picture", "at [s]", "draw [ms]", "what"}};
  std::size_t missing = 0;
  for (const view::SeriesPicture& picture : *pictures) {
    missing += picture.has_come ? 0 : 1;
    rows.push_back({picture.name, host::ShownNumber(picture.time, 4),
                    host::ShownNumber(1e3 * picture.draw_median, 3), host::Translate(picture.about)});
  }
  host::PrintTable(rows);
  host::Say("{1} holds {2} pictures\n", arguments.output, pictures->size() - missing);
  outcome.has_finding = missing > 0;
  return {};
}

}  // namespace

void AddPicturesCommand(CLI::App& app, Outcome& outcome) {
  CLI::App* command = AddListed(app, "pictures");
  auto arguments = std::make_shared<PicturesArguments>();
  command->add_option("-o,--output", arguments->output, "Folder to write")
      ->type_name("DIR")
      ->capture_default_str();
  AddSizeOption(*command, arguments->size, "Of each picture [pixels]");
  command
      ->add_option(
          "--moments", arguments->moments,
          "Folder that keeps the state at each moment; the next time with it nothing is played, only drawn")
      ->type_name("DIR");
  command
      ->add_option("--only", arguments->only, "Draw this one; for the operation, what comes before is played")
      ->type_name("PICTURE");
  command->add_option("--draws", arguments->draws, "Draw each so often, and print the median time")
      ->check(CLI::Range(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  AddThreadsOption(*command, arguments->threads);
  command->add_flag("--plain", arguments->is_plain,
                    "In the lowest quality, which the window takes where no GPU draws");
  command->add_flag("--list", arguments->is_list, "Say which there are, and do nothing");
  command->footer(
      "Scripted surgeons operate four times and begin ten training tasks, which takes minutes. Needs OpenGL "
      "(in\n"
      "software will do) and no display. When anything fails, the folder stays as it was.\n"
      "Examples:\n"
      "  trocar pictures -o docs/pictures --size 480x270\n"
      "  trocar pictures -o out/now --moments out/moments    again after each change of the looks");
  command->callback([arguments, &outcome] { outcome.status = MakePictures(*arguments, outcome); });
}

}  // namespace trocar::cli
