#include "fail_aware_lidar_odometry/core/io/monitor_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <type_traits>

#include "fail_aware_lidar_odometry/core/io/input_error.hpp"

namespace fail_aware {

namespace {

std::string numbered(const char* name, Eigen::Index i) { return std::string(name) + '_' + std::to_string(i); }

template <class Matrix, class Visitor>
void visitMatrix(const char* name, Matrix&& matrix, Visitor& v) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) v(numbered(name, i * matrix.cols() + j), matrix(i, j));
  }
}

// Every number of an input with its column's name: header, writer and reader all walk along here.
template <class Input, class Visitor>
void visitNumbers(Input& input, Visitor&& v) {
  auto& s = input.state;
  v("row", input.row);
  v("stamp", s.stamp_s);
  v("dt", s.dt_s);
  visitMatrix("T_odom_cog", s.T_odom_cog.affine(), v);
  visitMatrix("covariance", s.covariance, v);
  v("sigma_yaw", s.sigma_yaw_rad);
  v("corrected", s.corrected);
  visitMatrix("T_previous_now", s.T_previous_now.affine(), v);
  visitMatrix("increment_covariance", s.increment_covariance, v);
  visitMatrix("unobserved_covariance", s.unobserved_covariance, v);
  v("speed_variance", s.speed_error.variance_m2_s2);
  v("speed_kept", s.speed_error.kept);
  v("odom_epoch", s.odom_epoch);
  v("filter_nis", s.filter_nis);
  auto& f = s.fusion;
  v("has_measurement", f.has_measurement);
  visitMatrix("fused_state", f.z, v);
  visitMatrix("fused_covariance", f.R, v);
  v("weights", f.weights);
  v("nis", f.nis);
  v("all_gated_out", f.all_gated_out);
  v("prediction_overruled", f.prediction_overruled);
  v("prediction_invalid", f.prediction_invalid);
  v("disagreement_m", f.disagreement_m);
  v("disagreement_yaw_rad", f.disagreement_yaw_rad);
  v("confirmed", f.confirmed);
  v("valid_inputs", f.valid_inputs);
  v("invalid_inputs", f.invalid_inputs);
  SweepCondition::visit(input.condition,
                        [&](const char* name, auto& field) { v(std::string("sweep_") + name, field); });
}

void append(std::string& text, double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.17g", value);
  text += buffer;
}
void append(std::string& text, bool value) { text += value ? '1' : '0'; }
void append(std::string& text, int value) { text += std::to_string(value); }
void append(std::string& text, std::size_t value) { text += std::to_string(value); }
void append(std::string& text, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ';';
    append(text, values[i]);
  }
}

double numberFrom(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0') throw InputError("'" + cell + "' is no number");
  return value;
}

void parse(const std::string& cell, double& value) { value = numberFrom(cell); }
void parse(const std::string& cell, bool& value) { value = numberFrom(cell) != 0.0; }
template <class Integer>
std::enable_if_t<std::is_integral_v<Integer>> parse(const std::string& cell, Integer& value) {
  const double number = numberFrom(cell);
  if (!(std::abs(number) < 1e9) || (std::is_unsigned_v<Integer> && number < 0.0)) {
    throw InputError("'" + cell + "' is out of range");
  }
  value = static_cast<Integer>(number);
}
void parse(const std::string& cell, std::vector<double>& values) {
  values.clear();
  if (cell.empty()) return;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = cell.find(';', begin);
    values.push_back(numberFrom(cell.substr(begin, end - begin)));
    if (end == std::string::npos) return;
    begin = end + 1;
  }
}

class Cells {
 public:
  explicit Cells(const std::string& line) : line_(line) {}
  std::string next() {
    if (begin_ > line_.size()) throw InputError("too few columns");
    const std::size_t end = std::min(line_.find(',', begin_), line_.size());
    std::string cell = line_.substr(begin_, end - begin_);
    begin_ = end + 1;
    return cell;
  }
  bool atEnd() const { return begin_ > line_.size(); }

 private:
  const std::string& line_;
  std::size_t begin_ = 0;
};

MonitorInput inputFrom(const std::string& line) {
  MonitorInput input;
  Cells cells(line);
  visitNumbers(input, [&](const std::string& name, auto& field) {
    try {
      parse(cells.next(), field);
    } catch (const InputError& error) {
      throw InputError(name + ": " + error.what());
    }
  });
  if (!cells.atEnd()) throw InputError("too many columns");
  return input;
}

}  // namespace

std::string monitorLogHeader() {
  std::string text;
  const MonitorInput input;
  visitNumbers(input, [&](const std::string& name, const auto&) { text += (text.empty() ? "" : ",") + name; });
  return text;
}

std::string monitorLogRow(const MonitorInput& input) {
  std::string text;
  visitNumbers(input, [&](const std::string&, const auto& field) {
    if (!text.empty()) text += ',';
    append(text, field);
  });
  return text;
}

std::vector<MonitorInput> readMonitorLog(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  std::string line;
  if (!std::getline(file, line) || line != monitorLogHeader()) {
    throw InputError(path + ":1: not the columns of this version's monitor_log.csv: run offline_odometry again");
  }
  std::vector<MonitorInput> log;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    try {
      log.push_back(inputFrom(line));
    } catch (const InputError& error) {
      throw InputError(path + ':' + std::to_string(number) + ": " + error.what());
    }
  }
  if (log.empty()) throw InputError(path + ": no sweeps");
  return log;
}

}  // namespace fail_aware
