#include "base/spelling.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

TEST(SpellingTest, FindsTheWordThatWasMeant) {
  const std::vector<std::string> known{"epsilon", "mu", "phi0", "nominal_period", "figures", "fix"};
  const auto meant = [&](std::string_view word) {
    return nearest_word(word, known).value_or("nothing");
  };
  EXPECT_EQ(meant("epsilonn"), "epsilon");
  EXPECT_EQ(meant("epsiln"), "epsilon");
  EXPECT_EQ(meant("espilon"), "epsilon") << "neighbours exchanged are one slip";
  EXPECT_EQ(meant("nominalperiod"), "nominal_period");
  EXPECT_EQ(meant("nom"), "nominal_period") << "its beginning";
  EXPECT_EQ(meant("period"), "nominal_period") << "a part of it";
  EXPECT_EQ(meant("inal"), "nothing") << "the middle of a part";
  EXPECT_EQ(meant("fic"), "fix");
  EXPECT_EQ(meant("fig"), "figures") << "the first of two that are a slip away";
  EXPECT_EQ(meant("figs"), "nothing") << "two slips in four letters";
  EXPECT_EQ(meant("MU"), "mu") << "capitals are no slip";
  EXPECT_EQ(meant("Phi0"), "phi0");
  EXPECT_EQ(meant("no"), "nothing");
  EXPECT_EQ(meant("lambda"), "nothing");
  EXPECT_EQ(meant(""), "nothing");
  const std::vector<std::string> options{"--event", "--taus"};
  EXPECT_EQ(nearest_word("event", options), "--event");
  EXPECT_FALSE(nearest_word("--start", options));
  EXPECT_FALSE(nearest_word("mu", {}));
}

} // namespace
} // namespace goingrate
