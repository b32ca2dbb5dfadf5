// goingrate batch: one job for each log, or for each realisation of a scenario.
#include "batch_jobs.hpp"
#include "job.hpp"
#include "progress.hpp"
#include "scenario.hpp"
#include "usage.hpp"

#include "goingrate/analysis/batch_summary.hpp"
#include "goingrate/analysis/simulated_logs.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/report/batch_report.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <glob.h>
#include <iostream>
#include <memory>
#include <utility>

namespace goingrate::apps {

namespace {

struct BatchOptions {
  ScenarioOptions scenario;
  std::size_t realisations = 0;
  std::uint64_t seed = 1;
  std::string share;
  std::string output = "-";
  std::size_t threads = 0;
  bool resume = false, quiet = false;
};

void add_quiet_flag(CLI::App& command, BatchOptions& options) {
  command.add_flag("--quiet", options.quiet, "no notes on standard error");
}

void add_output_option(CLI::App& command, BatchOptions& options, const char* what) {
  command.add_option("-o,--output", options.output, what);
}

// These options may stand before the command of the jobs or after it.
void add_batch_options(CLI::App& command, BatchOptions& options) {
  const std::size_t others = command.get_options().size();
  add_output_option(command, options, "the file of lines; standard output if not given");
  command.add_option("--scenario", options.scenario.path,
                     "the jobs are realisations of this scenario, not logs");
  command
      .add_option("--realisations", options.realisations,
                  "number of realisations; number i, from 0, is what simulate gives with --seed "
                  "SEED+i")
      ->check(CLI::Range(1, 1000000000));
  command.add_option("--seed", options.seed, "seed of realisation 0")->check(seed_range());
  add_override_option(command, options.scenario);
  command.add_option("--share", options.share,
                     "k/n: do every n-th job, from the k-th on, for batch merge");
  command.add_flag("--resume", options.resume,
                   "do only the jobs that an interrupted batch left undone");
  command
      .add_option("--threads", options.threads,
                  "number of threads; 0: one per core. The results are the same")
      ->check(not_negative());
  add_quiet_flag(command, options);
  const auto all = command.get_options();
  for (std::size_t i = others; i < all.size(); ++i)
    all[i]->group("The batch");
}

// Parses by a parser of our own, which names words that it does not know; false after --help.
bool parse(CLI::App& command, Words words) {
  std::reverse(words.begin(), words.end());
  try {
    command.parse(words);
  } catch (const CLI::CallForHelp&) {
    std::cout << command.help();
    return false;
  } catch (const CLI::ParseError& error) {
    const auto unexpected = unexpected_word(command, command.get_name());
    throw UsageError(unexpected ? *unexpected : command.get_name() + ": " + error.what());
  }
  return true;
}

// ---- the logs

// The files that a pattern names, in order of their names whatever the locale.
Words matches(const std::string& pattern) {
  glob_t found{};
  Words files;
  if (::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &found) == 0)
    files.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  ::globfree(&found);
  std::sort(files.begin(), files.end());
  return files;
}

Words files_in(const std::string& folder) {
  Words files;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file() && !entry.path().filename().string().starts_with('.'))
      files.push_back(entry.path().string());
  if (files.empty()) throw InputError({folder}, "no files", "a folder with logs");
  std::sort(files.begin(), files.end());
  return files;
}

// One job per file, and for each file of a folder. A file that does not exist is a job that fails.
Words logs_named(const Words& given) {
  Words logs;
  for (const std::string& name : given) {
    if (name == "-") throw UsageError("batch reads no log from standard input: name files");
    std::error_code unknown;
    Words files{name};
    if (std::filesystem::is_directory(name, unknown))
      files = files_in(name);
    else if (!std::filesystem::exists(name, unknown))
      if (Words found = matches(name); !found.empty()) files = std::move(found);
    logs.insert(logs.end(), files.begin(), files.end());
  }
  return logs;
}

// ---- the commands

