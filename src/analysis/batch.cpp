#include "goingrate/analysis/batch.hpp"

#include "base/partial_file.hpp"
#include "base/workers.hpp"
#include "batch_file.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <mutex>
#include <utility>

namespace goingrate {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The destination of the lines of a share while they are made.
class Lines {
public:
  Lines() = default;
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;
  virtual ~Lines() = default;
  /// Whether the share's i-th job has its line.
  [[nodiscard]] virtual bool has(std::size_t i) const = 0;
  virtual void put(std::size_t i, const std::string& line) = 0;
  virtual void finish() = 0;
};

// A stream takes lines only in order: those that are finished too early are kept until their turn.
class StreamLines : public Lines {
public:
  StreamLines(const std::string& path, const std::string& header) : file_(path) {
    file_.write(header + '\n');
  }
  [[nodiscard]] bool has(std::size_t /*i*/) const override { return false; }
  void put(std::size_t i, const std::string& line) override {
    early_[i] = line;
    for (auto next = early_.find(written_); next != early_.end(); next = early_.find(written_)) {
      file_.write(next->second + '\n');
      early_.erase(next);
      ++written_;
    }
  }
  void finish() override { commit_all({&file_}); }

private:
  StreamedFile file_;
  std::map<std::size_t, std::string> early_;
  std::size_t written_ = 0;
};

std::string partial_name(const std::string& output) { return output + ".part"; }

// Throws InputError unless the partial file belongs to this share of this batch.
void expect_own(const BatchHeader& found, const std::string& file, const BatchHeader& own) {
  expect_same(found, file, own);
  if (found.share.k != own.share.k)
    throw InputError({file, 1, 1}, fmt::format("share {}", found.share.k),
                     fmt::format("share {}", own.share.k));
}

// A file: the lines are appended to a partial file beside it, which becomes the share when
// complete.
class FileLines : public Lines {
public:
  FileLines(const BatchRequest& request, const std::string& header)
      : output_(request.output), header_(header), share_(request.share),
        places_(request.share.size(request.description.jobs)),
        partial_(partial_name(request.output)) {
    if (partial_.lines().empty()) {
      partial_.append(header);
      return;
    }
    take_up();
    if (!request.resume) {
      const auto done =
          places_.size() -
          static_cast<std::size_t>(std::count(places_.begin(), places_.end(), std::nullopt));
      throw UnfinishedBatch(partial_.path(), done, places_.size());
    }
  }

  [[nodiscard]] bool has(std::size_t i) const override { return places_[i].has_value(); }

  void put(std::size_t i, const std::string& line) override {
    partial_.append(line);
    places_[i] = partial_.lines().size() - 1;
  }

  void finish() override {
    StreamedFile file(output_);
    file.write(header_ + '\n');
    for (const auto& place : places_) {
      file.text() += partial_.read(partial_.lines()[*place]) + '\n';
      file.flush_if_large();
    }
    commit_all({&file});
    partial_.discard();
  }

private:
  void take_up() {
    const std::string& name = partial_.path();
    const std::string begun = partial_.read(partial_.lines().front());
    const BatchHeader found = parse_header(begun, name), own = parse_header(header_, output_);
    expect_own(found, name, own);
    for (std::size_t line = 1; line < partial_.lines().size(); ++line) {
      const auto job = job_of_line(partial_.read(partial_.lines()[line]));
      const bool own_job =
          job && *job % share_.n == share_.k - 1 && *job / share_.n < places_.size();
      if (!own_job) throw InputError({name, line + 1, 1}, "no job of this share", "one of them");
      places_[*job / share_.n] = line;
    }
  }

  std::string output_, header_;
  BatchShare share_;
  std::vector<std::optional<std::size_t>> places_; // which line of the partial file, for each job
  PartialFile partial_;
};

bool is_stream(const std::string& path) {
  std::error_code not_there;
  const auto status = std::filesystem::status(path, not_there);
  return path == "-" ||
         (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status));
}

std::unique_ptr<Lines> lines_for(const BatchRequest& request, const std::string& header) {
  if (is_stream(request.output)) return std::make_unique<StreamLines>(request.output, header);
  return std::make_unique<FileLines>(request, header);
}

