// Matches clouds with the odometry messages that answer them, and measures the time between; for measure_latency.
//
// Report both in the order of arrival, with the steady clock's time. A cloud without an answer within `patience_s`
// counts as unanswered. Memory: the open clouds and one number a sweep.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace fail_aware {

class CloudAnswers {
 public:
  explicit CloudAnswers(double patience_s = 10.0) : patience_s_(patience_s) {}

  /// `stamp_ns` identifies the sweep.
  void cloud(std::uint64_t stamp_ns, double now_s) {
    ++clouds_;
    if (early_.erase(stamp_ns) > 0) {
      latencies_s_.push_back(0.0);  // the answer overtook this node's copy of the cloud on its own connection
      return;
    }
    if (!open_.emplace(stamp_ns, now_s).second) ++unanswered_;  // the same stamp again
    giveUp(now_s);
  }

  void odometry(std::uint64_t stamp_ns, double now_s) {
    ++odometries_;
    const auto at = open_.find(stamp_ns);
    if (at == open_.end()) {
      early_[stamp_ns] = now_s;
      if (early_.size() > kMostEarly) early_.erase(early_.begin());
      return;
    }
    latencies_s_.push_back(now_s - at->second);
    open_.erase(at);
  }

  std::size_t clouds() const { return clouds_; }
  std::size_t odometries() const { return odometries_; }
  /// Clouds that were given up or are still open.
  std::size_t unanswered() const { return unanswered_ + open_.size(); }
  const std::vector<double>& latencies_s() const { return latencies_s_; }

 private:
  static constexpr std::size_t kMostEarly = 100;

  void giveUp(double now_s) {
    for (auto at = open_.begin(); at != open_.end();) {
      if (now_s - at->second < patience_s_) {
        ++at;
        continue;
      }
      at = open_.erase(at);
      ++unanswered_;
    }
  }

  double patience_s_;
  std::map<std::uint64_t, double> open_;   ///< stamp -> arrival of the cloud
  std::map<std::uint64_t, double> early_;  ///< stamp -> arrival of the odometry
  std::vector<double> latencies_s_;
  std::size_t clouds_ = 0, odometries_ = 0, unanswered_ = 0;
};

}  // namespace fail_aware
