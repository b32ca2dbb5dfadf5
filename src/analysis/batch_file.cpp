#include "batch_file.hpp"

#include "base/versions.hpp"
#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <charconv>
#include <fmt/format.h>
#include <utility>

namespace goingrate {

namespace {

constexpr const char* schema = "goingrate.batch";
constexpr std::string_view line_begin = R"({"job":)";

std::string uuid_of(const std::string& text) {
  const boost::uuids::name_generator_sha1 name(boost::uuids::ns::oid());
  return boost::uuids::to_string(name(text));
}

// A file name in some other encoding than UTF-8 is written with replacement characters.
std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json versions_object() {
  Json json = Json::object();
  for (const auto& [name, version] : versions())
    json[name] = version;
  return json;
}

// What distinguishes the batch from others.
Json description_object(const BatchDescription& batch) {
  Json json = {{"jobs", batch.jobs},
               {"command", batch.command},
               {"settings", batch.settings},
               {"versions", versions_object()}};
  if (batch.scenario)
    json["scenario"] = {{"hash", batch.scenario->hash}, {"seed", batch.scenario->seed}};
  return json;
}

std::string name_of(const BatchDescription& batch, const Json& description) {
  return uuid_of(one_line({description, batch.logs}));
}

// The settings that most often distinguish two batches, for a message.
std::string in_words(const BatchHeader& header) {
  return fmt::format("share {}/{} of the batch {} ({} jobs: {} {})", header.share.k, header.share.n,
                     header.batch, header.jobs, header.json.at("command").get<std::string>(),
                     fmt::join(header.json.at("settings").get<std::vector<std::string>>(), " "));
}

} // namespace

std::string scenario_hash(std::string_view text, std::span<const std::string> overrides,
                          std::span<const double> series) {
  std::string all(text);
  for (const std::string& override_text : overrides)
    all += '\0' + override_text;
  for (const double factor : series)
    all += '\0' + fmt::format("{:a}", factor);
  return uuid_of(all);
}

std::string header_line(const BatchDescription& batch, const BatchShare& share) {
  Json description = description_object(batch);
  Json json = {{"schema", schema},
               {"version", 1},
               {"batch", name_of(batch, description)},
               {"share", share.k},
               {"of", share.n}};
  json.update(description);
  if (batch.scenario) json["scenario"]["truth"] = batch.scenario->truth;
  return one_line(json);
}

std::string job_line(const BatchDescription& batch, std::size_t job, const JobOutcome& outcome) {
  Json json = {{"job", job}};
  if (batch.scenario) {
    json["seed"] = batch.scenario->seed + job;
    json["scenario"] = batch.scenario->hash;
  } else {
    json["log"] = batch.logs[job];
  }
  json["versions"] = versions_object();
  json["exit"] = outcome.exit_code;
  if (!outcome.message.empty()) json["message"] = outcome.message;
  if (!outcome.assumed.empty()) json["assumed"] = outcome.assumed;
  json["result"] = outcome.result.empty() ? Json(nullptr) : Json::parse(outcome.result);
  return one_line(json);
}

std::optional<std::size_t> job_of_line(std::string_view line) {
  if (!line.starts_with(line_begin) || !line.ends_with('}')) return {};
  std::size_t job = 0;
  const char* begin = line.data() + line_begin.size();
  const auto [end, fault] = std::from_chars(begin, line.data() + line.size(), job);
  if (fault != std::errc() || *end != ',') return {};
  return job;
}

BatchHeader parse_header(const std::string& line, const std::string& file) {
  const auto refuse = [&](const std::string& found) {
    return InputError({file, 1, 1}, found, "the first line of a batch's file, as batch writes it");
  };
  BatchHeader header;
  header.json = Json::parse(line, nullptr, false);
  if (!header.json.is_object()) throw refuse("another text");
  try {
    const Json& json = header.json;
    if (json.at("schema") != schema) throw refuse("schema " + json.at("schema").dump());
    if (json.at("version") != 1) throw refuse("version " + json.at("version").dump());
    header.batch = json.at("batch").get<std::string>();
    header.share = {json.at("share").get<std::size_t>(), json.at("of").get<std::size_t>()};
    header.jobs = json.at("jobs").get<std::size_t>();
    static_cast<void>(in_words(header)); // for messages
  } catch (const nlohmann::json::exception& error) {
    throw refuse(error.what());
  }
  if (header.share.k < 1 || header.share.k > header.share.n)
    throw refuse(fmt::format("share {}/{}", header.share.k, header.share.n));
  return header;
}

void expect_same(const BatchHeader& found, const std::string& file, const BatchHeader& expected) {
  if (found.batch != expected.batch || found.share.n != expected.share.n)
    throw InputError({file, 1, 1}, in_words(found), "one of those of " + in_words(expected));
}

BatchFile::BatchFile(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  note_input(path);
  if (!file_ || !std::getline(file_, line_))
    throw InputError({path}, "a file that cannot be read", "a share of a batch");
  header_ = parse_header(line_, path);
}

const std::string& BatchFile::line_of(std::size_t job) {
  ++number_;
  if (!std::getline(file_, line_) || file_.eof())
    throw InputError({path_, number_, 1}, "the end of the file", fmt::format("job {}", job));
  const auto found = job_of_line(line_);
  if (found != job)
    throw InputError({path_, number_, 1}, found ? fmt::format("job {}", *found) : "no job's line",
                     fmt::format("job {}", job));
  return line_;
}

void BatchFile::expect_end() {
  if (std::getline(file_, line_))
    throw InputError({path_, number_ + 1, 1}, "more lines", "the end of the file");
}

} // namespace goingrate
