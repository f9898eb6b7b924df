#include "fail_aware_report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>

#include "core/integrity/monitor_replay.hpp"
#include "core/types/measurement.hpp"
#include "evaluation/alarm_statistics.hpp"
#include "evaluation/clopper_pearson.hpp"
#include "evaluation/concordance.hpp"
#include "evaluation/consistency.hpp"
#include "evaluation/kaplan_meier.hpp"
#include "evaluation/planner_figure.hpp"
#include "evaluation/prediction_statistics.hpp"
#include "evaluation/quantile.hpp"
#include "evaluation/stanford_diagram.hpp"

namespace fail_aware {

namespace {

using Predicted = std::optional<double>;

constexpr double kIntervalLevel = 0.95;
constexpr double kCoverageEdges_s[] = {0.0, 5.0, 20.0, std::numeric_limits<double>::infinity()};  // since t1
const std::vector<double> kReliabilityEdges_s = {0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0, 60.0};

struct Predictor {
  const char* name;
  std::function<Predicted(const FailAwareSweep&)> later;       ///< larger means later
  std::function<TimeToFailure(const MonitorOutput&)> seconds;  ///< empty: it gives no time, only an order
};

Predicted secondsOf(const TimeToFailure& time) { return time.isKnown() ? Predicted(time.seconds) : std::nullopt; }

const std::vector<Predictor>& predictors() {
  // with the covariance's time the message gives its protection level, which orders what has reached its time
  const auto timed = [](const char* name, TimeToFailure MonitorOutput::*member, bool with_level) {
    return Predictor{name,
                     [member, with_level](const FailAwareSweep& s) {
                       return with_level ? failureOrder(s.output.*member, s.output) : secondsOf(s.output.*member);
                     },
                     [member](const MonitorOutput& o) { return o.*member; }};
  };
  static const std::vector<Predictor> list = {
      timed("combination", &MonitorOutput::time_to_failure, true),
      timed("eta", &MonitorOutput::time_to_failure_indicator, false),
      timed("covariance", &MonitorOutput::time_to_failure_covariance, true),
      {"combination_time_alone", [](const FailAwareSweep& s) { return secondsOf(s.output.time_to_failure); }, {}},
      {"constant", [](const FailAwareSweep&) { return Predicted(0.0); }, {}},
      {"elapsed_time", [](const FailAwareSweep& s) { return Predicted(-s.since_start_s); }, {}},
      {"distance", [](const FailAwareSweep& s) { return Predicted(-s.distance_m); }, {}},
      {"sqrt_trace_p",
       [](const FailAwareSweep& s) {
         return Predicted(-std::sqrt(s.output.covariance_since_start.topLeftCorner<2, 2>().trace()));
       },
       {}},
  };
  return list;
}

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json intervalJson(const std::optional<Interval>& interval) {
  return interval ? Json({interval->low, interval->high}) : Json(nullptr);
}

Json countJson(std::size_t part, std::size_t whole) {
  return {{"count", part},
          {"of", whole},
          {"ratio", whole > 0 ? Json(static_cast<double>(part) / static_cast<double>(whole)) : Json(nullptr)},
          {"interval", intervalJson(clopperPearson(part, whole, kIntervalLevel))}};
}

Json figureJson(const PlannerFigure& figure) {
  return {{"in_time", countJson(figure.in_time, figure.stoppable)},
          {"told", countJson(figure.told, figure.unstoppable)},
          {"sound_stopped", countJson(figure.sound_stopped, figure.sound)},
          {"too_sudden", figure.too_sudden},
          {"used_ratio", orNull(figure.usedRatio())},
          {"used_ratio_of_failing", orNull(figure.usedRatioOfFailing())},
          {"used_ratio_of_sound", orNull(figure.usedRatioOfSound())},
          {"used_failing_s", figure.used_failing_s},
          {"possible_failing_s", figure.possible_failing_s},
          {"used_sound_s", figure.used_sound_s},
          {"possible_sound_s", figure.possible_sound_s}};
}

Json fixedJson(const char* unit, const FixedRule& rule) {
  Json json = figureJson(rule.figure);
  json[unit] = rule.value;
  return json;
}

Json plannerJson(const std::vector<PlannerDrive>& drives, double deceleration_mps2) {
  const PlannerFigure figure = plannerFigure(drives, deceleration_mps2);
  return {{"time_or_state", figureJson(figure)},
          {"state", figureJson(plannerFigure(drives, deceleration_mps2, StopRule::kState))},
          {"time", figureJson(plannerFigure(drives, deceleration_mps2, StopRule::kTime))},
          {"fixed_time", fixedJson("time_s", bestFixedTime(drives, deceleration_mps2, figure.in_time))},
          {"fixed_distance", fixedJson("distance_m", bestFixedDistance(drives, deceleration_mps2, figure.in_time))}};
}

/// Of the samples of all episodes, and of those at three instants.
Json concordanceJson(const std::vector<FailAwareEpisode>& episodes, const Predictor& predictor,
                     const ReportOptions& options) {
  std::vector<SurvivalSample> samples;
  std::vector<Predicted> predicted;
  constexpr std::array<std::pair<const char*, int>, 3> kInstants = {{{"at_1s", 1}, {"at_3s", 3}, {"at_5s", 5}}};
  std::array<std::vector<SurvivalSample>, kInstants.size()> samples_at;
  std::array<std::vector<Predicted>, kInstants.size()> predicted_at;
  for (std::size_t e = 0; e < episodes.size(); ++e) {
    for (const std::size_t i : judgedSweeps(episodes[e])) {
      const FailAwareSweep& sweep = episodes[e].sweeps[i];
      samples.push_back({sweep.remaining_s, episodes[e].failed, e});
      predicted.push_back(predictor.later(sweep));
      const int second = static_cast<int>(sweep.since_start_s + kStartTolerance_s);  // later than meant after a gap
      for (std::size_t k = 0; k < kInstants.size(); ++k) {
        if (second != kInstants[k].second) continue;
        samples_at[k].push_back(samples.back());
        predicted_at[k].push_back(predicted.back());
      }
    }
  }
  const Concordance concordance(samples, predicted);
  std::vector<SurvivalSample> by_run = samples;
  for (SurvivalSample& sample : by_run) sample.group = episodes[sample.group].run;
  Json json;
  json["index"] = orNull(concordance.all().index());
  json["interval"] = intervalJson(concordance.interval(options.resamples, kIntervalLevel, options.seed));
  json["interval_runs"] =
      intervalJson(Concordance(by_run, predicted).interval(options.resamples, kIntervalLevel, options.seed));
  json["between_episodes"] = orNull(concordance.betweenGroups().index());
  for (std::size_t k = 0; k < kInstants.size(); ++k) {
    json[kInstants[k].first] = orNull(Concordance(samples_at[k], predicted_at[k]).all().index());
  }
  json["samples"] = samples.size();
  json["comparable_pairs"] = concordance.all().comparable;
  return json;
}

std::vector<JudgedPrediction> judgedPredictions(const FailAwareEpisode& episode, const Predictor& predictor) {
  std::vector<JudgedPrediction> list;
  for (const std::size_t i : judgedSweeps(episode)) {
    const FailAwareSweep& sweep = episode.sweeps[i];
    list.push_back({sweep.since_start_s, sweep.remaining_s, episode.failed, predictor.seconds(sweep.output)});
  }
  return list;
}

Json timesJson(const std::vector<FailAwareEpisode>& episodes, const Predictor& predictor) {
  std::vector<JudgedPrediction> all;
  StabilityStatistics stability;
  for (const FailAwareEpisode& episode : episodes) {
    const std::vector<JudgedPrediction> judged = judgedPredictions(episode, predictor);
    stability = stability + stabilityOf(judged);
    all.insert(all.end(), judged.begin(), judged.end());
  }
  const LateStatistics late = lateStatistics(all);
  Json json;
  json["late_ratio"] = late.lateRatio();
  json["late_ratio_of_failing"] = late.lateRatioOfFailing();
  json["late_decided"] = late.decided;
  json["change_ratio"] = stability.changeRatio();
  json["jump_ratio"] = stability.jumpRatio();
  json["sign_changes_per_minute"] = stability.signChangesPerMinute();
  json["reliability"] = Json::array();
  for (const ReliabilityBin& bin : reliabilityCurve(all, kReliabilityEdges_s)) {
    json["reliability"].push_back({{"from_s", bin.from_s},
                                   {"to_s", bin.to_s},
                                   {"predictions", bin.predictions},
                                   {"decided", bin.decided},
                                   {"failed_within", bin.failed_within},
                                   {"median_remaining_s", bin.median_remaining_s}});
  }
  return json;
}

Json alarmJson(const std::vector<FailAwareEpisode>& episodes, double early_s) {
  const AlarmStatistics alarm = alarmStatistics(episodes, early_s);
  std::vector<double> leads_s;
  for (const LeadTime& lead : alarm.leads) leads_s.push_back(lead.lead_s);
  Json json;
  json["episodes"] = alarm.episodes;
  json["failing"] = alarm.failing;
  json["missed"] = alarm.missed;
  json["missed_ratio"] = alarm.missedRatio();
  json["false_alarms"] = alarm.false_alarms;
  json["false_alarms_per_hour"] = alarm.falseAlarmsPerHour();
  json["watched_s"] = alarm.watched_s;
  json["alarm_ratio"] = alarm.alarmRatio();
  json["available_ratio"] = alarm.availableRatio();
  json["lead_p5_s"] = leads_s.empty() ? Json(nullptr) : Json(quantile(leads_s, 0.05));
  json["lead_p50_s"] = leads_s.empty() ? Json(nullptr) : Json(quantile(leads_s, 0.5));
  const auto stopRatio = [&](double deceleration_mps2) {
    return alarm.failing == 0 ? Json(nullptr) : Json(alarm.stopRatio(deceleration_mps2));
  };
  json["stop_in_time_2mps2"] = stopRatio(2.0);
  json["stop_in_time_4mps2"] = stopRatio(4.0);
  return json;
}

/// The median time since t1 at which the truth fails, and at which eta passes its threshold; those that did not within
/// what was watched count as far as that.
Json mediansJson(const std::vector<FailAwareEpisode>& episodes) {
  std::vector<CensoredValue> failures_s, thresholds_s;
  for (const FailAwareEpisode& episode : episodes) {
    failures_s.push_back({episode.time_s, episode.failed});
    CensoredValue threshold{episode.sweeps.empty() ? 0.0 : episode.sweeps.back().since_start_s, false};
    for (const FailAwareSweep& sweep : episode.sweeps) {
      if (!(sweep.output.reasons & kReasonEtaThreshold)) continue;
      threshold = {sweep.since_start_s, true};
      break;
    }
    thresholds_s.push_back(threshold);
  }
  return {{"failure_p50_s", orNull(kaplanMeierQuantile(failures_s, 0.5))},
          {"eta_threshold_p50_s", orNull(kaplanMeierQuantile(thresholds_s, 0.5))}};
}

// One for all episodes (evaluate_fail_aware sees to it).
double alertLimit(const std::vector<FailAwareEpisode>& episodes) {
  return episodes.empty() ? FailureEpisode::Params().alert_limit_m : episodes.front().alert_limit_m;
}

Json stanfordJson(const std::vector<FailAwareEpisode>& episodes) {
  std::vector<ErrorAndLevel> pairs;
  for (const FailAwareEpisode& episode : episodes) {
    for (const FailAwareSweep& sweep : episode.sweeps) {
      if (sweep.output.protection_level_m >= 0.0) {
        pairs.push_back({sweep.error_m.norm(), sweep.output.protection_level_m});
      }
    }
  }
  const auto counts = stanfordCounts(pairs, alertLimit(episodes));
  Json json;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    json[toString(static_cast<IntegrityRegion>(i))] =
        pairs.empty() ? 0.0 : static_cast<double>(counts[i]) / static_cast<double>(pairs.size());
  }
  json["samples"] = pairs.size();
  return json;
}

Json consistencyJson(const std::vector<double>& squared, int dof) {
  const std::optional<Consistency> c = consistencyOf(squared, dof);
  if (!c) return nullptr;
  return {{"samples", c->samples},
          {"dof", dof},
          {"mean_per_dof", c->mean_per_dof},
          {"median_over_expected", c->median_over_expected},
          {"within_1_2_3_sigma", c->within_sigma}};
}

template <class Matrix>
void addIfKnown(std::vector<double>& list, const Eigen::VectorXd& error, const Matrix& covariance) {
  if (const std::optional<double> squared = normalisedErrorSquared(error, covariance)) list.push_back(*squared);
}

/// Of what each measurement said of the motion since the last estimate.
void addMeasurementErrors(const FailAwareRun& run, ConsistencySamples::PerSource& squared) {
  std::size_t i = 0;
  for (const MeasuredMotion& measured : run.measurements) {
    while (i < run.log.size() && run.log[i].row < measured.row) ++i;  // both lists in the order of their rows
    if (i == run.log.size()) return;
    if (i == 0 || run.log[i].row != measured.row || measured.source >= squared.size()) continue;
    const Pose T_true = run.truth[i - 1].inverse() * run.truth[i];
    addIfKnown(squared[measured.source], motionError(T_true, measured.T_previous_now), measured.covariance);
  }
}

}  // namespace

