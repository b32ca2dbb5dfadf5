// Turns results into bytes for Python's pickle and back, exact to the last bit. The members of each
// struct are listed in members.hpp.
#pragma once

#include <cstddef>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace goingrate::python {

template <class T> constexpr bool is_plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Appends values to a string of bytes.
class Writer {
public:
  template <class T> void put(const T& value) {
    if constexpr (is_plain<T>)
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    else
      std::apply([this](const auto&... member) { (put(member), ...); }, members(value));
  }
  void put(const std::string& text) { put_all(text); }
  template <class T> void put(const std::vector<T>& values) { put_all(values); }
  template <class T> void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class A, class B> void put(const std::pair<A, B>& pair) {
    put(pair.first);
    put(pair.second);
  }
  template <class K, class V> void put(const std::map<K, V>& entries) {
    put(entries.size());
    for (const auto& [key, value] : entries) {
      put(key);
      put(value);
    }
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
  template <class Values> void put_all(const Values& values) {
    using T = typename Values::value_type;
    put(values.size());
    if constexpr (is_plain<T>)
      bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    else
      for (const T& value : values)
        put(value);
  }

  std::string bytes_;
};

/// Reads what a Writer wrote; throws std::invalid_argument if the bytes end early.
class Reader {
public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <class T> void take(T& value) {
    if constexpr (is_plain<T>)
      std::memcpy(&value, next(sizeof value), sizeof value);
    else
      std::apply([this](auto&... member) { (take(member), ...); }, members(value));
  }
  void take(std::string& text) { take_all(text); }
  template <class T> void take(std::vector<T>& values) { take_all(values); }
  template <class T> void take(std::optional<T>& value) {
    if (taken<bool>())
      take(value.emplace());
    else
      value.reset();
  }
  template <class A, class B> void take(std::pair<A, B>& pair) {
    take(pair.first);
    take(pair.second);
  }
  template <class K, class V> void take(std::map<K, V>& entries) {
    entries.clear();
    for (auto left = taken<std::size_t>(); left > 0; --left) {
      K key = taken<K>();
      take(entries[std::move(key)]);
    }
  }
  template <class T> T taken() {
    T value{};
    take(value);
    return value;
  }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

private:
  const char* next(std::size_t size) {
    if (size > rest_.size()) throw std::invalid_argument("a goingrate pickle that is cut short");
    const char* at = rest_.data();
    rest_.remove_prefix(size);
    return at;
  }
  template <class Values> void take_all(Values& values) {
    using T = typename Values::value_type;
    const auto count = taken<std::size_t>();
    if (count > rest_.size()) next(count); // throws: each element takes at least one byte
    values.resize(count);
    if constexpr (is_plain<T>) {
      if (count > 0) std::memcpy(values.data(), next(count * sizeof(T)), count * sizeof(T));
    } else {
      for (T& value : values)
        take(value);
    }
  }

  std::string_view rest_;
};

/// What a pickle begins with: the kind of thing and the version of its members.
inline constexpr std::string_view archive_version = "goingrate 15 ";

template <class... Parts> std::string archived(std::string_view kind, const Parts&... parts) {
  Writer writer;
  writer.put(std::string(archive_version) + std::string(kind));
  (writer.put(parts), ...);
  return writer.bytes();
}

/// Throws std::invalid_argument for bytes of another kind or version.
template <class... Parts>
void restore(std::string_view kind, std::string_view bytes, Parts&... parts) {
  Reader reader(bytes);
  if (reader.taken<std::string>() != std::string(archive_version) + std::string(kind))
    throw std::invalid_argument("a pickle of another version of goingrate, or of something else");
  (reader.take(parts), ...);
  if (!reader.at_end()) throw std::invalid_argument("a goingrate pickle, and more after it");
}

} // namespace goingrate::python
