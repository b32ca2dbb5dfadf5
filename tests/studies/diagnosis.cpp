// Confusion of causes on clocks drawn from those people have: causes of the list, causes that are
// not in it, pairs, and health.
//   study_diagnosis write FOLDER EACH SEED DAYS    logs, EACH of every kind, of up to DAYS
//   study_diagnosis score BATCH EACH               what `goingrate batch report FOLDER` says of
//   them study_diagnosis log EACH SEED DAYS             both in one, without the fit, which a
//   report has
#include "support/sick_clocks.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

namespace {

using namespace goingrate;

struct Kind {
  std::vector<Cause> faults;
  bool in_list = true;
};

std::vector<Kind> kinds() {
  const std::vector<Cause> list{Cause::slow_drive,       Cause::drive_step,  Cause::friction_step,
                                Cause::growing_friction, Cause::temperature, Cause::pressure,
                                Cause::length_step,      Cause::wheel,       Cause::sensor_shift,
                                Cause::missed_beats,     Cause::rough_drive};
  std::vector<Kind> all;
  for (const Cause cause : list)
    all.push_back({{cause}});
  for (const Cause cause : {Cause::length_drift, Cause::log_clock, Cause::unlogged_weather,
                            Cause::knock, Cause::magnet, Cause::stop})
    all.push_back({{cause}, false});
  all.push_back({{Cause::length_step, Cause::temperature}});
  all.push_back({{Cause::missed_beats, Cause::slow_drive}});
  all.push_back({{Cause::wheel, Cause::growing_friction}});
  all.push_back({{}});
  return all;
}

std::string words_for(const std::vector<Cause>& faults) {
  std::string words;
  for (const Cause fault : faults)
    words += (words.empty() ? "" : " and ") + std::string(name_of(fault));
  return words.empty() ? "healthy" : words;
}

struct Study {
  std::size_t each = 10;
  std::uint64_t seed = 1;
  double days = 3.0;

  // The i-th clock of all, in order of kinds.
  [[nodiscard]] test::SickClock clock(std::size_t i) const {
    RandomStream chance(seed + i, StreamPurpose::jitter);
    return {kinds().at(i / each).faults, std::pow(days, chance.uniform()), seed + i};
  }
  [[nodiscard]] std::size_t size() const { return each * kinds().size(); }
};

using Found = std::vector<std::vector<Suspicion>>; // one a clock

void print(const Found& found, std::size_t each) {
  std::map<std::string, std::pair<int, std::size_t>> shares;
  std::printf("%-34s right  named first\n", "truth");
  std::size_t i = 0;
  for (const Kind& kind : kinds()) {
    std::map<std::string, int> named;
    int right = 0;
    for (std::size_t k = 0; k < each; ++k) {
      const auto& suspicions = found.at(i++);
      ++named[suspicions.empty() ? "healthy" : std::string(name_of(suspicions[0].cause))];
      right += kind.faults.empty() ? suspicions.empty()
                                   : test::is_named(suspicions, kind.faults, kind.in_list);
    }
    auto& [sum, of] = shares[kind.faults.empty()      ? "healthy"
                             : !kind.in_list          ? "not in the list"
                             : kind.faults.size() > 1 ? "pairs"
                                                      : "in the list"];
    sum += right;
    of += each;
    std::printf("%-34s %2d/%zu ", words_for(kind.faults).c_str(), right, each);
    for (const auto& [name, times] : named)
      std::printf(" %s %d,", name.c_str(), times);
    std::printf("\n");
  }
  for (const auto& [name, share] : shares)
    std::printf("%-16s %.3f of %zu\n", name.c_str(),
                share.first / static_cast<double>(share.second), share.second);
}

// The number of each log's clock is its name, so that their order is that of the clocks.
void write(const Study& study, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < study.size(); ++i)
    std::ofstream(folder / fmt::format("{:05}.csv", i)) << test::Clinic(study.clock(i)).log();
}

Cause cause_named(const std::string& name) {
  int i = 0;
  while (name_of(static_cast<Cause>(i)) != name)
    ++i;
  return static_cast<Cause>(i);
}

Found found_in(const std::string& batch) {
  std::ifstream file(batch);
  std::string line;
  std::getline(file, line); // of the batch itself
  Found found;
  while (std::getline(file, line)) {
    const auto json = nlohmann::json::parse(line);
    if (json["exit"] != 0) throw std::runtime_error(json["message"].get<std::string>());
    std::vector<Suspicion> suspicions;
    for (const auto& one : json["result"]["causes"]) {
      Suspicion suspicion;
      suspicion.cause = cause_named(one["cause"]);
      for (const auto& other : one["against"])
        suspicion.alternatives.push_back(cause_named(other));
      suspicions.push_back(suspicion);
    }
    found.push_back(suspicions);
  }
  return found;
}

Found found_without_fit(const Study& study) {
  Found found(study.size());
  const auto half = [&](std::size_t begin) {
    for (std::size_t i = begin; i < found.size(); i += 2)
      found[i] = test::suspected(study.clock(i));
  };
  std::thread other(half, 1);
  half(0);
  other.join();
  return found;
}

} // namespace

int main(int count, char** words) {
  const std::string what = count > 1 ? words[1] : "";
  Study study;
  const int first = what == "log" ? 2 : 3;
  if (count > first) study.each = static_cast<std::size_t>(std::atoi(words[first]));
  if (count > first + 1) study.seed = static_cast<std::uint64_t>(std::atoll(words[first + 1]));
  if (count > first + 2) study.days = std::atof(words[first + 2]);
  if (what == "write" && count > 2)
    write(study, words[2]);
  else if (what == "score" && count > 2)
    print(found_in(words[2]), study.each);
  else if (what == "log")
    print(found_without_fit(study), study.each);
  else
    return 2;
}