Json predictionReport(const std::vector<FailAwareEpisode>& episodes, const ReportOptions& options) {
  Json json = alarmJson(episodes, options.early_s);
  for (const Predictor& predictor : predictors()) {
    json["concordance"][predictor.name] = concordanceJson(episodes, predictor, options);
    if (predictor.seconds) json["times"][predictor.name] = timesJson(episodes, predictor);
  }
  json.update(mediansJson(episodes));
  json["alert_limit_m"] = alertLimit(episodes);
  json["stanford"] = stanfordJson(episodes);
  return json;
}

Json plannerReport(const std::vector<FailAwareEpisode>& episodes, const ReportOptions& options) {
  std::vector<PlannerDrive> drives, with_faults;
  bool has_faults = false;
  for (const FailAwareEpisode& episode : episodes) {
    with_faults.push_back(plannerDrive(episode));
    drives.push_back(with_faults.back());
    drives.back().faults_s.clear();
    has_faults = has_faults || !episode.fault_begins_s.empty();
  }
  Json json = plannerJson(drives, options.deceleration_mps2);
  json["deceleration_mps2"] = options.deceleration_mps2;
  // nlohmann's null has no value; moving it is fine
  json["sudden_faults_apart"] = nullptr;  // NOLINT(clang-analyzer-core.CallAndMessage)
  if (has_faults) json["sudden_faults_apart"] = plannerJson(with_faults, options.deceleration_mps2);
  return json;
}

