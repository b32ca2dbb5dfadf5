// The published tables that the library reproduces, from the command as a user types it.
#include "support/command_fixture.hpp"
#include "support/published_tables.hpp"

#include <cmath>

namespace goingrate {
namespace {

using test::PublishedTable;

class PublishedByTheCommand : public test::CommandTest,
                              public testing::WithParamInterface<PublishedTable> {};

TEST_P(PublishedByTheCommand, EveryRowIsReproduced) {
  const PublishedTable& table = GetParam();
  const auto data = test::real_data(table.data), file = test::real_data(table.file);
  if (!data || !file) GTEST_SKIP() << "GOINGRATE_SHARED_DATA does not lead to " << table.file;
  const auto printed = test::read_table(*file);
  ASSERT_EQ(printed.size(), table.rows);
  std::string taus;
  for (const test::PrintedRow& row : printed) { // one second each; THEO1 averages over 3/4 of m
    const double share = table.kind == DeviationKind::theo1 ? 0.75 : 1.0;
    taus += fmt::format("{}{}", taus.empty() ? "" : ",", share * static_cast<double>(row.m));
  }
  // As it stands, and told what it is: the reader knows both files by themselves.
  for (const char* told : {"", " --format phase --tau0 1", " --data phase"}) {
    const Outcome done = run(fmt::format(
        "stability '{}'{} --kind {} --taus {} --json s.json{}{}", data->string(), told,
        name_of(table.kind), taus, table.alpha ? fmt::format(" --alpha {}", *table.alpha) : "",
        table.remove_bias ? "" : " --no-bias"));
    ASSERT_EQ(done.code, 0) << done.err;
    const auto rows = json("s.json")["rows"];
    ASSERT_EQ(rows.size(), printed.size());
    for (std::size_t i = 0; i < printed.size(); ++i) {
      SCOPED_TRACE(fmt::format("{}{} m = {}", table.file, told, printed[i].m));
      const double value = rows[i]["value"].get<double>() * std::sqrt(table.variance_factor);
      EXPECT_EQ(rows[i]["m"].get<std::size_t>(), printed[i].m);
      // The bias that is taken off goes with the noise that is identified, which on few points is
      // not always the printed one; the library's own test goes through these with the printed
      // noise.
      if (!std::isnan(printed[i].alpha) && rows[i]["alpha"].get<int>() != printed[i].alpha)
        continue;
      const double unit = std::pow(10.0, std::floor(std::log10(printed[i].value)) - 4.0);
      const double rounding = table.variance_factor == 1.0 ? 0.503 : 1.0; // as in PublishedTables
      EXPECT_NEAR(value, printed[i].value, rounding * unit);
      const double n = static_cast<double>(printed[i].n); // THEO1's are printed to five digits
      EXPECT_NEAR(rows[i]["n"].get<double>(), n,
                  table.kind == DeviationKind::theo1 ? 5e-5 * n : 0.0);
    }
    if (table.data == test::gps) break; // 241,218 phases: once is enough
  }
}

std::string name_of_file(const testing::TestParamInfo<PublishedTable>& info) {
  std::string name(info.param.file.substr(info.param.file.rfind('/') + 1));
  name = name.substr(0, name.rfind('.'));
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Stability, PublishedByTheCommand,
                         testing::ValuesIn(test::published_tables), name_of_file);

class Sp1065ByTheCommand : public test::CommandTest {};

TEST_F(Sp1065ByTheCommand, AThousandFrequenciesAndTheirPhases) {
  const auto frequency = test::real_data("nist1000/nist1000_frequency.txt");
  const auto phase = test::real_data("nist1000/nist1000_phase.txt");
  if (!frequency || !phase) GTEST_SKIP() << "GOINGRATE_SHARED_DATA does not lead to nist1000";
  struct Published {
    const char* kind;
    std::array<double, 3> values; // at 1, 10 and 100 s; SP 1065, p. 108
  };
  for (const Published& row : {Published{"adev", {2.922319e-01, 9.965736e-02, 3.897804e-02}},
                               Published{"oadev", {2.922319e-01, 9.159953e-02, 3.241343e-02}},
                               Published{"mdev", {2.922319e-01, 6.172376e-02, 2.170921e-02}},
                               Published{"tdev", {1.687202e-01, 3.563623e-01, 1.253382e+00}},
                               Published{"hdev", {2.943883e-01, 1.052754e-01, 3.910861e-02}},
                               Published{"ohdev", {2.943883e-01, 9.581083e-02, 3.237638e-02}}})
    for (const std::string& log :
         {fmt::format("'{}' --format frequency --tau0 1", frequency->string()),
          fmt::format("'{}' --data frequency", frequency->string()),
          fmt::format("'{}' --format phase --tau0 1", phase->string())}) {
      ASSERT_EQ(
          run(fmt::format("stability {} --kind {} --taus 1,10,100 --json s.json", log, row.kind))
              .code,
          0);
      const auto rows = json("s.json")["rows"];
      ASSERT_EQ(rows.size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) // printed to seven digits
        EXPECT_NEAR(rows[i]["value"].get<double>(), row.values[i], 6e-7 * row.values[i]) << log;
    }
}

} // namespace
} // namespace goingrate