void tell(const BatchOutcome& outcome, const GlobalOptions& global) {
  const std::size_t now = outcome.jobs - outcome.taken_up;
  if (outcome.taken_up > 0)
    say(global, fmt::format("{} of {} jobs were done before", outcome.taken_up, outcome.jobs));
  if (now == 0) return;
  const double available = outcome.seconds * static_cast<double>(outcome.threads);
  say(global,
      fmt::format(
          "{} job{} in {:.3g} s by {} threads, which spent {:.1f} % of it in jobs, {:.3g} s "
          "each; the longest, job {}, took {:.3g} s",
          now, now == 1 ? "" : "s", outcome.seconds, outcome.threads,
          100.0 * outcome.seconds_in_jobs / available,
          outcome.seconds_in_jobs / static_cast<double>(now), outcome.longest_job,
          outcome.longest_s));
  if (outcome.failed > 0)
    say(global, outcome.failed == 1
                    ? "one job failed: its line says why"
                    : fmt::format("{} jobs failed: their lines say why", outcome.failed));
}

void run_jobs(BatchRequest request, const GlobalOptions& global) {
  const BatchOutcome outcome = [&] {
    ProgressBar bar(global.quiet, "jobs");
    request.progress = std::ref(bar);
    return run_batch(request);
  }();
  tell(outcome, global);
}

void run_realisations(const BatchOptions& options, const JobSettings& settings,
                      BatchRequest request, const GlobalOptions& global) {
  const ReadScenario read = read_scenario(options.scenario);
  const auto& series = read.scenario.drive.series;
  BatchScenario scenario;
  scenario.hash =
      scenario_hash(read.text, options.scenario.overrides,
                    series ? std::span<const double>(*series) : std::span<const double>());
  scenario.seed = options.seed;
  scenario.truth = true_parameters(read.scenario);
  request.description.jobs = options.realisations;
  request.description.scenario = std::move(scenario);
  constexpr std::size_t lanes = 8; // realisations that are simulated at a time
  request.at_once = lanes;
  const SimulatedLogs logs(read.scenario);
  request.make_worker = [&] { return RealisationWorker(logs, options.seed, settings.of("")); };
  run_jobs(std::move(request), global);
}

void run_logs(const Words& given, const JobSettings& settings, BatchRequest request,
              const GlobalOptions& global) {
  const Words logs = logs_named(given);
  request.description.jobs = logs.size();
  request.description.logs = logs;
  static_cast<void>(settings.of(logs.front())); // wrong usage shows before the first job
  request.make_worker = [&] { return log_worker(logs, settings); };
  run_jobs(std::move(request), global);
}

// ---- the parsers of the words after the name of a job

void add_kind(CLI::App& command, const JobKind& kind, Job& job, Words& logs,
              BatchOptions& options) {
  job = kind.add(command);
  command.add_option("log", logs, "the logs, one job each; a folder stands for all files in it");
  add_batch_options(command, options);
}

void add_merge(CLI::App& command, Words& shares, BatchOptions& options) {
  command.add_option("share", shares, "the files of all shares, in any order")->required();
  add_output_option(command, options, "the whole batch; standard output if not given");
  add_quiet_flag(command, options);
}

void add_summary(CLI::App& command, std::string& file, std::string& json, BatchOptions& options) {
  command.add_option("file", file, "the file that batch or batch merge wrote")->required();
  add_output_option(command, options, "the text; standard output if not given");
  add_json_option(command, json);
  add_quiet_flag(command, options);
}

// The words that set up the job, without those of the batch and the names of logs.
Words settings_of(const CLI::App& command, const CLI::App& known) {
  Words words;
  for (const CLI::Option* option : command.parse_order()) {
    if (option->get_lnames().empty()) continue;
    const std::string name = "--" + option->get_lnames().front();
    if (known.get_option_no_throw(name) == nullptr) continue;
    if (std::find(words.begin(), words.end(), name) != words.end()) continue; // all values at once
    for (const std::string& value : option->results()) {
      words.push_back(name);
      if (option->get_items_expected_max() > 0) words.push_back(value);
    }
  }
  return words;
}

