#include "goingrate/analysis/batch_summary.hpp"

#include "goingrate/analysis/batch.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/report/batch_report.hpp"
#include "support/scratch_folder.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace goingrate {
namespace {

using Json = nlohmann::json;

class BatchSummaryTest : public test::ScratchFolderTest {
protected:
  // A batch whose i-th job has the i-th outcome.
  void write(BatchDescription batch, const std::vector<JobOutcome>& outcomes,
             BatchShare share = {}) const {
    batch.jobs = outcomes.size();
    BatchRequest request;
    request.description = batch;
    request.share = share;
    request.output = path("batch");
    request.make_worker = [&] {
      return [&](std::span<const std::size_t> jobs) {
        std::vector<JobOutcome> own;
        for (const std::size_t job : jobs)
          own.push_back(outcomes[job]);
        return own;
      };
    };
    run_batch(request);
  }

  static Json parameter(const std::string& name, double value, double sigma) {
    return {{"name", name},           {"value", value},          {"sigma", sigma},
            {"low68", value - sigma}, {"high68", value + sigma}, {"low95", value - 2.0 * sigma},
            {"high95", nullptr},      {"status", "free"}};
  }
  static JobOutcome fit(const std::vector<Json>& parameters, std::size_t events) {
    const Json json = {
        {"schema", "goingrate.fit"},
        {"status", "converged"},
        {"model", {{"dynamics", "map"}, {"escapement", "none"}, {"noise", "jitter"}}},
        {"parameters", parameters},
        {"events", std::vector<Json>(events, Json::object())},
        {"derived", {{"rate_s_per_day", {{"value", 1.5}, {"sigma", 0.25}}}}}};
    JobOutcome outcome;
    outcome.result = json.dump();
    return outcome;
  }
};

const BatchDescription realisations{
    "fit", {}, 0, {}, BatchScenario{"hash", 5, {{"epsilon", 10.0}, {"mu@1", 4.0}}}};

TEST_F(BatchSummaryTest, CountsAgainstTheTruth) {
  JobOutcome failed;
  failed.exit_code = 4;
  failed.message = "it stalled";
  Json blind = parameter("epsilon", 0.0, 0.0);
  blind["value"] = blind["sigma"] = nullptr;
  blind["status"] = "undetermined";
  Json held = parameter("T0", 2.0, 0.0);
  held["status"] = "fixed";
  write(realisations,
        {fit({parameter("epsilon", 11.0, 2.0), held}, 1),                        // pull 0.5
         fit({parameter("epsilon", 7.0, 2.0), parameter("mu@1", 4.0, 1.0)}, 1),  // -1.5
         fit({parameter("epsilon", 16.0, 2.0), parameter("mu@1", 9.0, 1.0)}, 2), // 3
         fit({parameter("epsilon", -10.0, 2.0)}, 0), // -10: the interval is open above
         fit({blind}, 1), failed});
  const BatchSummary summary = batch_summary(path("batch"));
  EXPECT_EQ(summary.exits.at(0), 5u);
  EXPECT_EQ(summary.exits.at(4), 1u);
  EXPECT_EQ(summary.statuses.at("converged"), 5u);
  EXPECT_EQ(summary.rows.at(5).words, "it stalled");
  EXPECT_EQ(summary.rows.at(0).subject, "seed 5");
  EXPECT_DOUBLE_EQ(summary.rows.at(0).rate_s_per_day, 1.5);
  ASSERT_EQ(summary.parameters.size(), 2u); // T0 is not fitted
  const ParameterScore& epsilon = summary.parameters[0];
  EXPECT_EQ(epsilon.name, "epsilon");
  EXPECT_EQ(epsilon.determined, 4u);
  EXPECT_EQ(epsilon.undetermined, 1u);
  EXPECT_DOUBLE_EQ(epsilon.within68, 0.25);
  EXPECT_DOUBLE_EQ(epsilon.within95, 0.75); // all but 16
  EXPECT_DOUBLE_EQ(epsilon.mean_pull, -2.0);
  EXPECT_NEAR(epsilon.sd_pull, std::sqrt((6.25 + 0.25 + 25.0 + 64.0) / 3.0), 1e-12);
  EXPECT_NEAR(epsilon.scatter, 2.0 * epsilon.sd_pull, 1e-12); // all have one sigma
  EXPECT_NEAR(epsilon.rms_error, std::sqrt((1.0 + 9.0 + 36.0 + 400.0) / 4.0), 1e-12);
  EXPECT_DOUBLE_EQ(epsilon.median, 9.0);
  const ParameterScore& jump = summary.parameters[1];
  EXPECT_EQ(jump.determined, 2u);
  EXPECT_DOUBLE_EQ(jump.within68, 1.0); // of two events the first need not be the scenario's
  EXPECT_DOUBLE_EQ(jump.mean_pull, 0.0);
}

TEST_F(BatchSummaryTest, LogsHaveRows) {
  JobOutcome rate, none;
  rate.result =
      R"({"schema": "goingrate.rate", "rate_s_per_day": -3.0, "rate_sigma_s_per_day": 0.5})";
  none.exit_code = 3;
  none.message = "b.csv: found nothing";
  write({"rate", {}, 2, {"a.csv", "b.csv"}}, {rate, none});
  const BatchSummary summary = batch_summary(path("batch"));
  EXPECT_DOUBLE_EQ(summary.rows.at(0).rate_s_per_day, -3.0);
  EXPECT_DOUBLE_EQ(summary.rows.at(0).sigma, 0.5);
  EXPECT_TRUE(std::isnan(summary.rows.at(1).rate_s_per_day));
  const std::string text = batch_text(summary);
  EXPECT_NE(text.find("a.csv"), std::string::npos);
  EXPECT_NE(text.find("exit 3: b.csv: found nothing"), std::string::npos);
  const Json json = Json::parse(batch_json(summary));
  EXPECT_EQ(json["schema"], "goingrate.batch-summary");
  EXPECT_EQ(json["rows"][0]["rate_s_per_day"], -3.0);
  EXPECT_TRUE(json["rows"][1]["rate_s_per_day"].is_null());
}

TEST_F(BatchSummaryTest, DeviationsAreThoseOfAllJobs) {
  std::vector<JobOutcome> outcomes(5);
  for (int i = 0; i < 5; ++i)
    outcomes[static_cast<std::size_t>(i)].result = Json{
        {"schema", "goingrate.stability"},
        {"rows",
         {{{"tau_s", 2.0}, {"value", 1.0 + i}}}}}.dump();
  write({"stability", {}, 5, {"a", "b", "c", "d", "e"}}, outcomes);
  const BatchSummary summary = batch_summary(path("batch"));
  ASSERT_EQ(summary.deviations.size(), 1u);
  EXPECT_EQ(summary.deviations[0].jobs, 5u);
  EXPECT_DOUBLE_EQ(summary.deviations[0].median, 3.0);
  EXPECT_DOUBLE_EQ(summary.deviations[0].low, 1.64);
}

TEST_F(BatchSummaryTest, AShareIsNotTheWhole) {
  write(realisations, std::vector<JobOutcome>(6), {2, 3});
  EXPECT_THROW(static_cast<void>(batch_summary(path("batch"))), InputError);
}

} // namespace
} // namespace goingrate
