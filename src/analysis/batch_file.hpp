// The text of a batch's files: a line for the batch and one for each job.
#pragma once

#include "goingrate/analysis/batch.hpp"

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace goingrate {

using Json = nlohmann::ordered_json;

/// The first line of a share's file, without its end.
std::string header_line(const BatchDescription& batch, const BatchShare& share);

/// The line of a job, without its end.
std::string job_line(const BatchDescription& batch, std::size_t job, const JobOutcome& outcome);

/// The job of a line; nothing if it is not the line of a job.
std::optional<std::size_t> job_of_line(std::string_view line);

/// The contents of a first line.
struct BatchHeader {
  std::string batch; ///< what names it
  BatchShare share;
  std::size_t jobs = 0;
  Json json; ///< all of it
};

/// Throws InputError if `line` is not the first line of a file of this name.
BatchHeader parse_header(const std::string& line, const std::string& file);

/// Throws InputError unless both are shares of one batch, with the same number of shares.
void expect_same(const BatchHeader& found, const std::string& file, const BatchHeader& expected);

/// A file of a batch, line by line.
class BatchFile {
public:
  /// Throws InputError if it cannot be read or is not one.
  explicit BatchFile(const std::string& path);
  [[nodiscard]] const BatchHeader& header() const { return header_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// The next job's line; it must be that of `job`. Throws InputError.
  const std::string& line_of(std::size_t job);
  /// Throws InputError if there are more lines.
  void expect_end();

private:
  std::string path_;
  std::ifstream file_;
  std::string line_;
  std::size_t number_ = 1; // of the line that was read last
  BatchHeader header_;
};

} // namespace goingrate
