#include "support/command_fixture.hpp"

#include <thread>

namespace goingrate::test {
namespace {

class BatchCommandTest : public CommandTest {
protected:
  [[nodiscard]] std::vector<nlohmann::json> lines(const std::string& name) const {
    std::ifstream file(folder_ / name);
    std::vector<nlohmann::json> all;
    for (std::string line; std::getline(file, line);)
      all.push_back(nlohmann::json::parse(line));
    return all;
  }
  // 40 clocks of a few hundred beats.
  static std::string realisations() {
    return "batch --scenario " + scenario("jump") +
           " --set run.periods=400 --realisations 40 --seed 5 -- fit --fix T0=2 --event 150:mu ";
  }
};

TEST_F(BatchCommandTest, SharesAndThreadsChangeNoByte) {
  ASSERT_EQ(run(realisations() + "-o one.jsonl --threads 2").code, 0);
  const std::string one = content(folder_ / "one.jsonl");
  EXPECT_EQ(run(realisations() + "--threads 1").out, one); // to standard output
  for (const int n : {1, 7, 20}) {
    std::string names;
    for (int k = 1; k <= n; ++k) {
      const std::string name = fmt::format("share-{}-{}.jsonl", n, k);
      const std::string options = fmt::format("--share {}/{} --threads {}", k, n, 1 + k % 2);
      ASSERT_EQ(run(realisations() + "-o " + name + " " + options).code, 0);
      names = " " + name + names;
    }
    const Outcome merged = run("batch merge -o merged.jsonl" + names);
    ASSERT_EQ(merged.code, 0) << merged.err;
    EXPECT_EQ(content(folder_ / "merged.jsonl"), one) << n;
  }
}

TEST_F(BatchCommandTest, ARealisationIsWhatSimulateAndFitMakeOfIt) {
  ASSERT_EQ(run(realisations() + "-o batch.jsonl").code, 0);
  ASSERT_EQ(run("simulate " + scenario("jump") + " --set run.periods=400 --seed 22 -o 22.csv").code,
            0);
  ASSERT_EQ(run("fit 22.csv --fix T0=2 --event 150:mu --json 22.json").code, 0);
  const auto line = lines("batch.jsonl").at(1 + 17);
  EXPECT_EQ(line["seed"], 22);
  EXPECT_EQ(line["result"], json("22.json"));
}

TEST_F(BatchCommandTest, ALogIsWhatItsCommandMakesOfIt) {
  const std::string log = (source / "data/logs/jump.csv").string();
  for (const std::string& command : {std::string("fit --fix T0=2"), std::string("rate"),
                                     std::string("stability --taus decade --kind mdev")}) {
    const std::size_t space = std::min(command.find(' '), command.size());
    const std::string words = command.substr(0, space) + " " + log + command.substr(space);
    ASSERT_EQ(run(words + " --json alone.json").code, 0);
    ASSERT_EQ(run("batch " + words + " -o batch.jsonl").code, 0);
    EXPECT_EQ(lines("batch.jsonl").at(1)["result"], json("alone.json")) << command;
  }
}

TEST_F(BatchCommandTest, AReportLacksTheArraysAlone) {
  const std::string log = (source / "data/logs/jump.csv").string();
  ASSERT_EQ(run("report " + log + " -o page.html --json alone.json").code, 0);
  ASSERT_EQ(run("batch report " + log + " -o batch.jsonl").code, 0);
  auto alone = json("alone.json");
  alone["spectrum"]["frequency_hz"] = alone["spectrum"]["density"] = nlohmann::json::array();
  EXPECT_EQ(lines("batch.jsonl").at(1)["result"], alone);
}

TEST_F(BatchCommandTest, AJobThatFailsIsALine) {
  std::filesystem::create_directories(folder_ / "logs");
  std::filesystem::copy_file(source / "data/logs/jump.csv", folder_ / "logs/a.csv");
  put("logs/b.csv", "nothing\n");
  put("logs/c.csv", "1\n2\n");
  put("logs/.hidden", "1\n2\n");
  std::filesystem::copy_file(source / "data/logs/jump.csv", folder_ / "logs/d.csv");
  const Outcome done = run("batch fit logs none.csv 'logs/[a]*' --fix T0=2 -o out.jsonl");
  EXPECT_EQ(done.code, 0);
  EXPECT_NE(done.err.find("3 jobs failed"), std::string::npos) << done.err;
  const auto all = lines("out.jsonl");
  ASSERT_EQ(all.size(), 7u);
  const std::vector<std::string> names{"logs/a.csv", "logs/b.csv", "logs/c.csv",
                                       "logs/d.csv", "none.csv",   "logs/a.csv"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(all[i + 1]["log"], names[i]);
    // What the command alone says and how it ends.
    const Outcome alone = run("fit --quiet " + names[i] + " --fix T0=2");
    EXPECT_EQ(all[i + 1]["exit"], alone.code) << names[i];
    if (alone.code == 0) continue;
    EXPECT_EQ(alone.err.find("goingrate: " + all[i + 1]["message"].get<std::string>()), 0u)
        << alone.err;
  }
  const Outcome summary = run("batch summary out.jsonl --json summary.json");
  ASSERT_EQ(summary.code, 0) << summary.err;
  EXPECT_NE(summary.out.find("6 jobs, 3 of them failed"), std::string::npos) << summary.out;
  EXPECT_EQ(json("summary.json")["statuses"]["converged"], 3);
}

TEST_F(BatchCommandTest, ASettingMayFollowTheLog) {
  for (const char* name : {"a", "b"})
    std::filesystem::copy_file(source / "data/logs/jump.csv",
                               folder_ / (std::string(name) + ".csv"));
  put("a.par", "# goingrate par 1\nEVENT 150 mu\nT0 2 0\n");
  put("b.par", "# goingrate par 1\nEVENT 150 mu\nT0 2 1\n");
  ASSERT_EQ(run("batch fit a.csv b.csv --from {.}.par -o out.jsonl").code, 0);
  const auto all = lines("out.jsonl");
  EXPECT_EQ(all.at(0)["settings"], nlohmann::json({"--from", "{.}.par"}));
  for (const auto& [i, status] : {std::pair{1, "fixed"}, std::pair{2, "free"}})
    for (const auto& parameter : all.at(static_cast<std::size_t>(i))["result"]["parameters"])
      EXPECT_TRUE(parameter["name"] != "T0" || parameter["status"] == status) << parameter;
}

// The batch is ended by a signal when some of its lines are there, and taken up.
class InterruptedBatchTest : public BatchCommandTest, public testing::WithParamInterface<int> {};

TEST_P(InterruptedBatchTest, IsTakenUp) {
  const std::string words = realisations() + "--set run.periods=2000 -o out.jsonl --threads 2";
  ASSERT_EQ(run(realisations() + "--set run.periods=2000 -o whole.jsonl").code, 0);
  const std::string interrupted =
      fmt::format("cd '{0}'; env --default-signal=INT '{1}' {2} 2> err.txt & pid=$!; "
                  "while [ \"$(wc -l < out.jsonl.part 2> /dev/null || echo 0)\" -lt 5 ] "
                  "&& kill -0 $pid 2> /dev/null; do sleep 0.01; done; kill -{3} $pid; "
                  "wait $pid; echo $? > code.txt",
                  folder_.string(), GOINGRATE_COMMAND, words, GetParam());
  // A shell without job control has its children ignore SIGINT; bash -m has not, nor env whatever
  // the tests themselves were started with.
  std::ofstream(folder_ / "kill.sh") << interrupted;
  ASSERT_EQ(std::system(fmt::format("bash -m '{}/kill.sh' 2> /dev/null", folder_.string()).c_str()),
            0);
  ASSERT_EQ(content(folder_ / "code.txt"), fmt::format("{}\n", 128 + GetParam()));
  ASSERT_FALSE(std::filesystem::exists(folder_ / "out.jsonl"));
  const Outcome refused = run(words);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--resume"), std::string::npos) << refused.err;
  const Outcome done = run(words + " --resume");
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_NE(done.err.find("of 40 jobs were done before"), std::string::npos) << done.err;
  EXPECT_EQ(content(folder_ / "out.jsonl"), content(folder_ / "whole.jsonl"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.jsonl.part"));
}
INSTANTIATE_TEST_SUITE_P(Signals, InterruptedBatchTest, testing::Values(2, 9, 15));

TEST_F(BatchCommandTest, SummaryJudgesByTheTruth) {
  ASSERT_EQ(run(realisations() + "-o out.jsonl").code, 0);
  ASSERT_EQ(run("batch summary out.jsonl --json summary.json").code, 0);
  const auto summary = json("summary.json");
  EXPECT_EQ(summary["jobs"], 40);
  int judged = 0;
  for (const auto& p : summary["parameters"]) {
    if (p["truth"].is_null()) continue;
    ++judged;
    EXPECT_EQ(p["determined"], 40) << p;
    // Fewer than 17 of 40 honest 68 % intervals hold the truth once in 500 times.
    EXPECT_GE(p["within68"], 17.0 / 40.0) << p;
    EXPECT_GE(p["within95"], 33.0 / 40.0) << p; // once in 1000
    EXPECT_NEAR(p["sd_pull"], 1.0, 0.36) << p;  // three times its own sigma, 1/sqrt(80)
  }
  EXPECT_EQ(judged, 6); // epsilon, jitter_rms, lambda0, mu, mu@1, phi0
}

TEST_F(BatchCommandTest, WrongWordsAreUsage) {
  const std::string jump = scenario("jump");
  const auto says = [&](const std::string& words, const std::string& what) {
    const Outcome outcome = run("batch " + words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << words << '\n' << outcome.err;
  };
  says("", "expected what each job does");
  says("fitt a.csv", "did you mean fit?");
  says("fit", "expected logs, or --scenario");
  says("fit a.csv --par x.par", "--par");
  says("fit a.csv --share 3/2", "k/n");
  says("fit a.csv --shar 1/2", "did you mean --share?");
  says("fit a.csv --resume", "-o FILE");
  says("fit a.csv --fix", "--fix");
  says("--scenario " + jump + " fit", "--realisations go together");
  says("--scenario " + jump + " --realisations 2 fit a.csv", "none beside --scenario");
  says("--scenario " + jump + " --set clock.mu=x --realisations 2 fit", "--set");
  says("fit -", "standard input");
  EXPECT_EQ(run("batch merge none.jsonl").code, 3);
  EXPECT_EQ(run("batch summary none.jsonl").code, 3);
  EXPECT_EQ(run("batch --scenario none.toml --realisations 2 fit").code, 3);
}

} // namespace
} // namespace goingrate::test
