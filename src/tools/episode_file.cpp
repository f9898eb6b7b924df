#include "episode_file.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <limits>
#include <type_traits>

#include "core/io/input_error.hpp"
#include "crc32.hpp"
#include "result_files.hpp"

namespace fail_aware {

namespace {

namespace fs = std::filesystem;

const std::string kBegin = "fail_aware episodes 3\n", kEnd = "end of the episodes\n";

class Writer {
 public:
  explicit Writer(std::ofstream& file) : file_(file) {}

  template <class Value>
  std::enable_if_t<std::is_arithmetic_v<Value> || std::is_enum_v<Value>> operator()(const Value& value) {
    put(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint64_t>(text.size()));
    put(text.data(), text.size());
  }
  template <class Item>
  void operator()(const std::vector<Item>& items) {
    (*this)(static_cast<std::uint64_t>(items.size()));
    for (const Item& item : items) visitItem(*this, item);
  }
  void put(const char* bytes, std::size_t count) {
    crc_.add(bytes, count);
    file_.write(bytes, static_cast<std::streamsize>(count));
  }
  void writeCrc() { (*this)(crc_.value()); }

 private:
  std::ofstream& file_;
  Crc32 crc_;
};

class Reader {
 public:
  Reader(std::ifstream& file, const fs::path& path) : file_(file), path_(path), left_(fs::file_size(path)) {}

  template <class Value>
  std::enable_if_t<std::is_arithmetic_v<Value> || std::is_enum_v<Value>> operator()(Value& value) {
    take(reinterpret_cast<char*>(&value), sizeof value);
  }
  void operator()(std::string& text) {
    text.resize(size());
    take(text.data(), text.size());
  }
  template <class Item>
  void operator()(std::vector<Item>& items) {
    const std::size_t count = size();
    items.clear();
    items.reserve(std::min<std::size_t>(count, left_ / sizeof(Item)));  // a damaged count does not take all memory
    while (items.size() < count) visitItem(*this, items.emplace_back());
  }
  void expect(const std::string& text) {
    if (text.size() > left_) fail();
    std::string found(text.size(), ' ');
    take(found.data(), found.size());
    if (found != text) fail();
  }
  void checkCrc() {
    const std::uint32_t of_bytes = crc_.value();
    std::uint32_t written = 0;
    (*this)(written);
    if (written != of_bytes) fail();
  }

 private:
  /// A number of items is never larger than the bytes that are left.
  std::size_t size() {
    std::uint64_t count = 0;
    (*this)(count);
    if (count > left_) fail();
    return static_cast<std::size_t>(count);
  }
  void take(char* bytes, std::size_t count) {
    if (count > left_ || !file_.read(bytes, static_cast<std::streamsize>(count))) fail();
    crc_.add(bytes, count);
    left_ -= count;
  }
  [[noreturn]] void fail() const {
    throw InputError(path_.string() +
                     ": not a complete and undamaged file of episodes of this version; run evaluate_fail_aware "
                     "--keep-episodes again");
  }

  std::ifstream& file_;
  fs::path path_;
  std::uintmax_t left_;
  Crc32 crc_;
};

template <class Visitor, class Time>
void visitTime(Visitor& v, Time& time) {
  v(time.status);
  v(time.seconds);
}

template <class Visitor, class Output>
void visitOutput(Visitor& v, Output& output) {
  v(output.stamp_s);
  v(output.t1_stamp_s);
  v(output.state);
  v(output.reasons);
  visitTime(v, output.time_to_failure);
  visitTime(v, output.time_to_failure_indicator);
  visitTime(v, output.time_to_failure_covariance);
  v(output.eta);
  v(output.eta_rate_per_s);
  v(output.sigma_yaw_rad);
  v(output.sigma_x_m);
  v(output.sigma_y_m);
  if constexpr (!std::is_const_v<Output>) {
    output.covariance_since_start.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) v(output.covariance_since_start(row, column));
  }
  v(output.protection_level_m);
  v(output.min_information_ahead);
  v(output.information_ahead_distance_m);
  v(output.standby_state);
  visitTime(v, output.standby_time_to_failure);
}

template <class Visitor, class Sweep>
void visitSweep(Visitor& v, Sweep& sweep) {
  v(sweep.since_start_s);
  v(sweep.remaining_s);
  v(sweep.distance_m);
  v(sweep.speed_mps);
  v(sweep.error_m.x());
  v(sweep.error_m.y());
  visitOutput(v, sweep.output);
  v(sweep.silent_s);
}

template <class Visitor, class Episode>
void visitEpisode(Visitor& v, Episode& episode) {
  v(episode.begin_s);
  v(episode.failed);
  v(episode.time_s);
  v(episode.alert_limit_m);
  v(episode.fault_begins_s);
  v(episode.sweeps);
}

template <class Visitor, class Run>
void visitRun(Visitor& v, Run& run) {
  v(run.name);
  v(run.alert_limit_m);
  v(run.episode_every_s);
  v(run.samples.increments);
  v(run.samples.horizontal_increments);
  for (auto& list : run.samples.innovations) v(list);
  for (auto& list : run.samples.measured) v(list);
  v(run.episodes);
}

template <class Visitor, class Item>
void visitItem(Visitor& v, Item& item) {
  using Plain = std::remove_const_t<Item>;
  if constexpr (std::is_same_v<Plain, JudgedRun>) {
    visitRun(v, item);
  } else if constexpr (std::is_same_v<Plain, FailAwareEpisode>) {
    visitEpisode(v, item);
  } else if constexpr (std::is_same_v<Plain, FailAwareSweep>) {
    visitSweep(v, item);
  } else {
    v(item);
  }
}

}  // namespace

void writeEpisodeFile(const fs::path& path, const std::vector<JudgedRun>& runs) {
  std::ofstream file = createFile(path, std::ios::binary);
  Writer write(file);
  write.put(kBegin.data(), kBegin.size());
  write(runs);
  write.writeCrc();
  file << kEnd;
  finishFile(file, path);
}

std::vector<JudgedRun> readEpisodeFile(const fs::path& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file || !fs::is_regular_file(path, error)) throw InputError(path.string() + ": cannot be read");
  Reader read(file, path);
  std::vector<JudgedRun> runs;
  read.expect(kBegin);
  read(runs);
  read.checkCrc();
  read.expect(kEnd);
  return runs;
}

}  // namespace fail_aware
