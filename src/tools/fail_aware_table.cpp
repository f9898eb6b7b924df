#include "fail_aware_table.hpp"

#include <algorithm>
#include <functional>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

#include "evaluation/stanford_diagram.hpp"

namespace fail_aware {

namespace {

constexpr int kLabelWidth = 38, kSmallestWidth = 14;

std::string number(const Json& value, int digits, double factor = 1.0) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value.get<double>() * factor;
  return text.str();
}

const Json& at(const Json& report, const std::string& pointer) {
  return report.at(nlohmann::json::json_pointer(pointer));
}

class Table {
 public:
  using Cell = std::function<std::string(const std::string& name, const Json& report)>;

  Table(std::ostream& out, const Json& reports) : out_(out), reports_(reports) {}

  void heading() {
    line("", [](const std::string& name, const Json&) { return name; });
  }
  void percent(const std::string& label, const std::string& pointer, int digits) {
    value(label, pointer, digits, 100.0);
  }
  /// Without data, where the number at `of` is 0, the cell is "-".
  void percentOf(const std::string& of, const std::string& label, const std::string& pointer, int digits) {
    valueOf(of, label, pointer, digits, 100.0);
  }
  void value(const std::string& label, const std::string& pointer, int digits, double factor = 1.0) {
    line(label, [&](const std::string&, const Json& report) { return number(at(report, pointer), digits, factor); });
  }
  void valueOf(const std::string& of, const std::string& label, const std::string& pointer, int digits,
               double factor = 1.0) {
    line(label, [&](const std::string&, const Json& report) {
      return at(report, of) == 0 ? std::string("-") : number(at(report, pointer), digits, factor);
    });
  }
  void interval(const std::string& pointer, int digits, double factor) {
    line("  95 % interval", [&](const std::string&, const Json& report) {
      const Json& interval = at(report, pointer);
      return number(interval.at(0), digits, factor) + ".." + number(interval.at(1), digits, factor);
    });
  }
  void ratio(const std::string& label, const std::string& pointer) {
    line(label, [&](const std::string&, const Json& report) {
      const Json& count = at(report, pointer);
      return number(count.at("ratio"), 0, 100.0) + " % of " + std::to_string(count.at("of").get<std::size_t>());
    });
    interval(pointer + "/interval", 0, 100.0);
  }
  /// The keys of an object that all reports have.
  std::vector<std::string> keys(const std::string& pointer) const {
    std::vector<std::string> keys;
    if (reports_.empty()) return keys;
    for (const auto& item : at(reports_.begin().value(), pointer).items()) keys.push_back(item.key());
    return keys;
  }

 private:
  void line(const std::string& label, const Cell& cell) {
    out_ << std::left << std::setw(kLabelWidth) << label << std::right;
    for (const auto& item : reports_.items()) {
      std::string text = "-";
      try {
        text = cell(item.key(), item.value());
      } catch (const nlohmann::json::exception&) {
        // null: there is no such figure for this set
      }
      out_ << std::setw(std::max(kSmallestWidth, static_cast<int>(item.key().size()) + 2)) << text;
    }
    out_ << '\n';
  }

