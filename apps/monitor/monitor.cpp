// goingrate monitor: a clock watched for years.
#include "monitor.hpp"

#include "alarm_commands.hpp"
#include "clock_watch.hpp"
#include "file_position.hpp"
#include "server.hpp"
#include "source.hpp"
#include "source_head.hpp"

#include "goingrate/base/errors.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

namespace goingrate::apps {

namespace {

struct MonitorOptions {
  LogOptions log;
  std::string source, archive, listen, on_alarm, name, start;
  double patience_s = 0.0;
};

// Set by a signal; a second one ends the program at once.
std::atomic<bool> is_to_end = false;

extern "C" void end_watch(int number) {
  is_to_end = true;
  std::signal(number, SIG_DFL);
}

Moment now() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count();
  const auto running = std::chrono::steady_clock::now().time_since_epoch();
  return {{ns / 1'000'000'000, static_cast<double>(ns % 1'000'000'000) * 1e-9},
          std::chrono::duration<double>(running).count()};
}

WatchOptions watch_options(const MonitorOptions& options) {
  WatchOptions watch;
  watch.log = options.log;
  watch.folder = options.archive;
  watch.patience_s = options.patience_s;
  watch.lateness_s = lateness_of(options.source);
  watch.place.source_is_live = !is_file(options.source);
  if (!options.start.empty()) {
    watch.place.start = parse_instant(options.start);
    if (!watch.place.start)
      throw ArgumentError("--start", options.start, "seconds since 1970, such as 1764144000");
  }
  return watch;
}

class Monitor {
public:
  Monitor(const MonitorOptions& options, const GlobalOptions& global)
      : options_(options), global_(global),
        address_(options.listen.empty() ? std::nullopt
                                        : std::optional(parse_address(options.listen))),
        watch_(watch_options(options)), position_(options.archive),
        head_(options.archive, options.source), commands_(options.on_alarm),
        answering_(options.name) {
    if (!address_) return;
    server_.emplace(*address_);
    say(global_, fmt::format("listening at port {}", server_->port()));
    publish(now().wall);
  }

  // Runs until the source ends, or a signal comes. A source that fails is opened again.
  void run() {
    while (!is_to_end) {
      try {
        if (!is_file(options_.source))
          follow({options_.source});
        else
          for (const FilePosition::Part& part : position_.parts_of(options_.source))
            follow(part);
        if (ends_for_good(options_.source)) break;
      } catch (const InputError& error) {
        watch_.give_up_unread();
        if (ends_for_good(options_.source)) throw;
        if (std::exchange(failure_, error.what()) != failure_)
          say(global_, fmt::format("warning: {}; trying again", failure_));
      }
      for (int tenth = 0; tenth < 10 && !is_to_end; ++tenth) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        watch_.idle({}, now());
        tell();
      }
    }
  }