void run_kind(const JobKind& kind, BatchOptions options, const Words& words, GlobalOptions global) {
  CLI::App command{"", fmt::format("goingrate batch {}", kind.name)};
  narrow_help(command);
  CLI::App settings_alone;
  const Job known = kind.add(settings_alone);
  Job all;
  Words given;
  Words overrides = std::exchange(options.scenario.overrides, {}); // those before the job's name
  add_kind(command, kind, all, given, options);
  if (!parse(command, words)) return;
  overrides.insert(overrides.end(), options.scenario.overrides.begin(),
                   options.scenario.overrides.end());
  options.scenario.overrides = std::move(overrides);
  global.quiet = global.quiet || options.quiet;
  const bool simulates = !options.scenario.path.empty();
  if (simulates != given.empty())
    throw UsageError(simulates ? "found logs, expected none beside --scenario"
                               : "expected logs, or --scenario with --realisations");
  if (simulates != (options.realisations > 0))
    throw UsageError("--scenario and --realisations go together");
  BatchRequest request;
  request.description.command = kind.name;
  const JobSettings settings(kind, settings_of(command, settings_alone));
  request.description.settings = settings.words();
  if (!options.share.empty()) request.share = parse_share(options.share);
  request.output = options.output;
  request.resume = options.resume;
  if (options.resume && options.output == "-")
    throw UsageError("--resume needs the file of the interrupted batch: -o FILE");
  request.threads = options.threads;
  simulates ? run_realisations(options, settings, std::move(request), global)
            : run_logs(given, settings, std::move(request), global);
}

void run_merge(BatchOptions options, const Words& words) {
  CLI::App command{"join the shares of a batch into the whole", "goingrate batch merge"};
  narrow_help(command);
  Words shares;
  add_merge(command, shares, options);
  if (parse(command, words)) merge_batch(shares, options.output);
}

void run_summary(BatchOptions options, const Words& words) {
  CLI::App command{"summarise a whole batch", "goingrate batch summary"};
  narrow_help(command);
  std::string file, json;
  options.output.clear();
  add_summary(command, file, json, options);
  if (!parse(command, words)) return;
  const BatchSummary summary = batch_summary(file);
  write_whole_files(
      {{json, batch_json(summary)}, {table_output(options.output, json), batch_text(summary)}});
}

void run(const BatchOptions& options, Words words, const GlobalOptions& global) {
  if (words.empty())
    throw UsageError("expected what each job does (fit, rate, report or stability), or merge or "
                     "summary, after goingrate batch");
  const std::string name = words.front();
  words.erase(words.begin());
  if (name == "merge") return run_merge(options, words);
  if (name == "summary") return run_summary(options, words);
  for (const JobKind& kind : job_kinds)
    if (name == kind.name) return run_kind(kind, options, words, global);
  throw UsageError(fmt::format(
      "found {}, expected fit, rate, report, stability, merge or summary after goingrate batch "
      "({})",
      name,
      did_you_mean(name, {"fit", "rate", "report", "stability", "merge", "summary"},
                   "goingrate batch --help")));
}

} // namespace

void add_batch(CLI::App& program, const GlobalOptions& global) {
  auto* command = program.add_subcommand(
      "batch", "fit, rate, report or stability of many logs or realisations");
  auto options = std::make_shared<BatchOptions>();
  command->prefix_command();
  command->fallthrough(false);
  add_batch_options(*command, *options);
  command->footer(
      "One line of JSON a job, in order. Behind the job's name come the logs and the options of\n"
      "that command (goingrate batch fit --help). In an option {.} is the log's name without its\n"
      "ending: --from {.}.par.\n"
      "  goingrate batch (fit|rate|report|stability) LOG ... -o FILE\n"
      "  goingrate batch --scenario FILE --realisations N -- fit ... -o FILE\n"
      "  goingrate batch merge SHARE ... -o FILE\n"
      "  goingrate batch summary FILE\n"
      "Example:\n  goingrate batch rate data/logs/*.csv -o logs.jsonl");
  command->callback([command, options, &global] { run(*options, command->remaining(), global); });
}

void add_batch_jobs(CLI::App& program) {
  struct Target { // what the options are parsed to has to outlive them
    BatchOptions options;
    Job job;
    Words words;
    std::string file, json;
  };
  CLI::App& batch = *program.get_subcommand("batch");
  const auto parser_of = [&](const char* name, const std::shared_ptr<Target>& target) {
    CLI::App* command = batch.add_subcommand(name);
    command->callback([target] {});
    return command;
  };
  for (const JobKind& kind : job_kinds) {
    const auto target = std::make_shared<Target>();
    add_kind(*parser_of(kind.name, target), kind, target->job, target->words, target->options);
  }
  const auto shares = std::make_shared<Target>(), whole = std::make_shared<Target>();
  add_merge(*parser_of("merge", shares), shares->words, shares->options);
  add_summary(*parser_of("summary", whole), whole->file, whole->json, whole->options);
}

} // namespace goingrate::apps
