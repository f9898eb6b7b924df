// Which cloud becomes the sweep in work, and until when its measurements are waited for. Without ROS: times are seconds of
// a clock that never jumps, stamps are nanoseconds.
//
// One sweep is open at a time; those that come meanwhile wait in a short queue. The queue is for a sweep that takes longer
// now and then. Each overflow lets one sweep fewer wait, at last only the newest, until none waits: whoever cannot follow
// for long skips sweeps in any case, and so his estimates are not late. What is refused or lost is counted by its cause,
// and counts as dropped before the next estimate.
// Deadlines: `deadline_s` from opening. More patience with those that are at work: a late estimate is better than none.
// But what a sweep has waited for its turn is taken off it, or under load each would be later by that.
// Failure: none. Cost: under 1 us a call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace fail_aware {

class SweepScheduler {
 public:
  struct Params {
    std::size_t queue_size = 3;      ///< sweeps that may wait for the open one
    double deadline_s = 0.25;        ///< from opening to closing
    double late_deadline_s = 0.6;    ///< from the cloud to closing, where a source is at work
    double first_deadline_s = 10.0;  ///< from opening, while sources search the first motion
  };
  struct Sweep {
    std::uint64_t stamp_ns = 0;
    std::string frame;
    double arrived_s = 0.0;
    double set_back_s = 0.0;  ///< Estimator::Accepted's
  };
  enum class Cause { kDuplicate, kReordered, kFarAhead, kUnusableStamp, kWrongFrame };
  struct Counts {
    std::size_t overload = 0, duplicate = 0, reordered = 0, far_ahead = 0, unusable_stamp = 0, wrong_frame = 0,
                reset = 0;
  };

  void setParams(const Params& params);

  /// A sweep whose stamp was accepted waits for its turn.
  void offer(const Sweep& sweep);
  void refuse(Cause cause);

  /// The next sweep, which is open from now on; none: one is open already, or none waits.
  std::optional<Sweep> open(double now_s);
  /// The open sweep is one of those that search the first motion.
  void setSearches(bool searches) { searches_ = searches; }
  const std::optional<Sweep>& current() const { return open_; }
  void close() { open_.reset(); }

  /// `is_at_work`: of the sources that have not answered the open sweep, some are at work on it; while a motion is known,
  /// some whose last answer was late.
  bool isOverdue(double now_s, bool is_at_work) const;
  bool searches() const { return searches_; }
  /// From opening, if nothing came before the open sweep: an answer that takes longer gains nothing.
  double longest_s() const;

  /// Sweeps lost since this was last asked.
  int takeDropped();
  /// A new drive: what waits and what is open is lost by it. The counts stay.
  void clear();

  const Counts& counts() const { return counts_; }
  /// Why the last cloud that was refused was; empty: none was.
  const std::string& lastRefused() const { return last_refused_; }

 private:
  void lose(std::size_t& cause);

  Params params_;
  std::size_t may_wait_ = 3;  ///< now
  std::deque<Sweep> waiting_;
  std::optional<Sweep> open_;
  double opened_s_ = 0.0;
  bool searches_ = false;
  int dropped_ = 0;
  std::string last_refused_;
  Counts counts_;
};

}  // namespace fail_aware