private:
  void follow(const FilePosition::Part& part) {
    const OpenSource source(part.path);
    const bool may_grow = part.path == options_.source;
    ClockLog known;
    const auto wait = [&](std::string_view held) {
      if (!held.empty()) watch_.hold(held, now());
      watch_.idle(known, now());
      save_position();
      tell();
      return may_grow && !is_to_end;
    };
    LogFollower log(source.path(), reading_options(options_.log), wait, before());
    if (!is_file(options_.source)) head_.keep(log.head());
    known = log.log();
    std::uint32_t known_lines = part.known_lines, last_line = 0;
    for (auto event = log.next(); event && !is_to_end; event = log.next()) {
      if (event->line < last_line) known_lines = 0; // of another file in its place
      last_line = event->line;
      if (event->line <= known_lines) continue;
      watch_.add({*event, log.values()}, log.log(), now());
      if (is_file(options_.source)) position_.took(part.path, event->line);
      save_position();
      tell();
    }
    if (may_grow) watch_.end(log.log(), now());
    save_position();
    tell();
  }

  // What a live source said last time.
  [[nodiscard]] std::string before() const {
    const bool is_new = watch_.unread().empty() && !is_file(options_.source);
    return is_new ? head_.text() : watch_.unread();
  }

  void save_position() {
    if (watch_.is_all_stored()) position_.save();
  }

  // Passes on alarms at once, answers once a second.
  void tell() {
    for (const AlarmChange& change : watch_.take_alarm_changes()) {
      say(global_, fmt::format("{} {}: {}", change.is_raised ? "alarm" : "over",
                               name_of(change.kind), change.text));
      commands_.run(change);
    }
    for (const std::string& failure : commands_.take_failures()) {
      say(global_, failure);
      watch_.note(failure, now());
    }
    for (; assumptions_told_ < watch_.assumptions().size(); ++assumptions_told_)
      say(global_, "assumed: " + watch_.assumptions()[assumptions_told_].text);
    const auto at = std::chrono::steady_clock::now();
    if (server_ && at - published_ >= std::chrono::seconds(1)) publish(now().wall);
  }

  void publish(const Instant& at) {
    published_ = std::chrono::steady_clock::now();
    server_->publish(answering_.at(at, watch_));
  }

  const MonitorOptions& options_;
  const GlobalOptions& global_;
  std::optional<ListenAddress> address_;
  ClockWatch watch_;
  FilePosition position_;
  SourceHead head_;
  AlarmCommands commands_;
  WatchAnswering answering_;
  std::optional<MonitorServer> server_;
  std::chrono::steady_clock::time_point published_;
  std::string failure_; // of the source, said once
  std::size_t assumptions_told_ = 0;
};

void run(MonitorOptions options, const GlobalOptions& global) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(number, end_watch) == SIG_IGN) std::signal(number, SIG_IGN); // nohup
  check_source(options.source);
  options.log.paths = {options.source};
  if (options.name.empty()) options.name = options.source;
  Monitor monitor(options, global);
  monitor.run();
}

} // namespace

void add_monitor(CLI::App& program, const GlobalOptions& global) {
  auto* command =
      program.add_subcommand("monitor", "watch a clock for years: archive, page, alarms");
  auto options = std::make_shared<MonitorOptions>();
  command
      ->add_option("source", options->source,
                   "a growing file, a FIFO, '-' for standard input, a serial device with its speed "
                   "(/dev/ttyACM0:115200), or arecord:DEVICE for a sound card")
      ->required();
  command->add_option("--archive", options->archive, "the folder that keeps a file a day")
      ->required();
  command->add_option("--listen", options->listen,
                      "HOST:PORT of the page; 127.0.0.1:8080 is for this computer alone");
  command->add_option("--on-alarm", options->on_alarm,
                      "a command of the shell, run when an alarm begins or ends, for a minute at "
                      "most; it finds GOINGRATE_ALARM, GOINGRATE_STATE (raised, cleared) and "
                      "GOINGRATE_TEXT");
  command->add_option("--name", options->name, "of the clock, for the page");
  command
      ->add_option("--patience", options->patience_s,
                   "seconds without a beat that are an alarm; five periods if not given")
      ->check(positive());
  command->add_option("--start", options->start,
                      "when a source without dates counts from, in seconds since 1970; from its "
                      "first event if not given");
  add_log_settings(*command, options->log);
  // Options for a log as a whole, or for a recording, do not apply to one that comes line by line.
  for (const char* name : {"--weather-zone", "--weather-offset", "--weather", "--site",
                           "--sensor-offset", "--clock-ppm", "--rest-angle"})
    command->remove_option(command->get_option(name));
  command->get_option("--both-edges")
      ->description("the log holds crossings in both directions, without labels")
      ->needs(command->get_option("--nominal-period"));
  command->get_option("--flag-width")
      ->description("angle (rad) of a centred flag as seen from the pivot: gives the amplitudes, "
                    "with a column of widths");
  command->get_option("--gravity-share")
      ->description("share of gravity in the restoring torque; the rest is a spring's. 1: a "
                    "pendulum, 0: torsion. Used for amplitudes from --flag-width");
  command->footer("Example:\n  goingrate monitor - --archive clock < my.log");
  command->callback([options, &global] { run(*options, global); });
}

} // namespace goingrate::apps