ConsistencySamples consistencySamples(const FailAwareRun& run) {
  ConsistencySamples samples;
  for (std::size_t i = 1; i < run.log.size(); ++i) {
    const FilterState& state = run.log[i].state;
    for (std::size_t m = 0; m < state.fusion.nis.size() && m < samples.innovations.size(); ++m) {
      if (state.fusion.nis[m] >= 0.0) samples.innovations[m].push_back(state.fusion.nis[m]);
    }
    if (state.dt_s <= 0.0) continue;
    const Vector6d error = motionError(run.truth[i - 1].inverse() * run.truth[i], state.T_previous_now);
    addIfKnown(samples.increments, error, state.increment_covariance);
    addIfKnown(samples.horizontal_increments, Eigen::Vector3d(error[0], error[1], error[5]),
               horizontalBlock(state.increment_covariance));
  }
  addMeasurementErrors(run, samples.measured);
  return samples;
}

Json consistencyReport(const std::vector<const ConsistencySamples*>& runs,
                       const std::vector<FailAwareEpisode>& episodes) {
  ConsistencySamples all;
  const auto append = [](std::vector<double>& list, const std::vector<double>& more) {
    list.insert(list.end(), more.begin(), more.end());
  };
  for (const ConsistencySamples* run : runs) {
    append(all.increments, run->increments);
    append(all.horizontal_increments, run->horizontal_increments);
    for (std::size_t m = 0; m < all.innovations.size(); ++m) {
      append(all.innovations[m], run->innovations[m]);
      append(all.measured[m], run->measured[m]);
    }
  }
  std::vector<double> accumulated;
  std::vector<std::pair<double, double>> since_start;  // s, squared distance in standard deviations
  for (const FailAwareEpisode& episode : episodes) {
    double next_s = 1.0;
    for (const FailAwareSweep& sweep : episode.sweeps) {
      if (sweep.since_start_s + kStartTolerance_s < next_s) continue;
      const std::size_t before = accumulated.size();
      addIfKnown(accumulated, sweep.error_m, sweep.output.covariance_since_start.topLeftCorner<2, 2>());
      if (accumulated.size() > before) {
        since_start.emplace_back(sweep.since_start_s + kStartTolerance_s, accumulated.back());
      }
      next_s = std::floor(sweep.since_start_s + kStartTolerance_s) + 1.0;
    }
  }
  Json json;
  json["increment"] = consistencyJson(all.increments, 6);
  json["increment_horizontal"] = consistencyJson(all.horizontal_increments, 3);
  json["accumulated_position"] = consistencyJson(accumulated, 2);
  for (std::size_t e = 0; e + 1 < std::size(kCoverageEdges_s); ++e) {
    std::vector<double> squared;
    for (const auto& [time_s, value] : since_start) {
      if (time_s >= kCoverageEdges_s[e] && time_s < kCoverageEdges_s[e + 1]) squared.push_back(value);
    }
    json["accumulated_position_since_t1"].push_back(
        {{"from_s", kCoverageEdges_s[e]}, {"consistency", consistencyJson(squared, 2)}});
  }
  for (std::size_t m = 0; m < all.innovations.size(); ++m) {
    // nlohmann's null has no value; moving it is fine
    json["nis"][kBuiltInSources[m].name] =
        consistencyJson(all.innovations[m], 6);  // NOLINT(clang-analyzer-core.CallAndMessage)
    json["measurement"][kBuiltInSources[m].name] =
        consistencyJson(all.measured[m], 6);  // NOLINT(clang-analyzer-core.CallAndMessage)
  }
  return json;
}

