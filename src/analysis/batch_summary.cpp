#include "goingrate/analysis/batch_summary.hpp"

#include "base/special_values.hpp"
#include "batch_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

double number(const Json& json, const char* key, double otherwise = not_known) {
  const auto found = json.find(key);
  return found == json.end() || !found->is_number() ? otherwise : found->get<double>();
}

const Json& part(const Json& json, const char* key) {
  static const Json none = Json::object();
  const auto found = json.find(key);
  return found == json.end() || found->is_null() ? none : *found;
}

// The quantile, linear between the neighbours.
double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return not_known;
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - std::floor(place)) * (values[above] - values[below]);
}

struct Moments {
  std::size_t count = 0;
  double mean = 0.0, sum2 = 0.0; // of squares of the distances from the mean (Welford)
  void add(double x) {
    ++count;
    const double before = x - mean;
    mean += before / static_cast<double>(count);
    sum2 += before * (x - mean);
  }
  [[nodiscard]] double mean_or_nan() const { return count > 0 ? mean : not_known; }
  [[nodiscard]] double sd() const {
    return count > 1 ? std::sqrt(sum2 / static_cast<double>(count - 1)) : not_known;
  }
};

// One parameter over the jobs.
class Tally {
public:
  explicit Tally(double truth) : truth_(truth) {}

  void add(const Json& parameter, bool against_truth) {
    const double value = number(parameter, "value"), sigma = number(parameter, "sigma");
    const std::string status = parameter.value("status", "");
    if (status == "fixed") return;
    if (status == "undetermined" || std::isnan(value)) {
      ++undetermined_;
      return;
    }
    values_.push_back(value);
    if (sigma > 0.0) sigmas_.push_back(sigma);
    scatter_.add(value);
    if (!against_truth || std::isnan(truth_) || !(sigma > 0.0)) return;
    constexpr double no_end = std::numeric_limits<double>::infinity();
    const auto holds = [&](const char* low, const char* high) {
      return number(parameter, low, -no_end) <= truth_ && truth_ <= number(parameter, high, no_end);
    };
    within68_ += holds("low68", "high68") ? 1 : 0;
    within95_ += holds("low95", "high95") ? 1 : 0;
    pulls_.add((value - truth_) / sigma);
    error2_ += (value - truth_) * (value - truth_);
  }

  [[nodiscard]] bool empty() const { return values_.empty() && undetermined_ == 0; }

  ParameterScore score(const std::string& name) {
    ParameterScore score;
    score.name = name;
    score.truth = pulls_.count > 0 ? truth_ : not_known;
    score.determined = values_.size();
    score.undetermined = undetermined_;
    const auto judged = static_cast<double>(pulls_.count);
    score.within68 = pulls_.count > 0 ? static_cast<double>(within68_) / judged : not_known;
    score.within95 = pulls_.count > 0 ? static_cast<double>(within95_) / judged : not_known;
    score.mean_pull = pulls_.mean_or_nan();
    score.sd_pull = pulls_.sd();
    score.scatter = scatter_.sd();
    score.rms_error = pulls_.count > 0 ? std::sqrt(error2_ / judged) : not_known;
    score.median = quantile(values_, 0.5);
    score.median_sigma = quantile(sigmas_, 0.5);
    return score;
  }

private:
  double truth_;
  std::size_t undetermined_ = 0, within68_ = 0, within95_ = 0;
  double error2_ = 0.0;
  Moments pulls_, scatter_;
  std::vector<double> values_, sigmas_;
};

// The event of a parameter: 2 for mu@2.
std::size_t event_of(const std::string& name) {
  const std::size_t at = name.find('@');
  return at == std::string::npos ? 0 : std::strtoul(name.c_str() + at + 1, nullptr, 10);
}

