#include <fmt/format.h>

#include <memory>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/stages.h"
#include "cli/usage.h"
#include "reports/report.h"

namespace grouser::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run_folder;
  std::string figure;
  std::string file;
  bool list = false;
  bool dark = false;
};

Result list_figures() {
  Result result;
  for (const FigureEntry& entry : run_figures()) {
    result.lines.push_back(fmt::format("{:<24} {}", entry.name, entry.meaning));
    result.json["figures"].push_back({{"name", entry.name}, {"meaning", entry.meaning}});
  }
  return result;
}

Result run(const Options& options) {
  if (options.list) return list_figures();
  const fs::path file =
      options.file.empty() ? fs::path(options.run_folder) / (options.figure + ".png") : fs::path(options.file);
  const RunFolder opened = open_run_folder(options.run_folder);
  const Figure figure = make_run_figure(opened, options.figure);
  if (interrupted()) throw Interrupted("before the figure was drawn");
  const Theme theme = options.dark ? Theme::dark : Theme::light;
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  if (file.extension() == ".svg") {
    write_whole(file, svg_file(figure, theme));
  } else {
    write_png(draw(figure, theme), file);
  }
  Result result;
  result.lines.push_back(file.string());
  result.json["outputs"].push_back(file.string());
  return result;
}

std::vector<std::string> figure_names() {
  std::vector<std::string> names;
  for (const FigureEntry& entry : run_figures()) names.push_back(entry.name);
  return names;
}

}  // namespace

Command add_plot(CLI::App& root) {
  CLI::App* app = root.add_subcommand("plot", "Draw one figure of a run");
  const auto options = std::make_shared<Options>();
  CLI::Option* list = app->add_flag("--list", options->list, "Print the figures and what they show");
  CLI::Option* folder = app->add_option("RUN_DIR", options->run_folder, "Folder that `grouser simulate` wrote");
  CLI::Option* figure =
      app->add_option("--figure", options->figure, "Figure to draw")->type_name("NAME")->check(one_of(figure_names()));
  app->add_option("-o,--output", options->file, "Picture, pixels or vectors by its ending [RUN_DIR/NAME.png]")
      ->type_name("FILE.png|.svg")
      ->check(ending_in(".png") | ending_in(".svg"));
  app->add_flag("--dark", options->dark, "Light lines on a dark ground");
  app->callback([list, folder, figure] {
    if (list->count() > 0) return;
    if (folder->count() == 0) throw CLI::RequiredError("RUN_DIR");
    if (figure->count() == 0) throw CLI::RequiredError("--figure");
  });
  return {app, [options](Console&) { return run(*options); }};
}

}  // namespace grouser::cli