  std::ostream& out_;
  const Json& reports_;
};

void printAlarms(Table& table) {
  table.value("episodes", "/episodes", 0);
  table.value("  failing", "/failing", 0);
  table.percentOf("/failing", "  missed, %", "/missed_ratio", 1);
  table.value("  true time to failure p50, s", "/failure_p50_s", 1);
  table.value("  eta at its threshold p50, s", "/eta_threshold_p50_s", 1);
  table.percentOf("/watched_s", "alarm up before the failure, % of time", "/alarm_ratio", 1);
  table.percentOf("/watched_s", "available, % of time", "/available_ratio", 1);
  table.valueOf("/watched_s", "false alarms per hour", "/false_alarms_per_hour", 1);
  table.value("lead time p5, s", "/lead_p5_s", 1);
  table.value("lead time p50, s", "/lead_p50_s", 1);
  table.percent("  enough to stop at 2 m/s^2, %", "/stop_in_time_2mps2", 0);
  table.percent("  enough to stop at 4 m/s^2, %", "/stop_in_time_4mps2", 0);
}

void printUsed(Table& table, const std::string& base) {
  table.percent("  used, %", base + "/used_ratio", 0);
  table.percent("    of failing drives, %", base + "/used_ratio_of_failing", 0);
  table.percent("    of sound drives, %", base + "/used_ratio_of_sound", 0);
}

void printPlanner(Table& table) {
  const std::string planner = "/planner";
  table.ratio("planner: stopped in time", planner + "/time_or_state/in_time");
  printUsed(table, planner + "/time_or_state");
  table.ratio("  sound drives stopped", planner + "/time_or_state/sound_stopped");
  table.ratio("  no time to stop: told at once", planner + "/time_or_state/told");
  table.ratio("  without sudden faults: in time", planner + "/sudden_faults_apart/time_or_state/in_time");
  table.value("    sudden faults", planner + "/sudden_faults_apart/time_or_state/too_sudden", 0);
  table.ratio("planner by state alone: in time", planner + "/state/in_time");
  printUsed(table, planner + "/state");
  table.value("best fixed time in hindsight, s", planner + "/fixed_time/time_s", 0);
  table.ratio("  in time", planner + "/fixed_time/in_time");
  printUsed(table, planner + "/fixed_time");
  table.value("best fixed distance in hindsight, m", planner + "/fixed_distance/distance_m", 0);
  table.ratio("  in time", planner + "/fixed_distance/in_time");
  printUsed(table, planner + "/fixed_distance");
}

void printPredictors(Table& table) {
  for (const std::string& predictor : table.keys("/concordance")) {
    const std::string base = "/concordance/" + predictor;
    table.value("concordance " + predictor, base + "/index", 3);
    table.interval(base + "/interval", 2, 1.0);
    table.value("  between episodes only", base + "/between_episodes", 3);
  }
  for (const std::string& predictor : table.keys("/times")) {
    const std::string base = "/times/" + predictor;
    table.percentOf(base + "/late_decided", "late " + predictor + ", %", base + "/late_ratio", 1);
    table.percentOf("/failing", "  of failing episodes, %", base + "/late_ratio_of_failing", 1);
    table.percentOf("/episodes", "  changes over 50 % in 1 s, %", base + "/change_ratio", 1);
    table.percentOf("/episodes", "  jumps over 50 % from what was expected, %", base + "/jump_ratio", 1);
    table.valueOf("/episodes", "  sign changes per minute", base + "/sign_changes_per_minute", 1);
  }
  for (std::size_t i = 0; i < kIntegrityRegions; ++i) {
    const std::string region = toString(static_cast<IntegrityRegion>(i));
    table.percentOf("/stanford/samples", "Stanford " + region + ", %", "/stanford/" + region, 2);
  }
}

void printConsistency(Table& table) {
  const std::string consistency = "/consistency", accumulated = consistency + "/accumulated_position";
  table.value("NEES/dof increment (6)", consistency + "/increment/mean_per_dof", 2);
  table.value("  x, y, yaw (3)", consistency + "/increment_horizontal/mean_per_dof", 2);
  table.value("NEES/dof accumulated position", accumulated + "/mean_per_dof", 2);
  const char* expected[] = {"39", "86", "99"};
  for (std::size_t k = 0; k < 3; ++k) {
    table.percent("  within " + std::to_string(k + 1) + " sigma, % (true: " + expected[k] + ")",
                  accumulated + "/within_1_2_3_sigma/" + std::to_string(k), 0);
  }
  for (const std::string& source : table.keys(consistency + "/measurement")) {
    const std::string base = consistency + "/measurement/" + source;
    table.value("NEES/dof " + source, base + "/mean_per_dof", 2);
    table.value("  median over the expected", base + "/median_over_expected", 2);
  }
  for (const std::string& source : table.keys(consistency + "/nis")) {
    table.value("NIS/dof " + source, consistency + "/nis/" + source + "/mean_per_dof", 2);
  }
}

}  // namespace

void printTable(std::ostream& out, const Json& reports_by_name) {
  Table table(out, reports_by_name);
  table.heading();
  printAlarms(table);
  printPlanner(table);
  printPredictors(table);
  printConsistency(table);
}

}  // namespace fail_aware