void writePredictions(std::ostream& out, const std::vector<std::string>& run_names,
                      const std::vector<FailAwareEpisode>& episodes) {
  out << "run,begin_s,failed,since_start_s,remaining_s,combination_s,eta_s,covariance_s,state,reasons,eta,error_m,"
         "protection_level_m,speed_mps,min_information_ahead,information_ahead_distance_m\n";
  out << std::setprecision(8);
  for (const FailAwareEpisode& episode : episodes) {
    for (const std::size_t i : eachSecond(episode)) {
      const FailAwareSweep& sweep = episode.sweeps[i];
      const MonitorOutput& o = sweep.output;
      out << run_names[episode.run] << ',' << std::to_string(episode.begin_s) << ',' << (episode.failed ? 1 : 0) << ','
          << sweep.since_start_s << ',' << sweep.remaining_s << ',' << o.time_to_failure.seconds << ','
          << o.time_to_failure_indicator.seconds << ',' << o.time_to_failure_covariance.seconds << ','
          << toString(o.state) << ',' << reasonText(o.reasons) << ',' << o.eta << ',' << sweep.error_m.norm() << ','
          << o.protection_level_m << ',' << sweep.speed_mps << ',' << o.min_information_ahead << ','
          << o.information_ahead_distance_m << '\n';
    }
  }
}

void writeEpisodes(std::ostream& out, const std::vector<std::string>& run_names,
                   const std::vector<FailAwareEpisode>& episodes, double early_s) {
  out << "run,begin_s,failed,time_s,missed,false_alarms,watched_s,alarm_s,unknown_s,lead_s,lead_speed_mps\n";
  out << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (const FailAwareEpisode& episode : episodes) {
    const AlarmStatistics alarm = alarmStatistics({episode}, early_s);
    out << run_names[episode.run] << ',' << episode.begin_s << ',' << (episode.failed ? 1 : 0) << ',' << episode.time_s
        << ',' << alarm.missed << ',' << alarm.false_alarms << ',' << alarm.watched_s << ',' << alarm.alarm_s << ','
        << alarm.unknown_s << ',';
    if (!alarm.leads.empty()) out << alarm.leads.front().lead_s;
    out << ',';
    if (!alarm.leads.empty()) out << alarm.leads.front().speed_mps;
    out << '\n';
  }
}

}  // namespace fail_aware
