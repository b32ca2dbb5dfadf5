#include "goingrate/analysis/batch.hpp"

#include "goingrate/base/errors.hpp"
#include "support/scratch_folder.hpp"

#include <algorithm>
#include <atomic>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace goingrate {
namespace {

// Jobs whose lines tell their numbers; every seventh fails, without or with a result.
std::vector<JobOutcome> outcomes_of(std::span<const std::size_t> jobs) {
  std::vector<JobOutcome> outcomes;
  for (const std::size_t job : jobs) {
    JobOutcome outcome;
    if (job % 7 != 3) outcome.result = fmt::format("{{\"square\": {},\n \"x\": 0.1}}\n", job * job);
    if (job % 7 == 3 || job % 7 == 4) {
      outcome.exit_code = 4;
      outcome.message = "no \"fit\":\nit stalled";
    }
    outcome.assumed = {"something"};
    outcomes.push_back(outcome);
  }
  return outcomes;
}

class BatchTest : public test::ScratchFolderTest {
protected:
  [[nodiscard]] BatchRequest request(const std::string& name, BatchShare share = {}) const {
    BatchRequest request;
    request.description = {
        "fit", {"--fix", "T0=2"}, 50, {}, BatchScenario{"h", 11, {{"mu", 2e-5}}}};
    request.share = share;
    request.output = path(name);
    request.threads = 2;
    request.at_once = 3;
    request.make_worker = [] { return outcomes_of; };
    return request;
  }

  // All shares of a batch, in files that begin with `name`.
  [[nodiscard]] std::vector<std::string> shares(const std::string& name, std::size_t n) const {
    std::vector<std::string> files;
    for (std::size_t k = 1; k <= n; ++k) {
      BatchRequest part = request(fmt::format("{}-{}", name, k), {k, n});
      part.threads = 1 + k % 3;
      part.at_once = k;
      run_batch(part);
      files.push_back(part.output);
    }
    return files;
  }

  [[nodiscard]] std::string merged(const std::vector<std::string>& files) const {
    merge_batch(files, path("merged"));
    return content("merged");
  }

  // What merging says; empty if it is done.
  [[nodiscard]] std::string refusal(const std::vector<std::string>& files) const {
    try {
      merge_batch(files, path("refused"));
    } catch (const InputError& error) {
      EXPECT_FALSE(exists("refused"));
      return error.what();
    }
    return {};
  }
};

TEST_F(BatchTest, SharesAndThreadsChangeNoByte) {
  run_batch(request("one"));
  const std::string one = content("one");
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), 51);
  EXPECT_FALSE(exists("one.part"));
  for (const std::size_t n : {1u, 7u, 20u, 50u, 60u}) { // of 60 some hold no job
    auto files = shares(fmt::format("of{}", n), n);
    std::reverse(files.begin(), files.end());
    EXPECT_EQ(merged(files), one) << n;
  }
  BatchRequest alone = request("alone");
  alone.threads = alone.at_once = 1;
  run_batch(alone);
  EXPECT_EQ(content("alone"), one);
}

TEST_F(BatchTest, ALineTellsAllOfItsJob) {
  const BatchOutcome outcome = run_batch(request("one"));
  EXPECT_EQ(outcome.jobs, 50u);
  EXPECT_EQ(outcome.failed, 14u); // 3, 4, 10, 11, 17, ... 46
  std::istringstream lines(content("one"));
  std::string line;
  std::getline(lines, line);
  const auto header = nlohmann::json::parse(line);
  EXPECT_EQ(header["jobs"], 50);
  EXPECT_EQ(header["command"], "fit");
  EXPECT_EQ(header["scenario"]["truth"]["mu"], 2e-5);
  for (std::size_t i = 0; std::getline(lines, line); ++i) {
    const auto json = nlohmann::json::parse(line);
    EXPECT_EQ(json["job"], i);
    EXPECT_EQ(json["seed"], 11 + i);
    EXPECT_EQ(json["scenario"], "h");
    EXPECT_TRUE(json["versions"]["ceres"].is_string());
    EXPECT_EQ(json["exit"], i % 7 == 3 || i % 7 == 4 ? 4 : 0);
    EXPECT_EQ(json.contains("message"), json["exit"] != 0);
    if (i % 7 == 3)
      EXPECT_TRUE(json["result"].is_null());
    else
      EXPECT_EQ(json["result"]["square"], i * i);
  }
}

TEST_F(BatchTest, MergingRefusesWhatIsNoWholeBatch) {
  auto files = shares("part", 7);
  auto missing = files;
  missing.erase(missing.begin() + 2);
  EXPECT_NE(refusal(missing).find("6 of 7 shares, expected all; missing: 3"), std::string::npos);
  auto doubled = files;
  doubled.push_back(files[4]);
  EXPECT_NE(refusal(doubled).find("share 5 again"), std::string::npos);
  auto replaced = files;
  replaced[1] = files[0];
  EXPECT_NE(refusal(replaced).find("share 1 again"), std::string::npos);

  for (int what = 0; what < 5; ++what) { // another batch in one respect each
    BatchRequest other = request("other", {3, 7});
    BatchDescription& batch = other.description;
    if (what == 0) batch.settings.back() = "T0=3";
    if (what == 1) batch.command = "report";
    if (what == 2) batch.scenario->seed = 12;
    if (what == 3) batch.scenario->hash = "g";
    if (what == 4) batch.jobs = 49;
    run_batch(other);
    auto foreign = files;
    foreign[2] = other.output;
    EXPECT_NE(refusal(foreign).find("share 3/7 of the batch"), std::string::npos) << what;
  }
  const auto eight = shares("eighth", 8);
  auto mixed = files;
  mixed[0] = eight[0];
  EXPECT_NE(refusal(mixed).find("share 1/8"), std::string::npos);
}

