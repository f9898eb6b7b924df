// Decides which cloud is processed next, and how long the node waits for its measurements. Independent of ROS: times
// are seconds of a steady clock, stamps are nanoseconds.
//
// One sweep is open at a time; sweeps that arrive meanwhile wait in a short queue. The queue absorbs an occasional slow
// sweep. Each overflow reduces the queue by one sweep, until none waits: a node that is overloaded for long drops
// sweeps in any case, and a short queue keeps its estimates recent. Refused and lost sweeps are counted by cause, and
// count as dropped before the next estimate.
// Deadlines: `deadline_s` from opening. Sources that are still working get more time: a late estimate is better than
// none. The time that a sweep has waited in the queue is subtracted; otherwise the delay would grow under load.
// Failure: none. Cost: under 1 us per call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace fail_aware {

class SweepScheduler {
 public:
  struct Params {
    std::size_t queue_size = 6;      ///< sweeps that may wait for the open one
    double deadline_s = 0.18;        ///< from opening to closing
    double late_deadline_s = 0.6;    ///< from the cloud's arrival to closing, while a source is working
    double first_deadline_s = 10.0;  ///< from opening, while sources search for the first motion
  };
  struct Sweep {
    std::uint64_t stamp_ns = 0;
    std::string frame;
    double arrived_s = 0.0;
    double set_back_s = 0.0;  ///< from Estimator::Accepted
  };
  enum class Cause { kDuplicate, kReordered, kFarAhead, kUnusableStamp, kWrongFrame };
  struct Counts {
    std::size_t overload = 0, duplicate = 0, reordered = 0, far_ahead = 0, unusable_stamp = 0, wrong_frame = 0,
                reset = 0;
  };

  void setParams(const Params& params);

  /// Queues a sweep whose stamp was accepted.
  void offer(const Sweep& sweep);
  void refuse(Cause cause);

  /// Opens the next sweep; nullopt: a sweep is already open, or none waits.
  std::optional<Sweep> open(double now_s);
  /// The open sweep takes part in the search for the first motion.
  void setSearches(bool searches) { searches_ = searches; }
  const std::optional<Sweep>& current() const { return open_; }
  void close() { open_.reset(); }

  /// `is_at_work`: at least one source without an answer is still working on the open sweep; while a motion is known,
  /// at least one whose last answer was late.
  bool isOverdue(double now_s, bool is_at_work) const;
  bool searches() const { return searches_; }
  /// Longest time from opening if no sweep came before the open one: a slower answer gains nothing.
  double longest_s() const;

  /// Sweeps lost since the last call.
  int takeDropped() { return std::exchange(dropped_, 0); }
  /// For a new drive: drops the waiting and the open sweeps. The counts stay.
  void clear();

  const Counts& counts() const { return counts_; }
  /// Why the last refused cloud was refused; empty: none was refused.
  const std::string& lastRefused() const { return last_refused_; }

 private:
  void lose(std::size_t& cause);

  Params params_;
  std::size_t may_wait_ = params_.queue_size;  ///< current limit of the queue
  std::deque<Sweep> waiting_;
  std::optional<Sweep> open_;
  double opened_s_ = 0.0;
  bool searches_ = false;
  int dropped_ = 0;
  std::string last_refused_;
  Counts counts_;
};

}  // namespace fail_aware