// Whether the complete share exists already; throws if the file belongs to another batch.
bool is_done(const BatchRequest& request, const std::string& header) {
  if (!request.resume || is_stream(request.output) || !std::filesystem::exists(request.output))
    return false;
  const BatchFile file(request.output);
  const BatchHeader own = parse_header(header, request.output);
  expect_own(file.header(), request.output, own);
  return true;
}

// Distributes the jobs that are missing and collects the outcomes.
class Running {
public:
  Running(const BatchRequest& request, Lines& lines, BatchOutcome& outcome)
      : request_(request), lines_(lines), outcome_(outcome) {
    for (std::size_t i = 0; i < outcome.jobs; ++i)
      if (!lines.has(i)) missing_.push_back(i);
    outcome.taken_up = outcome.jobs - missing_.size();
  }

  void run() {
    const auto work = [&] {
      BatchWorker worker;
      for (auto part = next(); !part.empty(); part = next()) {
        if (!worker) worker = request_.make_worker();
        std::vector<std::size_t> jobs;
        for (const std::size_t i : part)
          jobs.push_back(request_.share.job(i));
        take(part, jobs, worker(jobs));
      }
    };
    run_together(std::min(outcome_.threads, missing_.size()), work, [&] {
      const std::lock_guard lock(mutex_);
      begun_ = missing_.size();
    });
  }

private:
  // The next jobs: as many as a worker does best together, but fewer towards the end, so that all
  // threads finish at about the same time.
  std::span<const std::size_t> next() {
    const std::lock_guard lock(mutex_);
    const std::size_t left = missing_.size() - begun_;
    const std::size_t fair = std::max<std::size_t>(1, left / (2 * outcome_.threads));
    const std::size_t count = std::min({left, fair, request_.at_once});
    begun_ += count;
    return std::span(missing_).subspan(begun_ - count, count);
  }

  void take(std::span<const std::size_t> part, std::span<const std::size_t> jobs,
            const std::vector<JobOutcome>& outcomes) {
    std::vector<std::string> lines; // made by each thread for itself
    for (std::size_t k = 0; k < jobs.size(); ++k)
      lines.push_back(job_line(request_.description, jobs[k], outcomes.at(k)));
    const std::lock_guard lock(mutex_);
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      lines_.put(part[k], lines[k]);
      count(jobs[k], outcomes[k]);
    }
    done_ += jobs.size();
    if (request_.progress)
      request_.progress(static_cast<double>(done_) / static_cast<double>(missing_.size()));
  }

  void count(std::size_t job, const JobOutcome& one) {
    outcome_.failed += one.exit_code == 0 ? 0 : 1;
    outcome_.seconds_in_jobs += one.seconds;
    if (one.seconds <= outcome_.longest_s) return;
    outcome_.longest_s = one.seconds;
    outcome_.longest_job = job;
  }

  const BatchRequest& request_;
  Lines& lines_;
  BatchOutcome& outcome_;
  std::mutex mutex_;
  std::vector<std::size_t> missing_; // places in the share
  std::size_t begun_ = 0, done_ = 0;
};

} // namespace

UnfinishedBatch::UnfinishedBatch(std::string file, std::size_t done, std::size_t jobs)
    : std::runtime_error(
          fmt::format("{} holds {} of {} jobs of a batch that was interrupted", file, done, jobs)),
      file_(std::move(file)) {}

BatchShare parse_share(const std::string& text) {
  BatchShare share;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, share.k);
  if (first.ec == std::errc() && first.ptr != end && *first.ptr == '/') {
    const auto second = std::from_chars(first.ptr + 1, end, share.n);
    if (second.ec == std::errc() && second.ptr == end && share.k >= 1 && share.k <= share.n)
      return share;
  }
  throw ArgumentError("share", text, "k/n with k from 1 to n, such as 3/20");
}

BatchOutcome run_batch(const BatchRequest& request) {
  const auto start = Clock::now();
  const std::string header = header_line(request.description, request.share);
  BatchOutcome outcome;
  outcome.jobs = request.share.size(request.description.jobs);
  outcome.threads = threads_or_usual(request.threads);
  if (is_done(request, header)) {
    outcome.taken_up = outcome.jobs;
    return outcome;
  }
  const auto lines = lines_for(request, header);
  Running(request, *lines, outcome).run();
  lines->finish();
  outcome.seconds = seconds_since(start);
  return outcome;
}

} // namespace goingrate
