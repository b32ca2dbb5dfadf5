#include "log_state.hpp"

#include "archive.hpp"
#include "members.hpp"

namespace goingrate::python {

namespace {

bool is_all_good(const NumberedLog& loaded) {
  return loaded.good.data() == loaded.beats.beats.data();
}

void point_into_itself(NumberedLog& loaded, bool all_good) {
  loaded.good = all_good ? loaded.beats.beats : loaded.chosen;
}

} // namespace

NumberedLog copy_of(const NumberedLog& loaded) {
  NumberedLog copy;
  copy.log = loaded.log;
  copy.beats = loaded.beats;
  copy.chosen = loaded.chosen;
  copy.nominal_period_s = loaded.nominal_period_s;
  copy.nominal_is_known = loaded.nominal_is_known;
  copy.crossings = loaded.crossings;
  copy.sensor = loaded.sensor;
  point_into_itself(copy, is_all_good(loaded));
  return copy;
}

std::string bytes_of(const NumberedLog& loaded) {
  return archived("log", loaded.log, loaded.beats, loaded.chosen, loaded.nominal_period_s,
                  loaded.nominal_is_known, loaded.crossings, loaded.sensor, is_all_good(loaded));
}

NumberedLog log_of(std::string_view bytes) {
  NumberedLog loaded;
  bool all_good = false;
  restore("log", bytes, loaded.log, loaded.beats, loaded.chosen, loaded.nominal_period_s,
          loaded.nominal_is_known, loaded.crossings, loaded.sensor, all_good);
  point_into_itself(loaded, all_good);
  return loaded;
}

} // namespace goingrate::python