TEST_F(BatchTest, MergingRefusesADamagedShare) {
  const auto files = shares("part", 7);
  const std::string whole = content("part-2");
  const auto damaged = [&](const std::string& text) {
    put("part-2", text);
    return refusal(files);
  };
  EXPECT_NE(damaged("").find("cannot be read"), std::string::npos);
  EXPECT_NE(damaged("{}\n").find("schema"), std::string::npos);
  EXPECT_NE(damaged(whole.substr(0, whole.size() - 1)).find("the end of the file"),
            std::string::npos);
  EXPECT_NE(damaged(whole.substr(0, whole.rfind('\n', whole.size() - 2) + 1)).find("part-2:"),
            std::string::npos);
  EXPECT_NE(damaged(whole + "x\n").find("more lines"), std::string::npos);
  const std::size_t second = whole.find('\n') + 1, third = whole.find('\n', second) + 1;
  EXPECT_NE(
      damaged(whole.substr(0, second) + whole.substr(third)).find("found job 8, expected job 1"),
      std::string::npos);
  EXPECT_EQ(damaged(whole), "");
}

TEST_F(BatchTest, AKilledBatchIsTakenUp) {
  run_batch(request("whole"));
  BatchRequest killed = request("killed");
  killed.at_once = 1;
  std::atomic<int> left = 20;
  killed.make_worker = [&]() -> BatchWorker {
    return [&](std::span<const std::size_t> jobs) {
      if (--left < 0) throw std::runtime_error("the power went");
      return outcomes_of(jobs);
    };
  };
  EXPECT_THROW(run_batch(killed), std::runtime_error);
  EXPECT_FALSE(exists("killed"));
  put("killed.part", content("killed.part") + "{\"job\":49,\"se"); // a line that was being written

  std::atomic<int> done = 0;
  killed.make_worker = [&]() -> BatchWorker {
    return [&](std::span<const std::size_t> jobs) {
      done += static_cast<int>(jobs.size());
      return outcomes_of(jobs);
    };
  };
  EXPECT_THROW(run_batch(killed), UnfinishedBatch);
  EXPECT_EQ(done, 0);
  killed.resume = true;
  const BatchOutcome outcome = run_batch(killed);
  EXPECT_EQ(outcome.taken_up, 20u);
  EXPECT_EQ(done, 30);
  EXPECT_EQ(content("killed"), content("whole"));
  EXPECT_FALSE(exists("killed.part"));
  run_batch(killed); // all is there
  EXPECT_EQ(done, 30);
}

TEST_F(BatchTest, WhatBelongsElsewhereIsNotTakenUp) {
  BatchRequest own = request("one", {2, 5});
  run_batch(own);
  own.resume = true;
  own.share = {3, 5};
  EXPECT_THROW(run_batch(own), InputError);
  own.share = {2, 5};
  EXPECT_EQ(run_batch(own).taken_up, 10u);
  own.description.settings = {};
  EXPECT_THROW(run_batch(own), InputError);
  put("two.part", content("one"));
  BatchRequest two = request("two", {3, 5});
  two.resume = true;
  EXPECT_THROW(run_batch(two), InputError);
  put("two.part", "some notes\n");
  EXPECT_THROW(run_batch(two), InputError);
  EXPECT_EQ(content("two.part"), "some notes\n");
}

TEST_F(BatchTest, SharesAreNamedAsFractions) {
  EXPECT_EQ(parse_share("3/20").k, 3u);
  EXPECT_EQ(parse_share("3/20").n, 20u);
  for (const char* text :
       {"", "3", "0/2", "3/2", "1/", "/2", "1/2/3", "-1/2", "1/0", "a/b", "1 /2"})
    EXPECT_THROW(parse_share(text), ArgumentError) << text;
}

TEST_F(BatchTest, AScenarioIsNamedByAllThatMakesIt) {
  const std::vector<std::string> none, some{"clock.mu=3e-5"};
  const std::vector<double> steady, series{1.0, 1.1};
  // uuid.uuid5(uuid.NAMESPACE_OID, "x") of Python
  EXPECT_EQ(scenario_hash("x", none, steady), "8558d34a-d3c6-5881-a6e3-bf8f3e6110ea");
  EXPECT_NE(scenario_hash("x", none, steady), scenario_hash("y", none, steady));
  EXPECT_NE(scenario_hash("x", none, steady), scenario_hash("x", some, steady));
  EXPECT_NE(scenario_hash("x", none, steady), scenario_hash("x", none, series));
}

} // namespace
} // namespace goingrate