class Summing {
public:
  explicit Summing(const BatchHeader& header) {
    summary_.batch = header.batch;
    summary_.jobs = header.jobs;
    summary_.command =
        fmt::format("{} {}", header.json.at("command").get<std::string>(),
                    fmt::join(header.json.at("settings").get<std::vector<std::string>>(), " "));
    const Json& scenario = part(header.json, "scenario");
    summary_.scenario = scenario.value("hash", "");
    summary_.first_seed = scenario.value("seed", std::uint64_t{0});
    for (const auto& [name, value] : part(scenario, "truth").items()) {
      truth_[name] = value.get<double>();
      true_events_ = std::max(true_events_, event_of(name));
    }
  }

  void add(const Json& line) {
    JobRow row;
    row.job = line.at("job").get<std::size_t>();
    row.subject = line.contains("log") ? line["log"].get<std::string>()
                                       : fmt::format("seed {}", line.at("seed").dump());
    row.exit_code = line.at("exit").get<int>();
    row.words = line.value("message", "");
    ++summary_.exits[row.exit_code];
    const Json& result = part(line, "result");
    const Json& fit = result.contains("fit") ? result["fit"] : result;
    if (fit.contains("status")) add_fit(fit, row);
    add_rate(result, row);
    if (result.value("schema", "") == "goingrate.stability")
      for (const Json& one : result["rows"])
        deviations_[number(one, "tau_s")].push_back(number(one, "value"));
    summary_.rows.push_back(std::move(row));
  }

  BatchSummary take() {
    for (auto& [name, tally] : tallies_)
      if (!tally.empty()) summary_.parameters.push_back(tally.score(name));
    for (auto& [tau_s, values] : deviations_) {
      std::erase_if(values, [](double value) { return std::isnan(value); });
      summary_.deviations.push_back({tau_s, values.size(), quantile(values, 0.5),
                                     quantile(values, 0.16), quantile(values, 0.84)});
    }
    return std::move(summary_);
  }

private:
  void add_fit(const Json& fit, JobRow& row) {
    const auto status = fit["status"].get<std::string>();
    ++summary_.statuses[status];
    if (row.words.empty()) row.words = status;
    const Json& model = part(fit, "model");
    if (!model.empty())
      ++summary_.models[fmt::format("{}, {}, {}", model.value("dynamics", ""),
                                    model.value("escapement", ""), model.value("noise", ""))];
    const bool same_events = part(fit, "events").size() == true_events_;
    for (const Json& parameter : part(fit, "parameters")) {
      const auto name = parameter.at("name").get<std::string>();
      const auto known = truth_.find(name);
      const auto tally =
          tallies_.try_emplace(name, known == truth_.end() ? not_known : known->second).first;
      tally->second.add(parameter, event_of(name) == 0 || same_events);
    }
  }

  static void add_rate(const Json& result, JobRow& row) {
    const Json& rate = result.contains("rate") ? result["rate"] : result;
    row.rate_s_per_day = number(rate, "rate_s_per_day");
    row.sigma = number(rate, "rate_sigma_s_per_day");
    const Json& derived = part(part(result, "derived"), "rate_s_per_day");
    if (derived.empty()) return;
    row.rate_s_per_day = number(derived, "value");
    row.sigma = number(derived, "sigma");
  }

  BatchSummary summary_;
  std::map<std::string, double> truth_;
  std::size_t true_events_ = 0;
  std::map<std::string, Tally> tallies_;
  std::map<double, std::vector<double>> deviations_;
};

} // namespace

BatchSummary batch_summary(const std::string& path) {
  BatchFile file(path);
  const BatchHeader& header = file.header();
  if (header.share.n != 1)
    throw InputError({path, 1, 1}, fmt::format("share {} of {}", header.share.k, header.share.n),
                     "a whole batch, as merging all shares makes it");
  Summing sum(header);
  for (std::size_t job = 0; job < header.jobs; ++job) {
    const std::string& line = file.line_of(job);
    try {
      sum.add(Json::parse(line));
    } catch (const nlohmann::json::exception& error) {
      throw InputError({path, job + 2, 1}, error.what(), "a job's line, as batch writes it");
    }
  }
  file.expect_end();
  return sum.take();
}

} // namespace goingrate
